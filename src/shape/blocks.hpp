// SPDX-License-Identifier: Apache-2.0
// Space cut into cubes of some thousand tetrahedra, numbered along a Z curve: a queue that goes through them one by one works in the cache, while a queue by
// badness alone jumps about and waits for memory.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "wellmesh/vec3.hpp"

namespace wellmesh {

class Blocks {
public:
    Blocks() = default;  ///< one block
    /// @param low, high  box of the points; those outside belong to a block at its side
    Blocks(const Vec3& low, const Vec3& high, std::size_t tets) : low_(low) {
        const Vec3 extent{high.x - low.x, high.y - low.y, high.z - low.z};
        const double longest = std::max({extent.x, extent.y, extent.z});
        if (tets <= kTetsInBlock || !(longest > 0)) return;
        // As if the box were full; a floor of a thousandth keeps flat ones from a division by nothing.
        const double floor = longest / 1000;
        const double volume = std::max(extent.x, floor) * std::max(extent.y, floor) / longest * std::max(extent.z, floor) / longest / longest;
        const double blocks = static_cast<double>(tets) / kTetsInBlock;
        per_length_ = std::min(std::cbrt(blocks / volume), static_cast<double>(kMostAlong)) / longest;
    }
    [[nodiscard]] std::uint32_t of(const Vec3& p) const { return spread(along(p.x - low_.x)) << 2U | spread(along(p.y - low_.y)) << 1U | spread(along(p.z - low_.z)); }

private:
    static constexpr std::size_t kTetsInBlock = 4096;  // a megabyte with all that hangs on them
    static constexpr std::uint32_t kMostAlong = 1023;

    [[nodiscard]] std::uint32_t along(double length) const {
        const double at = length * per_length_;
        return at > 0 ? static_cast<std::uint32_t>(std::min(at, static_cast<double>(kMostAlong))) : 0;
    }
    /// Ten bits, two zeros between each and the next.
    static std::uint32_t spread(std::uint32_t x) {
        x = (x | x << 16U) & 0x030000ffU;
        x = (x | x << 8U) & 0x0300f00fU;
        x = (x | x << 4U) & 0x030c30c3U;
        return (x | x << 2U) & 0x09249249U;
    }

    Vec3 low_{};
    double per_length_ = 0;
};

}  // namespace wellmesh
