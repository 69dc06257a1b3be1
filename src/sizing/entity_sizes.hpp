// SPDX-License-Identifier: Apache-2.0
// Edge lengths that are asked for on cells of the input: by options, by the input's own sizes, by curvature.
#pragma once

#include <vector>

#include "validation/valid_plc.hpp"
#include "wellmesh/options.hpp"

namespace wellmesh {

/// Input units; infinite: nothing is asked. Arrays as in ValidPlc.
struct EntitySizes {
    std::vector<double> vertices, segments, facets, cells;
};

/// The same with ids for names: several, where several markers share the name.
/// @throws MeshError{bad_options} for a name that nothing in the input has, naming those that there are
[[nodiscard]] std::vector<EntitySize> with_ids(const std::vector<EntitySize>& entities, const Names& names);

/// What `goals` state for vertices, segments, facets and regions, and for vertices the input itself.
/// @pre no entity is named: with_ids(). @throws MeshError{bad_options} for an id that nothing in the input has, naming those that there are
[[nodiscard]] EntitySizes stated_sizes(const ValidPlc& plc, const SizeGoals& goals);

/// Lowers the sizes of facets and segments to the length of which `elements` make a full circle of their own curvature.
///
/// Two facets that meet at one segment and turn by at most kSmoothTurnDeg there are taken for pieces of one smooth surface, two other segments that
/// alone meet in a vertex and turn by no more for pieces of one smooth curve. The curvature of a facet is the larger principal one of the tensor that the
/// turns at its segments make, each shared by the two facets, over its area [CohenSteiner03]: exact for prisms about a circle and for a sphere of
/// equilateral triangles. That of a segment is half the turns at its ends over its length.
void add_curvature_sizes(const ValidPlc& plc, double elements, EntitySizes& sizes);
/// Between the turns of a circle of twelve pieces (30) and of eight (45), which may be an octagon.
inline constexpr double kSmoothTurnDeg = 40;

}  // namespace wellmesh
