// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "conforming/conforming_mesh.hpp"
#include "core/workers.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh {

/// The domain's part of the mesh, vertices renumbered in order of insertion; ghosts, holes and the outside are left behind.
/// @param order  gets the tetrahedra in the order of the output.
[[nodiscard]] TetMesh extract_mesh(const ConformingMesh& mesh, std::vector<TetId>& order, Workers& workers);
[[nodiscard]] inline TetMesh extract_mesh(const ConformingMesh& mesh) {
    std::vector<TetId> order;
    Workers alone;
    return extract_mesh(mesh, order, alone);
}

/// Largest angle by which two subfaces of one facet bend in an edge that is no subsegment: 0 but for rounding.
[[nodiscard]] double largest_bend_rad(const TetMesh& mesh);

}  // namespace wellmesh
