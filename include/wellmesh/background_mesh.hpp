// SPDX-License-Identifier: Apache-2.0
// A size field on a mesh: what --background reads.
#pragma once

#include <vector>

#include "wellmesh/tet_mesh.hpp"

namespace wellmesh {

/// Target edge lengths at the vertices of a tetrahedral mesh, linear in its tetrahedra. The mesh need not be that of the domain; where it does not
/// reach, it asks for nothing.
struct BackgroundMesh {
    TetMesh mesh;
    std::vector<double> sizes;  ///< one a vertex, in input units; 0: nothing is asked in the tetrahedra of this vertex
};

}  // namespace wellmesh
