// SPDX-License-Identifier: Apache-2.0
// Passes of moves, and of what there is in place of them, on several threads: where much is bad, space is cut into zones, and each zone's part of the work is
// done in a view of the mesh, in the order that it would have there. What would leave its zone waits for other cuts, or in the end for the whole mesh. Zones depend
// on what is bad and on the mesh's size, never on the number of threads; so does what comes of it.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "conforming/boundary_refiner.hpp"
#include "conforming/conforming_mesh.hpp"
#include "core/run_guard.hpp"
#include "core/workers.hpp"
#include "shape/best_insertion.hpp"
#include "shape/last_resort.hpp"
#include "shape/mending.hpp"
#include "shape/tet_judge.hpp"
#include "shape/vertex_mover.hpp"

namespace wellmesh {

class ZonePasses {
public:
    ZonePasses(ConformingMesh& mesh, BoundaryRefiner& boundary, RunGuard& guard, Workers& workers, const TetJudge& judge, VertexMover& mover, BestInsertion& insertion,
               Mending& mending)
        : mesh_(mesh), boundary_(boundary), guard_(guard), workers_(workers), judge_(judge), mover_(mover), insertion_(insertion), mending_(mending) {}

    /// Takes what it can from the waiting ones of a pass that has begun.
    RunGuard::Verdict mend(unsigned samples, LastResort last_resort);
    /// The same with vertices that are to be smoothed; those that are not done stay, in some order.
    RunGuard::Verdict smooth(std::vector<VertexId>& vertices, double floor);

private:
    class Team;
    template <class Work>
    RunGuard::Verdict share_out(std::vector<VertexId>& vertices, std::size_t zones, unsigned turn, const Work& work);

    ConformingMesh& mesh_;
    BoundaryRefiner& boundary_;
    RunGuard& guard_;
    Workers& workers_;
    const TetJudge& judge_;
    VertexMover& mover_;
    BestInsertion& insertion_;
    Mending& mending_;
};

}  // namespace wellmesh
