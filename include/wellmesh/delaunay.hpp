// SPDX-License-Identifier: Apache-2.0
// Plain Delaunay triangulation of points, without any domain.
#pragma once

#include <cstdint>
#include <span>

#include "wellmesh/tet_mesh.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh {

struct DelaunayResult {
    TetMesh mesh;  ///< vertices: `points` in their order, duplicates included (used by no tetrahedron); every tetrahedron in region 1
    std::uint64_t duplicates = 0;  ///< points equal to another one. Which of them is the vertex depends on the points alone; not always the first of the input
};

/// The Delaunay triangulation of `points`; cospherical ties are broken by lexicographic order, so it does not depend on their order.
/// @param threads  at work, the caller's among them; 0: as many as the machine has cores. Never changes the result.
/// @throws MeshError{bad_input} for fewer than four affinely independent points or coordinates that are not finite;
///         MeshError{coordinate_range} outside the range in which the predicates are exact.
/// Expected O(n log n) for well-spread points, O(n^2) at worst.
[[nodiscard]] DelaunayResult triangulate_points(std::span<const Vec3> points, unsigned threads = 0);

}  // namespace wellmesh
