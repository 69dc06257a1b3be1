// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/rng.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh::testing {

/// Uniform in the unit cube; the same sequence for the same seed.
class RandomPoints {
public:
    explicit RandomPoints(std::uint64_t seed) : seed_(seed) {}
    double number() { return static_cast<double>(mix64(seed_, ++count_) >> 11U) * 0x1p-53; }
    Vec3 point() {
        const double x = number(), y = number(), z = number();
        return {x, y, z};
    }

private:
    std::uint64_t seed_, count_ = 0;
};

}  // namespace wellmesh::testing
