// SPDX-License-Identifier: Apache-2.0
// Tetrahedra that the input's own acute angles force below the quality goals.
#pragma once

#include <cstdint>
#include <optional>

#include "wellmesh/error.hpp"

namespace wellmesh {

/// One such tetrahedron and what forces it: two of its vertices lie on cells of the input that meet at an acute angle.
struct Exemption {
    std::uint64_t tet = 0;   ///< number, from 0, in TetMesh::tets
    ElementRef feature{};    ///< the input vertex or segment at which they meet, with its place
    double angle_deg = 0;    ///< the smallest angle between cells of the input there
};

}  // namespace wellmesh
