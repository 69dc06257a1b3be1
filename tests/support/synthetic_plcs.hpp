// SPDX-License-Identifier: Apache-2.0
// Domains made by code: exact plane coordinates, and the same under rotation, shift and scale.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "wellmesh/plc.hpp"

namespace wellmesh::testing {

Plc cube(double side = 1);               ///< one region, 6 square facets
Plc l_block(double side = 1);            ///< three unit cells in an L
Plc cube_with_cavity();                  ///< 3 x 3 x 3 cells without the middle one (a hole seed in it)
Plc cube_with_internal_facet();          ///< two cells side by side, two regions
Plc stepped_shaft();                     ///< two octagonal prisms of different width on one axis (dihedral angles 135 and 90 degrees)

/// One to six random boxes of a 4 x 4 x 4 lattice, added or carved out, with one to three regions: cavities, handles, edges and vertices that
/// touch, facets with holes. All angles are 90 degrees or more.
struct RandomPolycube {
    Plc plc;
    std::map<std::int32_t, int> cells_of_region;  ///< unit cells by region: the volumes
};
RandomPolycube random_polycube(std::uint64_t seed);

struct NamedPlc { std::string name; Plc plc; };
std::vector<NamedPlc> all_synthetic_plcs();

/// Rotation by a fixed arbitrary rotation drawn from `seed`, then scale, then shift (in diagonals of the scaled domain, along (1,1,1)).
Plc transformed(Plc plc, std::uint64_t rotation_seed, double shift_diagonals, double scale);

double diagonal(const Plc& plc);

}  // namespace wellmesh::testing
