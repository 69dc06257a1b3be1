// SPDX-License-Identifier: Apache-2.0
// What examine() tells beyond validity.
#pragma once

#include "validation/merge_coplanar.hpp"
#include "validation/report.hpp"
#include "validation/rounding.hpp"
#include "validation/working_complex.hpp"

namespace wellmesh {

/// An input under examination, valid or not.
struct Complexes {
    const CleanInput& input;
    const Soup& soup;
    const EdgeTable& edges;
    const FacetGroups& groups;
    [[nodiscard]] const Vec3& point(VertexId v) const { return input.points[v.index()]; }
};

/// Surface files: edges of more than two triangles, edges along which two triangles run in the same direction (warnings). Other complexes: edges at
/// which a facet ends without another one (notes).
void find_surface_defects(const Complexes& complex, Report& report);

/// Acute angles between segments of one triangle and between facets at a segment, sorted: what find_sharp_features() lists of valid complexes.
void find_acute_angles(const Complexes& complex, const Rounding& rounding, Report& report);

/// Region and hole seeds outside of the bounding box. (Which cell a seed is in can't be told before the complex is valid.)
void find_seeds_beyond(const Complexes& complex, Report& report);

/// Vertices, segments and facets without a common vertex that are closer than `limit`, but apart: nearest first (warnings).
void find_near_misses(const Complexes& complex, double limit, Report& report);

/// @pre may intersect itself; then the gap is 0 where it does.
[[nodiscard]] SmallestFeatures find_smallest_features(const Complexes& complex);

/// The smallest angle at each vertex between segments of one triangle, and at each segment between facets, in degrees, with the place of it.
struct PlacedAngle {
    double degrees = 0;
    std::vector<VertexId> at;  ///< the vertex, or both ends of the segment
};
[[nodiscard]] std::vector<PlacedAngle> placed_angles(const Complexes& complex);

}  // namespace wellmesh
