// SPDX-License-Identifier: Apache-2.0
// Turns stated facets into triangles: planarity, triangulation, edges split at vertices of their own facet.
#pragma once

#include "validation/report.hpp"
#include "validation/rounding.hpp"
#include "validation/working_complex.hpp"

namespace wellmesh {

/// Triangulates every facet of `input`. Single triangles stay what they are. Facets of several vertices are checked to be planar to
/// `rounding.accepting()` (error: facet, worst vertex, distance) and triangulated; their polygon edges become hard edges, split at
/// vertices of the same facet that lie on them; other facets with such an edge are split alike. Adds vertices' chains to `input`.
/// Edges that cross inside a facet are errors (self_intersection).
[[nodiscard]] Soup make_soup(CleanInput& input, const Plc& plc, const Rounding& rounding, Report& report);

}  // namespace wellmesh
