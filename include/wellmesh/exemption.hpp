// SPDX-License-Identifier: Apache-2.0
// Tetrahedra that the input's own acute angles, or gaps too narrow to be filled, keep below the quality goals.
#pragma once

#include <cstdint>
#include <optional>

#include "wellmesh/error.hpp"

namespace wellmesh {

/// One such tetrahedron and what forces it: two of its vertices lie on cells of the input that meet at an acute angle, or on the two sides of a gap.
struct Exemption {
    std::uint64_t tet = 0;   ///< number, from 0, in TetMesh::tets
    ElementRef feature{};    ///< the input vertex or segment at which they meet, with its place; or the vertex, segment or facet on one side of the gap
    double angle_deg = 0;    ///< the smallest angle between cells of the input there; 0 for a gap: its sides do not meet
};

}  // namespace wellmesh
