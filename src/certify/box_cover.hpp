// SPDX-License-Identifier: Apache-2.0
// A grid over a set of boxes that tells at once of most other boxes that they meet none of the set.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "certify/triangle_tree.hpp"

namespace wellmesh::certifying {

/// Counts covered cells in a summed-volume table, so that each box costs the same however many cells it spans.
///
/// Sound in rounded arithmetic: the cell number of a coordinate is a monotonous function of it, so boxes with a common point have a
/// common cell.
class BoxCover {
public:
    explicit BoxCover(const std::vector<Box3>& boxes);

    /// False: no box of the set meets `box`. Constant time.
    [[nodiscard]] bool may_meet(const Box3& box) const {
        if (sums_.empty()) return false;
        const auto [i0, j0, k0] = cell_of(box.low);
        const auto [i1, j1, k1] = cell_of(box.high);
        const auto slab = [&](std::size_t i) { return at(i, j1 + 1, k1 + 1) - at(i, j0, k1 + 1) - at(i, j1 + 1, k0) + at(i, j0, k0); };
        return slab(i1 + 1) != slab(i0);
    }

private:
    using Cell = std::array<std::size_t, 3>;

    [[nodiscard]] Cell cell_of(const Vec3& p) const { return {along(0, p.x - low_.x), along(1, p.y - low_.y), along(2, p.z - low_.z)}; }
    [[nodiscard]] std::size_t along(std::size_t axis, double offset) const {
        const double cell = offset * cells_per_unit_[axis];
        return !(cell > 0) ? 0 : cell >= static_cast<double>(size_[axis]) ? size_[axis] - 1 : static_cast<std::size_t>(cell);
    }
    [[nodiscard]] std::size_t place(std::size_t i, std::size_t j, std::size_t k) const { return (i * (size_[1] + 1) + j) * (size_[2] + 1) + k; }
    [[nodiscard]] std::uint32_t at(std::size_t i, std::size_t j, std::size_t k) const { return sums_[place(i, j, k)]; }
    void accumulate();

    Vec3 low_{};
    std::array<double, 3> cells_per_unit_{};
    Cell size_{1, 1, 1};
    std::vector<std::uint32_t> sums_;  // at (i, j, k): covered cells before i, j and k; empty without boxes
};

}  // namespace wellmesh::certifying
