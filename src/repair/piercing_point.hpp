// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "wellmesh/vec3.hpp"

namespace wellmesh {

/// Where a segment crosses the plane of a triangle, within about an ulp of the coordinates and an ulp of the segment's length, however acute the
/// angle between them. @pre its ends lie strictly on different sides (exactly).
[[nodiscard]] Vec3 piercing_point(const std::array<Vec3, 2>& segment, const std::array<Vec3, 3>& triangle);

}  // namespace wellmesh
