// SPDX-License-Identifier: Apache-2.0
// Raises the smallest dihedral angle of a conforming Delaunay mesh without leaving the Delaunay and Gabriel properties: block by block of space, the worst
// tetrahedron of a block first, vertices of bad tetrahedra move along their carriers, in zones on several threads where there is much to do; where that
// fails, a vertex is taken out, or put in, where that makes everything better [LiTeng01, section 6]; then the neighbourhood is smoothed towards the optimal
// Delaunay triangulation [ChenXu04] and all that is tried again. Most of what acute angles of the input force can't be mended: it is tried, but not for long.
// What is left, mostly where the domain is one element thick, is split with the ordinary cascade, the smallest angles first, on a ladder of
// angles: a rung that can't be reached leaves the mesh of the last one. In the end vertices that turn out to be superfluous go again (thin_out.hpp).
//
// A move is accepted only if every tetrahedron that it makes is better than the worst one that it destroys, so the moves end; smoothing
// and splits are bounded in number.
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_set>
#include <vector>

#include "conforming/boundary_refiner.hpp"
#include "conforming/conforming_mesh.hpp"
#include "conforming/savepoint.hpp"
#include "core/run_guard.hpp"
#include "core/workers.hpp"
#include "refinement/refine.hpp"
#include "shape/best_insertion.hpp"
#include "shape/chains.hpp"
#include "shape/last_resort.hpp"
#include "shape/mending.hpp"
#include "shape/tet_judge.hpp"
#include "shape/thin_out.hpp"
#include "shape/vertex_mover.hpp"
#include "shape/zone_passes.hpp"

namespace wellmesh {

struct ImproveStatistics {
    std::uint64_t moves = 0, smoothings = 0, removals = 0, attempts = 0, evaluations = 0, insertions = 0, splits = 0, undone = 0;
};

class ShapeImprover {
public:
    ShapeImprover(ConformingMesh& mesh, BoundaryRefiner& boundary, Refiner& refiner, RunGuard& guard, Workers& workers, std::uint64_t seed)
        : mesh_(mesh),
          boundary_(boundary),
          refiner_(refiner),
          guard_(guard),
          workers_(workers),
          judge_(mesh, refiner.sizes(), refiner.max_radius_edge()),
          mover_(mesh, boundary, judge_, seed),
          insertion_(mesh, boundary, judge_, seed),
          chains_(mesh, boundary, judge_, mover_, seed),
          mending_(mesh, judge_, mover_),
          zones_(mesh, boundary, guard, workers, judge_, mover_, insertion_, mending_),
          thinning_(mesh, guard, chains_) {
        mending_.goes_beyond_shape = refiner.may_excuse();
        mending_.badness = [this](TetId t) {
            const double how = badness_of(t);
            return how > judge_.goal() && is_left_alone(t) ? 0 : how;
        };
    }
    ShapeImprover(const ShapeImprover&) = delete;
    ShapeImprover& operator=(const ShapeImprover&) = delete;

    /// Works until every dihedral angle of the domain is at least `angle_deg`, or nothing helps, or the guard says stop. Angles beyond what meshes
    /// mostly reach are approached in steps, so that asking for more gives no less.
    RunGuard::Verdict improve(double angle_deg);
    /// The same by moves alone: no vertex comes or goes [EdelsbrunnerEtAl00, Tournois09].
    RunGuard::Verdict perturb(double angle_deg);
    [[nodiscard]] ImproveStatistics statistics() const;
    /// Tetrahedra of the domain below the angle now.
    [[nodiscard]] std::size_t count_bad(double angle_deg) const;

private:
    using Corners = TetStore::Corners;

    RunGuard::Verdict aim_at(double angle_deg, std::size_t vertices_at_start);
    RunGuard::Verdict try_each(LastResort last_resort);
    RunGuard::Verdict settle(LastResort last_resort);
    RunGuard::Verdict pass(unsigned samples, LastResort last_resort);
    RunGuard::Verdict passes(unsigned samples, unsigned most, LastResort last_resort);
    RunGuard::Verdict smooth_around_bad(unsigned rings);
    RunGuard::Verdict rescue();
    RunGuard::Verdict thin_out(std::size_t first_new, std::size_t enough);
    RunGuard::Verdict climb(double rung_cosine, std::size_t vertices_at_start, bool& reached);
    RunGuard::Verdict split_worse_than(double cosine);
    /// A savepoint, and what is bad after going back to it.
    class Retreat {
    public:
        Retreat(ConformingMesh& mesh, Mending& mending) : savepoint_(mesh), mending_(mending), collections_(mending.collections()) {}
        void go_back() { savepoint_.go_back(); }
        /// @pre go_back()
        void collect(Workers& workers) {
            if (mending_.collections() == collections_) mending_.collect_again(workers);
            else mending_.collect(workers);  // what was looked at meanwhile says nothing of the mesh that is back
            collections_ = mending_.collections();
        }

    private:
        Savepoint savepoint_;
        Mending& mending_;
        std::uint64_t collections_;  // when it began
    };
    RunGuard::Verdict split_or_go_back(double cosine, Retreat& last);
    RunGuard::Verdict try_afresh();
    RunGuard::Verdict grade_afresh();
    [[nodiscard]] double badness_of(TetId t);
    [[nodiscard]] bool is_left_alone(TetId t) const;
    void leave_forced_alone();
    [[nodiscard]] std::vector<Bad>& left() { return mending_.left(); }
    [[nodiscard]] std::uint32_t new_stamp();
    [[nodiscard]] double worst_cosine() const;

    ConformingMesh& mesh_;
    BoundaryRefiner& boundary_;
    Refiner& refiner_;
    RunGuard& guard_;
    Workers& workers_;
    TetJudge judge_;
    VertexMover mover_;
    BestInsertion insertion_;
    Chains chains_;
    Mending mending_;
    ZonePasses zones_;
    Thinning thinning_;

    bool leaves_forced_ = false;
    std::uint64_t splits_ = 0;
    std::vector<std::uint32_t> marked_;           // per vertex: stamp of the last collection that it belongs to
    std::uint32_t stamp_ = 0;                     // of the last collection
    std::unordered_set<std::uint64_t> given_up_;  // by corners: tetrahedra that no rung mended
    std::uint64_t splitting_ = 0;                 // the tetrahedron that is being split, by its corners
    std::vector<TetId> star_;
};

}  // namespace wellmesh
