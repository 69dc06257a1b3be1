// SPDX-License-Identifier: Apache-2.0
// Constrained Delaunay triangulation of a polygonal facet in its projection.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "validation/plane.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh {

/// What a facet looks like as triangles. All numbers are positions in the array of points given.
struct FacetTriangulation {
    std::vector<std::array<std::uint32_t, 3>> triangles;    ///< counter-clockwise in the projection, interiors disjoint: exactly
    std::vector<std::array<std::uint32_t, 2>> constraints;  ///< the constraint edges, after splits
    struct Split {
        std::array<std::uint32_t, 2> edge{};
        std::uint32_t inside = 0;  ///< a vertex in the interior of that edge
    };
    std::vector<Split> splits;
    /// Constraint edges that cross; the later one was left out.
    std::vector<std::array<std::array<std::uint32_t, 2>, 2>> crossings;
    /// Pairs of points with one projection; the second was left out.
    std::vector<std::array<std::uint32_t, 2>> coincident;
    /// Hole points outside the facet or exactly on a constraint: no use.
    std::vector<std::size_t> idle_holes;
};

/// Triangulates what cannot be reached from outside or from a hole without crossing a constraint edge.
///
/// @param points      of the facet; bit-distinct, not all collinear in the projection.
/// @param edges       constraints, pairs of different points.
/// @param holes       points in (or near) the facet's plane.
/// @param on_edge     distance within which a point lies on a constraint edge, input units: the edge is split there.
/// Sweep in lexicographic order, then flips to Delaunay (certified ones only, so that rounding cannot make them cycle), then
/// constraints by flips [Sloan93]. All topological decisions are exact in the projection; the distance on_edge is not.
[[nodiscard]] FacetTriangulation triangulate_facet(std::span<const Vec3> points, const PlaneProjection& projection,
                                                   std::span<const std::array<std::uint32_t, 2>> edges, std::span<const Vec3> holes, double on_edge);

}  // namespace wellmesh
