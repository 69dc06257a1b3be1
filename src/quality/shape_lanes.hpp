// SPDX-License-Identifier: Apache-2.0
// Shape measures of several tetrahedra at once, squared, so that neither roots nor arctangents are needed to tell which are worth a closer look.
#pragma once

#include <array>
#include <cstddef>

namespace wellmesh {

inline constexpr std::size_t kShapeLanes = 16;
using ShapeLane = std::array<double, kShapeLanes>;

/// Corners a, b, c, d of each tetrahedron, by coordinates.
struct CornerLanes {
    alignas(64) std::array<std::array<ShapeLane, 3>, 4> at;
};

/// Of positive tetrahedra; of others only the volumes mean something.
struct SquaredShapes {
    alignas(64) ShapeLane six_volumes;                  ///< signed; bit by bit those of six_volumes()
    alignas(64) ShapeLane shortest_edge, radius_edge, sigma;  ///< squares of TetShape's
    alignas(64) ShapeLane scaled_radius;                ///< square of circumradius times twelve volumes
    alignas(64) std::array<ShapeLane, 4> areas;         ///< squares of twice the faces' areas
    /// c |c| for the largest and the smallest cosine c of a dihedral angle: of the smallest and the largest angle.
    alignas(64) ShapeLane largest_cosine, smallest_cosine;
};

/// Within 1e-12 of what shape_of() says, relative to it, or absolute for the cosines, of tetrahedra for which this holds: nothing over- or underflows.
inline bool may_trust(const SquaredShapes& s, std::size_t lane) {
    return s.scaled_radius[lane] < 1e280 && s.shortest_edge[lane] > 1e-60 && s.six_volumes[lane] * s.six_volumes[lane] > 1e-200;
}
void square_shapes(const CornerLanes& corners, SquaredShapes& shapes) noexcept;

}  // namespace wellmesh
