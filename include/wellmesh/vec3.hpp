// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace wellmesh {

/// A point or vector of R^3 in input units. Coordinates are plain doubles throughout.
struct Vec3 {
    double x = 0, y = 0, z = 0;
    friend bool operator==(const Vec3&, const Vec3&) = default;
};

}  // namespace wellmesh
