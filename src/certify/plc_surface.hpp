// SPDX-License-Identifier: Apache-2.0
// The geometry of a PLC as the certifier sees it, computed without src/validation.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "certify/triangle_tree.hpp"
#include "wellmesh/plc.hpp"

namespace wellmesh::certifying {

struct PlcEdge {
    std::uint32_t a = 0, b = 0;  ///< PLC vertices
    std::vector<std::uint32_t> facets;  ///< that have it as a polygon edge, ascending; none: an entry of Plc::segments only
};

struct PlcSurface {
    std::vector<Vec3> points;                ///< the PLC's vertices; coordinates too small for exact predicates became zero
    TriangleTree triangles;                  ///< cover the facets, repeated ones once
    std::vector<bool> dangling;              ///< of each triangle, whether it bounds no cell whatever is filled: part of a fin, flap or free sheet
    std::vector<std::uint32_t> facets;       ///< of each triangle, its facet
    std::vector<std::uint32_t> facet_vertices, other_vertices;  ///< used by facets; by none, leftovers of surface files apart. Of vertices at one place, the first
    /// Edges that a conforming mesh must have: entries of Plc::segments, and polygon edges of facets with an area, except those at which exactly two triangles, of
    /// different facets, are flat together: a mesher may have merged the two.
    std::vector<PlcEdge> edges;
    double diagonal = 0;                     ///< of the bounding box of all vertices
};

struct PlcReading {
    std::optional<PlcSurface> surface;
    std::string problem;  ///< why there is none
};

/// @param flat_angle  radians. @param relative_tolerance  of the diagonal: triangles that bend by less than 4 tolerances over the lower of
///                    their heights are flat together, too; so are those that rounding may have bent.
[[nodiscard]] PlcReading read_surface(const Plc& plc, double flat_angle, double relative_tolerance);

}  // namespace wellmesh::certifying
