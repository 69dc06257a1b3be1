// SPDX-License-Identifier: Apache-2.0
// Chains of changes about one vertex: a first step that leaves something worse, moves that mend that, and everything undone if they don't. Single steps
// that may make nothing worse end in local optima; chains lead out of some of them.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "conforming/boundary_refiner.hpp"
#include "conforming/conforming_mesh.hpp"
#include "shape/tet_judge.hpp"
#include "shape/vertex_mover.hpp"

namespace wellmesh {

class Chains {
public:
    Chains(ConformingMesh& mesh, BoundaryRefiner& boundary, const TetJudge& judge, VertexMover& mover, std::uint64_t seed)
        : mesh_(mesh), boundary_(boundary), judge_(judge), mover_(mover), seed_(seed) {}

    /// Tetrahedra that a chain may leave as they are although they miss the goal. Empty: none.
    std::function<bool(TetId)> tolerates{};

    /// Takes v out; if that alone does not do, a neighbour on the same segment or facet, or in the same cell, closes up.
    /// @return whether it is gone; every tetrahedron around is as good as the goal then, and nothing is encroached.
    bool dissolve(VertexId v);
    /// Shoves v some way along its carrier, in up to `trials` directions. @return whether it was, as for dissolve().
    bool shove(VertexId v, unsigned trials);

private:
    template <class Chain>
    bool attempt(Chain&& chain);
    bool close_up(VertexId into, const Vec3& home, double limit);
    bool mend();
    void take_note();
    void find_neighbours(VertexId v);
    [[nodiscard]] bool misses(TetId t) const;
    [[nodiscard]] bool all_is_well();

    ConformingMesh& mesh_;
    BoundaryRefiner& boundary_;
    const TetJudge& judge_;
    VertexMover& mover_;
    std::uint64_t seed_;

    std::vector<TetStore::Corners> bad_, bad_before_;  // made by the chain
    std::vector<VertexId> touched_, touched_before_;  // by the chain; may repeat
    std::vector<VertexId> neighbours_;
    std::vector<TetId> star_;
};

}  // namespace wellmesh
