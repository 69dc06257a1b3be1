// SPDX-License-Identifier: Apache-2.0
// Takes superfluous vertices out. Splits come in cascades, which leave thin parts twice as fine as they need to be, and evenly so that no
// single vertex can go. So one goes, a neighbour on the same segment or facet closes up, and moves mend what that has made worse;
// if all of it is as good as the goal then, the chain is kept, else undone.
#pragma once

#include <cstdint>
#include <vector>

#include "conforming/boundary_refiner.hpp"
#include "conforming/conforming_mesh.hpp"
#include "core/run_guard.hpp"
#include "shape/tet_judge.hpp"
#include "shape/vertex_mover.hpp"

namespace wellmesh {

class Thinning {
public:
    Thinning(ConformingMesh& mesh, BoundaryRefiner& boundary, RunGuard& guard, const TetJudge& judge, VertexMover& mover)
        : mesh_(mesh), boundary_(boundary), guard_(guard), judge_(judge), mover_(mover) {}

    /// Takes out what can go of the vertices from slot `first_new` on, then of all as long as there are more than `enough`.
    RunGuard::Verdict run(std::size_t first_new, std::size_t enough);

private:
    RunGuard::Verdict sweep(std::size_t first, std::size_t enough, std::size_t trials);
    bool dissolve(VertexId v);
    bool merge(VertexId v, VertexId into, const Vec3& home, double limit);
    bool mend();
    void take_note();
    void find_neighbours(VertexId v);
    [[nodiscard]] bool all_is_well();

    ConformingMesh& mesh_;
    BoundaryRefiner& boundary_;
    RunGuard& guard_;
    const TetJudge& judge_;
    VertexMover& mover_;

    std::vector<TetStore::Corners> bad_;  // made by the chain
    std::vector<VertexId> touched_;       // by the chain; may repeat
    std::vector<VertexId> neighbours_;
    std::vector<TetId> star_;
};

}  // namespace wellmesh
