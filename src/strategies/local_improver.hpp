// SPDX-License-Identifier: Apache-2.0
// Section 6 of [LiTeng01]: a sliver is removed only if its picking region, or that of the subface or subsegment that its circumcentre
// encroaches, holds a point for which every new tetrahedron is better than the sliver. Worst sliver first; the best of the tries is taken.
//
// We differ: a point is refused, too, if it would leave anything encroached, too large or of too large a radius-edge ratio. The paper would
// split that next, and nothing says that this makes nothing worse. So with an infinite b the worst tetrahedron never gets worse.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "conforming/boundary_refiner.hpp"
#include "conforming/conforming_mesh.hpp"
#include "core/run_guard.hpp"
#include "refinement/sliver_rule.hpp"
#include "sizing/size_field.hpp"

namespace wellmesh {

class LocalImprover {
public:
    /// @param rule  tells slivers. New tetrahedra of at least b circumradii of the sliver may be worse than it, as the paper allows; with an
    ///              infinite b none may.
    LocalImprover(ConformingMesh& mesh, BoundaryRefiner& boundary, RunGuard& guard, const SizeField& sizes, double max_radius_edge,
                  const SliverRule& rule)
        : mesh_(mesh), boundary_(boundary), guard_(guard), sizes_(sizes), squared_radius_edge_(max_radius_edge * max_radius_edge), rule_(rule) {}

    /// Works until no sliver is left, or none can be improved, or the mesh has so many vertices, or the guard says stop.
    RunGuard::Verdict improve(std::uint64_t vertex_budget);
    [[nodiscard]] bool budget_spent() const { return budget_spent_; }
    [[nodiscard]] std::uint64_t insertions() const { return insertions_; }

private:
    /// By corners, as an insertion that is undone gives the tetrahedra around it new ids.
    struct Waiting {
        double excess = 0;
        TetStore::Corners corners{};
        friend bool operator<(const Waiting& a, const Waiting& b) { return a.excess != b.excess ? a.excess < b.excess : b.corners < a.corners; }
    };
    /// A picking region.
    struct Region {
        Placement where{};
        Vec3 centre{};
        double radius = 0;  ///< of the element's own sphere
        std::uint64_t key = 0;
        unsigned tries = 0;
    };

    RunGuard::Verdict pass(std::uint64_t vertex_budget);
    bool remove(TetId t);
    void find_regions(TetId t);
    [[nodiscard]] unsigned best_try(TetId t, const Region& region, double limit);
    [[nodiscard]] bool region_of(const Subface& s, Region& region);
    [[nodiscard]] Region region_of(const Subsegment& s) const;
    [[nodiscard]] Vec3 candidate(const Region& region, unsigned k) const;
    [[nodiscard]] double judge_candidate(TetId t, const Region& region, double limit);
    [[nodiscard]] bool fits(double limit, double smallness) const;
    [[nodiscard]] double badness(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) const;
    [[nodiscard]] double badness(TetId t) const;
    [[nodiscard]] bool in_bounds(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, CellId cell, double& squared_radius) const;
    [[nodiscard]] double excess(TetId t) const;
    [[nodiscard]] bool counts(TetId t) const { return mesh_.tets().is_finite(t) && mesh_.in_domain(t); }
    void push(TetId t);
    [[nodiscard]] bool is_stuck(const TetStore::Corners& corners);
    void touch(const std::vector<TetId>& tets);

    ConformingMesh& mesh_;
    BoundaryRefiner& boundary_;
    RunGuard& guard_;
    const SizeField& sizes_;
    double squared_radius_edge_;
    SliverRule rule_;
    bool budget_spent_ = false;
    std::uint64_t insertions_ = 0;
    std::vector<Waiting> heap_;
    std::vector<Region> regions_;
    std::uint64_t clock_ = 0;
    std::vector<std::uint64_t> touched_;                    // per vertex: when its star changed last
    std::unordered_map<std::uint64_t, std::uint64_t> stuck_;  // by corners: when no try was good; looked up, never iterated
    Cavity cavity_;
    ConformingMesh::Snapshot before_;
    std::vector<Subsegment> encroached_segments_;
    std::vector<Subface> encroached_faces_;
};

}  // namespace wellmesh
