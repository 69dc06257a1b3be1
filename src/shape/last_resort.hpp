// SPDX-License-Identifier: Apache-2.0
// What is left to try for a tetrahedron that no move mends: a vertex taken out, or the best insertion.
#pragma once

#include <cstdint>

#include "conforming/conforming_mesh.hpp"
#include "shape/best_insertion.hpp"
#include "shape/mending.hpp"
#include "shape/vertex_mover.hpp"

namespace wellmesh {

enum class LastResort : std::uint8_t { none, insert, remove_or_insert };

/// @return whether anything changed; of a view: if not, it may also have left its zone
bool try_last_resort(LastResort which, ConformingMesh& mesh, VertexMover& mover, BestInsertion& insertion, Mending& mending, const TetJudge& judge, const Bad& bad,
                     const TetStore::Corners& freest_first);

}  // namespace wellmesh
