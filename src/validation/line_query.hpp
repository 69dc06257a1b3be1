// SPDX-License-Identifier: Apache-2.0
// Where a straight line pierces the triangles of the complex, in exact order.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "validation/box_tree.hpp"
#include "validation/working_complex.hpp"

namespace wellmesh {

/// A side of a triangle: 2 t is its front (from which it turns counter-clockwise), 2 t + 1 its back.
using SideId = std::uint32_t;

struct Hit {
    std::uint32_t triangle = 0;
    bool front_first = false;  ///< the start of the line lies on the front's side
    double t = 0;              ///< place on the line, 0 at its start and 1 at its end; rounded
    double t_error = 0;        ///< bound on the error of t
    [[nodiscard]] SideId side_towards_start() const { return 2 * triangle + (front_first ? 0 : 1); }
    [[nodiscard]] SideId side_towards_end() const { return 2 * triangle + (front_first ? 1 : 0); }
};

class LineQuery {
public:
    LineQuery(std::span<const Vec3> points, std::span<const SoupTriangle> triangles);

    /// All triangles that the open segment pq pierces in their interior, from p to q. Empty optional: the segment meets an edge or a
    /// vertex, or has an end on a triangle's plane within it: take another one. Order and membership are exact.
    /// @pre triangles meet only in common vertices and edges.
    [[nodiscard]] std::optional<std::vector<Hit>> pierce(const Vec3& p, const Vec3& q) const;

    /// A triangle that contains p, exactly.
    [[nodiscard]] std::optional<std::uint32_t> triangle_at(const Vec3& p) const;

    struct Place {
        std::optional<SideId> sees;        ///< a side in the same cell; empty: nothing in that direction, the outer cell
        std::optional<std::uint32_t> on;   ///< lies on this triangle instead
    };
    /// The cell of p. @throws MeshError{internal_invariant} if no line works (not observed).
    [[nodiscard]] Place locate(const Vec3& p) const;

    /// End of a line from p in the `attempt`-th of a fixed sequence of directions, outside of the complex.
    [[nodiscard]] Vec3 far_point(const Vec3& p, std::uint64_t attempt, double sign = 1) const;

private:
    [[nodiscard]] const Vec3& corner(std::uint32_t triangle, std::size_t i) const { return points_[triangles_[triangle].v[i].index()]; }
    [[nodiscard]] bool is_before(const Hit& a, const Hit& b, const Vec3& p, const Vec3& q) const;

    std::span<const Vec3> points_;
    std::span<const SoupTriangle> triangles_;
    std::vector<Box> boxes_;
    BoxTree tree_;
    double diagonal_ = 0;
};

}  // namespace wellmesh
