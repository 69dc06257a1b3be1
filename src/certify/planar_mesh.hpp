// SPDX-License-Identifier: Apache-2.0
// A triangulation of points in the plane into which edges can be forced.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "wellmesh/predicates.hpp"

namespace wellmesh::certifying {

struct Point2 {
    double x = 0, y = 0;
    friend bool operator==(const Point2&, const Point2&) = default;
};

/// Positive iff a, b, c turn counter-clockwise; exact.
[[nodiscard]] Sign orient2d(const Point2& a, const Point2& b, const Point2& c);

/// Counter-clockwise triangles over the points inserted and four outer vertices (numbers 0 to 3) far around them. Edge i of a triangle is
/// opposite corner i; edges can be constrained. Exact orientation tests only; an edge is flipped for being non-Delaunay only where
/// rounded arithmetic is sure, so every flip is a true improvement and flipping ends.
class PlanarMesh {
public:
    /// @param low, high  a box that holds all points ever inserted.
    PlanarMesh(const Point2& low, const Point2& high);

    /// @return its number; that of the vertex already there, if any. Expected time: the walk from the previous insertion.
    std::uint32_t insert(const Point2& p);

    /// Makes the segment between two vertices a chain of constrained edges. Where it crosses a constrained edge, a vertex is made.
    /// @return false if the number of such crossings has exceeded `max_crossings`: then the segment is not there.
    bool constrain(std::uint32_t a, std::uint32_t b);

    /// Marks what is reachable from the outer vertices, or from the point, without crossing a constrained edge.
    void mark_from_outside();
    void mark_from(const Point2& p);

    /// Unmarked triangles.
    [[nodiscard]] std::vector<std::array<std::uint32_t, 3>> unmarked() const;

    [[nodiscard]] const std::vector<Point2>& points() const { return points_; }
    /// True of vertices made by a crossing.
    [[nodiscard]] bool made_by_crossing(std::uint32_t v) const { return v >= first_crossing_; }
    /// Call when all input points are in: later ones are crossings.
    void freeze() { first_crossing_ = static_cast<std::uint32_t>(points_.size()); }

    std::uint64_t max_crossings = 0;

private:
    struct Tri {
        std::array<std::uint32_t, 3> v{}, next{};  // next[i]: across edge i, kNoTri outside
        std::array<bool, 3> constrained{};
        bool marked = false;
    };
    struct Place {  // of a point: in the triangle, on its edge, or at its corner
        std::uint32_t tri = 0;
        int edge = -1, corner = -1;
    };
    struct EdgeAt {
        std::uint32_t tri = 0;
        std::size_t edge = 0;
        bool found = false;
    };
    static constexpr std::uint32_t kNoTri = 0xffffffff;

    [[nodiscard]] Place locate(const Point2& p);
    [[nodiscard]] Sign turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const { return orient2d(points_[a], points_[b], points_[c]); }
    [[nodiscard]] std::size_t corner_of(std::uint32_t tri, std::uint32_t v) const;
    [[nodiscard]] std::size_t edge_to(std::uint32_t tri, std::uint32_t neighbour) const;
    /// The edge between two vertices, not both outer ones, if there is one: in the triangle left of it as seen from a, or, if a is an outer
    /// vertex, right of it.
    [[nodiscard]] EdgeAt find_edge(std::uint32_t a, std::uint32_t b) const;
    void link(std::uint32_t t, std::size_t e, std::uint32_t u);
    void split_triangle(std::uint32_t t, std::uint32_t v);
    void split_edge(std::uint32_t t, std::size_t e, std::uint32_t v);
    void flip(std::uint32_t t, std::size_t e);
    [[nodiscard]] bool surely_not_delaunay(std::uint32_t t, std::size_t e) const;
    [[nodiscard]] bool flippable(std::uint32_t t, std::size_t e) const;
    void improve(std::vector<std::uint32_t>& suspects);
    /// First vertex on the way from a to b (b itself, or one on the segment), with the edges crossed until then.
    std::uint32_t cross(std::uint32_t a, std::uint32_t b, std::vector<std::array<std::uint32_t, 2>>& crossed) const;
    void force_edge(std::uint32_t a, std::uint32_t b, std::vector<std::array<std::uint32_t, 2>>& crossed);
    void flood(std::uint32_t start);

    std::vector<Point2> points_;
    std::vector<std::uint32_t> at_;  // some triangle at each vertex
    std::vector<Tri> tris_;
    std::uint32_t recent_ = 0, first_crossing_ = 0xffffffff;
    std::uint64_t crossings_ = 0;
};

}  // namespace wellmesh::certifying
