// SPDX-License-Identifier: Apache-2.0
// Valid domains whose angles are as acute as can be, made by code. benchmarks/acute_inputs.py makes the same kinds, for tables.
#pragma once

#include <cstdint>
#include <string>

#include "support/synthetic_plcs.hpp"
#include "wellmesh/plc.hpp"

namespace wellmesh::testing {

Plc wedge(double angle_deg);                                      ///< a triangular prism of unit length, two unit squares at this angle
Plc spike(double angle_deg, int sides = 5);                       ///< a pyramid of unit height, opposite slopes at about this angle
Plc fan(int blades);                                              ///< rectangles around one segment in the unit cube, at equal angles
Plc two_blades(double angle_deg);                                 ///< two such rectangles at this angle
Plc tip_to_tip(double gap_deg, int sides, double twist);          ///< two open cones in the unit cube, the gap between their slopes
Plc touching_triangles(double angle_deg);                         ///< corners of triangles inside a rectangle's edge, one at this angle to it
Plc segments_on_a_facet(double angle_deg);                        ///< from its inside, a corner and an edge
Plc bumpy_ball(int rings);                                        ///< triangulated, of twice as many meridians, its radius between 0.8 and 1.2
Plc bundle(std::uint64_t seed, int triangles);                    ///< triangles around one segment in the unit cube, at random angles

/// A box around 8 to 40 random points in a cube, a thin slab or a needle, 35 % of the faces of their Delaunay triangulation as facets and 10 % of its
/// other edges as segments.
Plc random_complex(std::uint64_t seed);

/// One of all these kinds, its parameters, rotation and scale by the seed. Angles go down to 0.01 degrees.
NamedPlc random_acute(std::uint64_t seed);

}  // namespace wellmesh::testing
