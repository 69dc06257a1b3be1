// SPDX-License-Identifier: Apache-2.0
// The input: a piecewise linear complex as a file or a program states it, not yet checked (see src/validation).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "wellmesh/names.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh {

/// One facet: polygons that lie in one plane. Every polygon edge is a constraint. What the polygons enclose belongs to
/// the facet, except what a hole point can reach without crossing a polygon edge. A polygon of two vertices is a dangling
/// segment inside the facet, one of a single vertex a point on it.
struct PlcFacet {
    std::vector<std::vector<std::uint32_t>> polygons;  ///< vertex numbers, from 0
    std::vector<Vec3> holes;
    std::int32_t marker = 0;
};

/// A segment that need not bound any facet (a wire, a well).
struct PlcSegment {
    std::array<std::uint32_t, 2> vertices{};
    std::int32_t marker = 0;
};

/// Names the cell that contains `point`.
struct RegionSeed {
    Vec3 point;
    std::int32_t id = 0;
    double max_volume = 0;  ///< bound on the volume of a tetrahedron in this cell; <= 0: none
};

/// Which cells of the arrangement of the facets are meshed.
enum class FillRule {
    bounded_cells,   ///< every bounded cell without a hole seed (TetGen's .poly)
    nonzero_winding  ///< cells whose winding number is not zero (consistently oriented surface files)
};

/// Which coplanar neighbouring facets become one.
enum class MergeRule { none, triangles, all };

struct Plc {
    std::vector<Vec3> vertices;
    std::vector<std::int32_t> vertex_markers;  ///< empty, or one a vertex
    std::vector<double> vertex_sizes;          ///< target edge lengths, input units: empty, or one a vertex; 0: none
    std::vector<PlcFacet> facets;
    std::vector<PlcSegment> segments;
    std::vector<Vec3> hole_seeds;
    std::vector<RegionSeed> region_seeds;
    Names names;  ///< of the markers of vertices, segments and facets, and of the ids of region seeds
    FillRule fill = FillRule::bounded_cells;
    MergeRule merge_coplanar = MergeRule::triangles;  ///< facets with different markers are never merged

    /// Rounding that the coordinates underwent before they became doubles, as a fraction of the largest coordinate:
    /// 2^-24 for float32 files, 0.5e-6 for text with six significant digits, 0 when the doubles are the truth.
    double relative_rounding = 0;

    /// Where the input came from, for messages. Lines count from 1; empty when unknown (binary files, programs).
    std::string source_name;
    std::vector<std::uint32_t> vertex_lines, facet_lines;
    std::uint32_t first_number = 0;  ///< number of the first vertex in the source's own counting (0 or 1)
};

}  // namespace wellmesh
