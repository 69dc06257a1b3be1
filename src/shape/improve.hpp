// SPDX-License-Identifier: Apache-2.0
// Raises the smallest dihedral angle of a conforming Delaunay mesh without leaving the Delaunay and Gabriel properties: worst tetrahedron
// first, its vertices move along their carriers; where that fails, the neighbourhood is smoothed towards the optimal Delaunay triangulation
// [ChenXu04] and moves are tried again; then a vertex is taken out, or put in, where that makes everything better [LiTeng01, section 6].
// What is left, mostly where the domain is one element thick, is split with the ordinary cascade, the smallest angles first, on a ladder of
// angles: a rung that can't be reached leaves the mesh of the last one. In the end vertices that turn out to be superfluous go again (thin_out.hpp).
//
// A move is accepted only if every tetrahedron that it makes is better than the worst one that it destroys, so the moves end; smoothing
// and splits are bounded in number.
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "conforming/boundary_refiner.hpp"
#include "conforming/conforming_mesh.hpp"
#include "core/run_guard.hpp"
#include "refinement/refine.hpp"
#include "shape/best_insertion.hpp"
#include "shape/blocks.hpp"
#include "shape/chains.hpp"
#include "shape/tet_judge.hpp"
#include "shape/thin_out.hpp"
#include "shape/vertex_mover.hpp"

namespace wellmesh {

struct ImproveStatistics {
    std::uint64_t moves = 0, smoothings = 0, removals = 0, attempts = 0, evaluations = 0, insertions = 0, splits = 0, undone = 0;
};

class ShapeImprover {
public:
    ShapeImprover(ConformingMesh& mesh, BoundaryRefiner& boundary, Refiner& refiner, RunGuard& guard, std::uint64_t seed)
        : mesh_(mesh),
          refiner_(refiner),
          guard_(guard),
          judge_(mesh, refiner.sizes(), refiner.max_radius_edge()),
          mover_(mesh, boundary, judge_, seed),
          insertion_(mesh, boundary, judge_, seed),
          chains_(mesh, boundary, judge_, mover_, seed),
          thinning_(mesh, guard, chains_) {}

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
    /// By corners, as taking a vertex out for a trial and putting it back gives tetrahedra new ids.
    struct Bad {
        double badness = 0;
        Corners corners{};
        std::uint32_t block = 0;  // of space
        friend bool operator<(const Bad& a, const Bad& b) { return a.badness != b.badness ? a.badness < b.badness : b.corners < a.corners; }
    };
    /// Block by block, so that what is worked on stays in the cache; the worst of a block first.
    struct IsLater {
        bool operator()(const Bad& a, const Bad& b) const { return a.block != b.block ? a.block > b.block : a < b; }
    };
    struct Stuck {
        std::uint64_t when = 0;
        std::uint64_t pass = 0;
        unsigned failures = 0;                      // since its neighbourhood changed last
        unsigned smoothings = 0, last_resorts = 0;  // in all
    };
    /// Moves of a vertex that failed since its star changed last.
    struct Tried {
        std::uint64_t when = 0, pass = 0;
        unsigned failures = 0;
    };
    enum class LastResort : std::uint8_t { none, insert, remove_or_insert };

    RunGuard::Verdict aim_at(double angle_deg, std::size_t vertices_at_start);
    RunGuard::Verdict settle(LastResort last_resort);
    RunGuard::Verdict pass(unsigned samples, LastResort last_resort);
    RunGuard::Verdict passes(unsigned samples, unsigned most, LastResort last_resort);
    bool mend(const Bad& bad, unsigned samples, LastResort last_resort);
    RunGuard::Verdict smooth_around_bad(unsigned rings);
    RunGuard::Verdict rescue();
    RunGuard::Verdict thin_out(std::size_t first_new, std::size_t enough);
    RunGuard::Verdict climb(double rung_cosine, std::size_t vertices_at_start, bool& reached);
    RunGuard::Verdict split_worse_than(double cosine);
    RunGuard::Verdict split_or_go_back(double cosine, const ConformingMesh& last);
    RunGuard::Verdict try_afresh();
    RunGuard::Verdict grade_afresh();
    void collect_bad();
    [[nodiscard]] double badness_of(TetId t);
    /// Is badness_of(t) certainly at most the goal? Mostly found faster than the badness.
    [[nodiscard]] bool is_surely_good(TetId t) const { return !refiner_.knows_forced() && judge_.is_surely_good(t); }
    [[nodiscard]] bool is_left_alone(TetId t) const;
    void leave_forced_alone();
    void touch(const std::vector<TetId>& tets);
    void push(TetId t, double badness);
    [[nodiscard]] Bad listed(TetId t, double badness) const;
    [[nodiscard]] double worst_cosine() const;

    ConformingMesh& mesh_;
    Refiner& refiner_;
    RunGuard& guard_;
    TetJudge judge_;
    VertexMover mover_;
    BestInsertion insertion_;
    Chains chains_;
    Thinning thinning_;

    Blocks blocks_;
    double goal_cosine_ = 1;
    bool leaves_forced_ = false;
    std::uint64_t clock_ = 0, pass_ = 0, splits_ = 0;
    std::vector<std::uint64_t> touched_;             // per vertex: when its star changed last
    std::vector<std::uint64_t> marked_;              // per vertex: stamp of the last collection that it belongs to
    std::unordered_map<std::uint64_t, Stuck> stuck_;  // by corners; looked up, never iterated
    std::unordered_set<std::uint64_t> given_up_;     // by corners: tetrahedra that no rung mended
    std::uint64_t splitting_ = 0;                    // the tetrahedron that is being split, by its corners
    std::vector<Tried> tried_;                       // per vertex
    std::vector<Bad> heap_, left_;
    std::vector<VertexId> around_;
    std::vector<TetId> star_;
};

}  // namespace wellmesh
