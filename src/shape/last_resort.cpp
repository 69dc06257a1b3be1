// SPDX-License-Identifier: Apache-2.0
#include "shape/last_resort.hpp"

#include <algorithm>

#include "shape/corners.hpp"

namespace wellmesh {

bool try_last_resort(LastResort which, ConformingMesh& mesh, VertexMover& mover, BestInsertion& insertion, Mending& mending, const TetJudge& judge, const Bad& bad,
                     const TetStore::Corners& freest_first) {
    Triangulation& tri = mesh.triangulation();
    bool left_zone = false;
    if (which == LastResort::remove_or_insert)
        for (const VertexId v : freest_first) {
            if (mover.remove(v, judge.goal())) {
                mending.touch(mover.changed());
                return true;
            }
            left_zone = left_zone || tri.left_zone();
            tri.forget_leaving();
        }
    const TetId t = find_tet(mesh, bad.corners, bad.last);
    if (t.valid() && insertion.insert(t, bad.badness - kWorthwhile).valid()) {
        mending.touch(insertion.changed());
        return true;
    }
    if (left_zone) tri.leave_zone();
    return false;
}

}  // namespace wellmesh
