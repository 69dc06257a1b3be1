// SPDX-License-Identifier: Apache-2.0
// Facets of the complex: maximal pieces of the triangle soup that lie in one plane and have no segment inside.
#pragma once

#include "validation/plane.hpp"
#include "validation/rounding.hpp"
#include "validation/working_complex.hpp"

namespace wellmesh {

struct FacetGroups {
    std::vector<std::uint32_t> group_of;               ///< for each soup triangle; numbered by lowest triangle
    std::vector<std::vector<std::uint32_t>> triangles; ///< of each group, ascending
    std::vector<std::vector<VertexId>> vertices;       ///< of each group, ascending
    std::vector<FittedPlane> planes;                   ///< of each group; normal agrees with its first triangle
    std::vector<char> is_segment;                      ///< for each edge of the table
    /// For each soup triangle, 1 if it must be turned to agree with its group's normal.
    std::vector<char> is_turned;
    /// Needles kept out of a group within rounding, as they turn the wrong way in its plane and take a vertex out of its outline.
    std::vector<std::uint32_t> peeled;
};

/// Joins triangles across edges that are not hard, have exactly two triangles and the same marker on both sides: always within one
/// stated facet; where both lie exactly in one plane; and where the joined facet as a whole stays within `rounding.merging()` of one
/// plane. The last condition bounds a distance, not an angle: however fine a curved surface is triangulated, no piece of it melts into
/// a facet that leaves the input by more than rounding. Triangles folded onto each other are never joined, but for needles lower than
/// the tolerance, which have no side of their own.
[[nodiscard]] FacetGroups merge_coplanar(const CleanInput& input, const Soup& soup, const EdgeTable& edges, const Plc& plc, const Rounding& rounding);

}  // namespace wellmesh
