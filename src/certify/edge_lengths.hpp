// SPDX-License-Identifier: Apache-2.0
// Lengths of the mesh's edges.
#pragma once

#include <cstdint>
#include <vector>

#include "certify/suspect_mesh.hpp"
#include "certify/tets_by_corner.hpp"
#include "wellmesh/certificate.hpp"

namespace wellmesh::certifying {

/// What a tetrahedron counts as in statistics.
enum class TetClass : std::uint8_t { left_out, interior, boundary };

/// Fills min_edge, mean_edge and max_edge of the three statistics: each edge counts once in `all`, and once in each of `interior` and
/// `boundary` that has a tetrahedron at it. O(n) time on graded meshes.
/// @param classes  one entry a tetrahedron; the corners of those not left out are distinct.
void measure_edges(const SuspectMesh& mesh, const TetsByCorner& stars, const std::vector<TetClass>& classes, ShapeStatistics& all, ShapeStatistics& interior,
                   ShapeStatistics& boundary);

}  // namespace wellmesh::certifying
