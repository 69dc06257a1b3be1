// SPDX-License-Identifier: Apache-2.0
// The output: a tetrahedral mesh that knows which input entity each element represents.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "wellmesh/names.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh {

/// Lowest-dimensional input entity that a mesh vertex lies on.
enum class CarrierKind : std::uint8_t { input_vertex, segment, facet, region };

struct VertexCarrier {
    CarrierKind kind = CarrierKind::region;
    std::uint32_t id = 0;  ///< number, from 0, of the input vertex, of the entry of `segments` or `facets`, or region reference
};

/// Arrays of equal meaning have equal length; all vertex numbers count from 0.
/// Every tetrahedron (a, b, c, d) is positively oriented: det(b - a, c - a, d - a) > 0 (docs/conventions.md).
struct TetMesh {
    std::vector<Vec3> vertices;
    std::vector<VertexCarrier> vertex_carriers;  ///< empty when the mesh was read from a file

    /// Squares of lengths, one a vertex. Where there are any the mesh is *weighted* Delaunay, and need not be Delaunay (docs/conventions.md). Empty: none.
    std::vector<double> weights;

    std::vector<std::array<std::uint32_t, 4>> tets;
    std::vector<std::int32_t> tet_regions;  ///< region reference of each tetrahedron

    std::vector<std::array<std::uint32_t, 3>> subfaces;  ///< mesh faces that represent facets
    std::vector<std::int32_t> subface_facets;            ///< reference: number, from 1, of the (merged) input facet
    std::vector<std::int32_t> subface_markers;           ///< the input's marker of that facet

    std::vector<std::array<std::uint32_t, 2>> subsegments;  ///< mesh edges that represent segments
    std::vector<std::int32_t> subsegment_segments;          ///< reference: number, from 1, of the segment
    std::vector<std::int32_t> subsegment_markers;           ///< the input's marker of that segment; or empty: all 0

    std::vector<std::int32_t> vertex_markers;  ///< the input's markers of its vertices, 0 for other vertices; or empty: all 0
    Names names;                               ///< of vertex markers, segment markers, facet markers and regions

    /// Rounding that the coordinates underwent before they became doubles, as Plc::relative_rounding. Known of meshes read from files; else 0.
    double relative_rounding = 0;
};

}  // namespace wellmesh
