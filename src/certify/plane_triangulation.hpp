// SPDX-License-Identifier: Apache-2.0
// Triangles that cover a facet of a PLC.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "certify/triangle_tree.hpp"
#include "wellmesh/plc.hpp"

namespace wellmesh::certifying {

/// Triangles that cover what belongs to the facet: all that can neither be reached from outside nor from a hole point without crossing an
/// edge of one of its polygons.
///
/// A constrained triangulation of the polygons' edges after one coordinate is dropped: the remaining two are exact, so topology is
/// decided by exact predicates. Edges that cross (rounding can push a vertex across an edge that it should touch) get a vertex where they
/// do, the only rounded coordinates here. Nearly Delaunay: flips need not decide ties. O(n log n) expected.
///
/// @param facet  vertex numbers within `points`, coordinates finite; need not be planar: corners are where the PLC has them.
/// @return empty for a facet without area, as far as rounding can tell. nullopt if the edges cross too often to be untangled.
[[nodiscard]] std::optional<std::vector<Corners>> triangulate_facet(const std::vector<Vec3>& points, const PlcFacet& facet);

}  // namespace wellmesh::certifying
