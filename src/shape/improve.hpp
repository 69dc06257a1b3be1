// SPDX-License-Identifier: Apache-2.0
// Raises the smallest dihedral angle of a conforming Delaunay mesh without leaving the Delaunay and Gabriel properties: worst tetrahedron
// first, its vertices are moved along their carriers (inside their cell, in their facet, along their segment) to the best of sampled
// places; where no move helps, the best of sampled insertions; last, the tetrahedra that are left are split with the ordinary cascade
// and moves begin again. A move is accepted only if every tetrahedron that it makes is better than the worst one that it destroys, so
// the moves end.
//
// Relocation by sampling follows [Tournois09] and [EdelsbrunnerEtAl00] in spirit; the vertex is taken out of the triangulation once and every
// candidate is judged by its cavity there, nothing is inserted for a trial.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "conforming/boundary_refiner.hpp"
#include "conforming/conforming_mesh.hpp"
#include "core/run_guard.hpp"
#include "refinement/refine.hpp"

namespace wellmesh {

struct ImproveStatistics {
    std::uint64_t moves = 0, attempts = 0, evaluations = 0, insertions = 0, splits = 0, undone = 0;
};

class ShapeImprover {
public:
    ShapeImprover(ConformingMesh& mesh, BoundaryRefiner& boundary, Refiner& refiner, RunGuard& guard, std::uint64_t seed)
        : mesh_(mesh), boundary_(boundary), refiner_(refiner), guard_(guard), seed_(seed) {}

    /// Works until every dihedral angle of the domain is at least `angle_deg`, or nothing helps, or the guard says stop.
    RunGuard::Verdict improve(double angle_deg);
    [[nodiscard]] const ImproveStatistics& statistics() const { return statistics_; }
    /// Tetrahedra of the domain below the angle now.
    [[nodiscard]] std::size_t count_bad(double angle_deg) const;

private:
    struct Bad {
        double cosine = 0;
        TetId tet{};
        std::uint32_t fingerprint = 0;
        friend bool operator<(const Bad& a, const Bad& b) { return a.cosine != b.cosine ? a.cosine < b.cosine : b.tet < a.tet; }
    };
    struct Candidate {
        Vec3 point{};
        double cosine = 0;
    };

    RunGuard::Verdict pass(double goal_cosine, unsigned samples, bool may_insert);
    void mend(const TetStore::Corners& corners, unsigned samples, bool may_insert);
    [[nodiscard]] TetId find_tet(const TetStore::Corners& corners);
    bool move_vertex(VertexId v, TetId worst, unsigned samples);
    bool insert_best(TetId t);
    [[nodiscard]] bool still_there(const Bad& bad) const;
    [[nodiscard]] double cosine_of(TetId t) const;
    [[nodiscard]] bool within_bounds(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, CellId cell) const;
    [[nodiscard]] bool is_within_bounds(TetId t) const;
    /// Largest cosine of the star of cavity.point, or more than `limit` as soon as that is certain.
    [[nodiscard]] double star_cosine(const Cavity& cavity, const Placement& where, double limit) const;
    void propose(VertexId v, TetId worst, const Placement& where, unsigned samples);
    [[nodiscard]] Vec3 on_carrier(const Placement& where, const Vec3& p) const;
    [[nodiscard]] bool placement_of(VertexId v, const std::vector<TetId>& star, Placement& where) const;
    [[nodiscard]] bool fits(const std::vector<TetId>& tets, double cosine) const;
    void touch(const std::vector<TetId>& tets);

    ConformingMesh& mesh_;
    BoundaryRefiner& boundary_;
    Refiner& refiner_;
    RunGuard& guard_;
    std::uint64_t seed_;
    double goal_cosine_ = 1;
    std::uint64_t clock_ = 0;
    std::vector<std::uint64_t> touched_;  // per vertex: when its star changed last
    struct Stuck {
        std::uint64_t when = 0;
        unsigned failures = 0;
    };
    std::unordered_map<std::uint64_t, Stuck> stuck_;  // by corners; looked up, never iterated
    std::vector<Bad> heap_;
    Hole hole_;
    Cavity cavity_;
    ConformingMesh::Snapshot star_before_, cavity_before_;
    std::vector<Vec3> proposals_;
    std::vector<Candidate> ranked_;
    std::vector<double> filling_cosine_;
    std::vector<TetId> filling_, star_;
    std::vector<Subsegment> encroached_segments_;
    std::vector<Subface> encroached_faces_;
    ImproveStatistics statistics_;
};

}  // namespace wellmesh
