// SPDX-License-Identifier: Apache-2.0
// Simplices of the complex may meet only in common vertices and edges. Everything else is listed.
#pragma once

#include "core/checkpoint.hpp"
#include "validation/merge_coplanar.hpp"
#include "validation/report.hpp"
#include "validation/rounding.hpp"
#include "validation/working_complex.hpp"

namespace wellmesh {

/// Reports each pair of facets (or facet and segment, ...) that meets where it must not once, with a point of the intersection. Exact.
/// The triangles are those of the input, so merging facets by tolerance neither hides nor invents anything.
///
/// Two triangles meet outside of common vertices and edges iff an edge of one meets the other and shares no end with it, or they are
/// coplanar and folded over a common edge, or have the same corners. So edges are searched for, in a tree of the triangles' boxes;
/// many triangles about one vertex cost a comparison of numbers each.
void find_intersections(const CleanInput& input, const Soup& soup, const EdgeTable& edges, Report& report,
                        const Checkpoint& checkpoint = {});

/// Reports vertices that lie within `rounding.contact()` of a facet or segment that they do not belong to, without touching it: what
/// separates them is below the last bits of the coordinates. Triangles in the same merged facet are only tested against segments.
void find_thin_features(const CleanInput& input, const Soup& soup, const EdgeTable& edges, const FacetGroups& groups, const Rounding& rounding,
                        Report& report);

}  // namespace wellmesh
