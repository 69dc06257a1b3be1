// SPDX-License-Identifier: Apache-2.0
// Vertices no two of which are closer than a given reach: whatever is asked for within it of another one is that one.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "wellmesh/vec3.hpp"

namespace wellmesh {

class VertexPool {
public:
    /// @pre reach > 0 and at least some units in the last place of every coordinate to come.
    explicit VertexPool(double reach) : reach_(reach), cell_(2 * reach) {}

    /// The nearest vertex within reach of p (the first of equally near ones), or else p as a new one. Vertices never move: no chains of merges.
    [[nodiscard]] std::uint32_t find_or_add(const Vec3& p);

    [[nodiscard]] const Vec3& operator[](std::uint32_t v) const { return points_[v]; }
    [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(points_.size()); }
    [[nodiscard]] double reach() const { return reach_; }
    /// From now on; vertices that exist stay as they are. @pre not more than before
    void shrink_reach(double reach) { reach_ = reach; }

private:
    struct Cell {
        std::int64_t x = 0, y = 0, z = 0;
        friend bool operator==(const Cell&, const Cell&) = default;
    };
    struct CellHash {
        std::size_t operator()(const Cell& c) const noexcept;
    };
    [[nodiscard]] std::int64_t cell_of(double coordinate) const;

    double reach_, cell_;
    std::vector<Vec3> points_;
    std::vector<std::uint32_t> next_;  ///< in the same cell
    std::unordered_map<Cell, std::uint32_t, CellHash> newest_;
};

}  // namespace wellmesh
