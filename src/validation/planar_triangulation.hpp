// SPDX-License-Identifier: Apache-2.0
// The mutable triangulation behind triangulate_facet(). Points are in general position neither here nor in life.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "validation/plane.hpp"

namespace wellmesh {

using Point2 = std::array<double, 2>;

/// Triangulation of the convex hull of points in the plane. Triangles are counter-clockwise; neighbour i is across from corner i.
class PlanarTriangulation {
public:
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

    struct Triangle {
        std::array<std::uint32_t, 3> v{};
        std::array<std::uint32_t, 3> neighbour{kNone, kNone, kNone};
        std::array<bool, 3> fixed{};  ///< the edge across from corner i is a constraint
    };

    /// Builds the Delaunay triangulation (up to ties that rounding cannot decide). Points with equal coordinates: the later is left out.
    explicit PlanarTriangulation(std::span<const Point2> points);

    [[nodiscard]] bool is_flat() const { return triangles_.empty(); }  ///< all points on one line: no triangles
    [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }
    [[nodiscard]] const std::vector<std::array<std::uint32_t, 2>>& coincident() const { return coincident_; }
    [[nodiscard]] bool is_present(std::uint32_t v) const { return triangle_of_[v] != kNone; }

    struct Obstacle {
        std::optional<std::uint32_t> vertex;                   ///< lies on the edge
        std::optional<std::array<std::uint32_t, 2>> crossing;  ///< constraint that it crosses
    };
    /// Makes ab an edge and a constraint, unless something is in the way, which is returned; then nothing changes.
    [[nodiscard]] Obstacle insert_constraint(std::uint32_t a, std::uint32_t b, double on_edge);

    /// Restores the Delaunay property between constraints.
    void restore_delaunay();

    /// A triangle that contains p, or kNone.
    [[nodiscard]] std::uint32_t locate(const Point2& p) const;

private:
    struct Side {
        std::uint32_t triangle = kNone;
        unsigned corner = 0;
    };
    void sweep();
    void make_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);
    void glue(Side one, Side other);
    [[nodiscard]] Sign turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const { return orient2d(points_[a], points_[b], points_[c]); }
    [[nodiscard]] bool is_near(std::uint32_t v, std::uint32_t a, std::uint32_t b, double on_edge) const;
    void flip(std::uint32_t triangle, unsigned corner);
    [[nodiscard]] bool is_convex(std::uint32_t triangle, unsigned corner) const;
    [[nodiscard]] Side side_across(std::uint32_t triangle, unsigned corner) const;
    [[nodiscard]] std::vector<std::uint32_t> star(std::uint32_t v) const;
    [[nodiscard]] std::optional<Side> find_edge(std::uint32_t a, std::uint32_t b) const;
    struct Crossings {
        Obstacle obstacle;
        std::vector<std::array<std::uint32_t, 2>> edges;
    };
    [[nodiscard]] Crossings edges_crossed(std::uint32_t a, std::uint32_t b, double on_edge) const;
    void fix(const Side& side);

    std::span<const Point2> points_;
    std::vector<Triangle> triangles_;
    std::vector<std::uint32_t> triangle_of_;  ///< some triangle at each vertex
    std::vector<std::uint32_t> next_, prev_;  ///< hull, counter-clockwise, while sweeping
    std::vector<Side> hull_side_;             ///< of hull edge v -> next_[v]
    std::vector<std::array<std::uint32_t, 2>> coincident_;
};

}  // namespace wellmesh
