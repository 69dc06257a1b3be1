// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

#include "conforming/conforming_mesh.hpp"
#include "core/workers.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh {

/// The domain's part of the mesh, input vertices in the input's order, the others along a curve; ghosts, holes and the outside are left behind. The mesh is used up: it need not be
/// there twice.
/// @param look  is called while the mesh is still whole, with the tetrahedra in the order of the output
[[nodiscard]] TetMesh extract_mesh(ConformingMesh&& mesh, Workers& workers, const std::function<void(std::span<const TetId> order)>& look);
/// Leaves the mesh as it is.
[[nodiscard]] inline TetMesh extract_mesh(const ConformingMesh& mesh) {
    Workers alone;
    return extract_mesh(ConformingMesh(mesh), alone, [](std::span<const TetId>) {});
}

/// Largest angle by which two subfaces of one facet bend in an edge that is no subsegment: 0 but for rounding.
[[nodiscard]] double largest_bend_rad(const TetMesh& mesh);

}  // namespace wellmesh
