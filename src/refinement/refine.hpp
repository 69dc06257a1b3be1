// SPDX-License-Identifier: Apache-2.0
// Delaunay refinement with sliver-aware points [LiTeng01, Shewchuk98]: every bad tetrahedron is split by a point of its picking region
// (the ball of radius delta R about its circumcentre), or, where its circumcentre encroaches a subsegment or subface, by a point of
// that one's picking region. The first candidate whose star holds no new sliver is taken.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <unordered_set>
#include <vector>

#include "conforming/acute_exemptions.hpp"
#include "conforming/boundary_refiner.hpp"
#include "conforming/conforming_mesh.hpp"
#include "conforming/savepoint.hpp"
#include "core/run_guard.hpp"
#include "core/workers.hpp"
#include "quality/shape_lanes.hpp"
#include "refinement/bad_tet_queue.hpp"
#include "refinement/sliver_rule.hpp"
#include "refinement/thin_gaps.hpp"
#include "sizing/size_field.hpp"
#include "wellmesh/options.hpp"

namespace wellmesh {

struct RefineStatistics {
    std::uint64_t insertions = 0, candidates = 0, fallbacks = 0;
    std::uint64_t guarded = 0;  ///< points inside refused because of Theorem 4.2 (BoundaryRefiner counts its own)
};

class Refiner {
public:
    /// @param workers  who shares in the work; none: the calling thread alone. What comes of it is the same.
    Refiner(ConformingMesh& mesh, BoundaryRefiner& boundary, RunGuard& guard, const MeshOptions& options, Workers* workers = nullptr);

    /// Splits until no tetrahedron of the domain violates its size or the radius-edge bound.
    /// @return what stopped it; the mesh conforms in any case.
    RunGuard::Verdict refine();
    /// Splits tetrahedron t with the cascade of refine(), then restores size and radius-edge bound in what that made; circumradii within
    /// kSizeTolerance of their bound stay, as moves may have made them.
    RunGuard::Verdict split(TetId t, InsertionReason reason);

    /// For tetrahedra that no split mended because a ball about an acute vertex is in the way: takes out what lies inside the domain around such a ball and
    /// fills it again, but grades no more out of what touches an acute feature there. A ball that is in the way once more is halved.
    RunGuard::Verdict grade_afresh(const std::vector<TetId>& stuck);
    /// Radii of the balls, which grade_afresh() changes beside the mesh: for an undo. Balls are not relieved any more then.
    [[nodiscard]] std::vector<double> balls() const { return boundary_.acute().balls(); }
    void set_balls(const std::vector<double>& radii) {
        boundary_.acute().set_balls(radii);
        relieved_.clear();
    }

    /// The mesh was put back to an earlier one after a split threw: what waits is of the abandoned one.
    void forget_waiting();

    /// From now on every pick avoids new small slivers, and refine() splits slivers, too, if the rule says so, after all else.
    void set_sliver_rule(const SliverRule& rule);
    /// From so many vertices on slivers are split no more; size and radius-edge ratio still are. Without: for as long as there are slivers.
    void set_sliver_budget(std::uint64_t vertices) { sliver_budget_ = vertices; }
    [[nodiscard]] bool sliver_budget_spent() const { return sliver_budget_spent_; }

    enum class Fault : std::uint8_t { none, size, radius_edge, flat, sliver };
    [[nodiscard]] Fault classify(TetId t, double& squared_badness) const;
    /// Does classify() surely find nothing, of one of several that were measured at once?
    [[nodiscard]] bool is_surely_faultless(TetId t, const SquaredShapes& shapes, std::size_t lane) const;
    /// The acute feature of the input that excuses a tetrahedron which misses a goal: one that it touches, or one whose ball holds the point
    /// that would split it. Empty if there is none.
    [[nodiscard]] std::optional<ForcedBy> forced_by(TetId t);
    /// Leaves gaps that would take more vertices than these as they are. @pre the mesh conforms, and is not refined yet.
    void leave_gaps(double most_vertices) {
        gaps_ = ThinGaps(mesh_, most_vertices, [this](TetId t) { return exemptions_.feature_at(t).has_value(); }, boundary_.acute().take_feature_size());
    }
    [[nodiscard]] const ThinGaps& gaps() const { return gaps_; }
    [[nodiscard]] bool is_in_gap(TetId t) const { return gaps_.sides_joined_by(mesh_, t).has_value(); }
    /// Is a tetrahedron that misses a goal of shape to be left as it is?
    [[nodiscard]] bool excuses(TetId t) { return is_in_gap(t) || forced_by(t).has_value(); }
    /// False: the input has neither acute angles nor gaps that are left, so nothing is excused.
    [[nodiscard]] bool may_excuse() const { return boundary_.acute().any() || gaps_.any(); }
    /// False: nothing can excuse this one. What forces a tetrahedron, or joins the sides of a gap, is an edge between vertices of the boundary.
    [[nodiscard]] static bool may_be_excused(const ConformingMesh& mesh, TetId t) {
        const TetStore::Corners& c = mesh.tets().corners(t);
        return std::count_if(c.begin(), c.end(), [&](VertexId v) { return mesh.info(v).carrier != CarrierKind::region; }) >= 2;
    }
    [[nodiscard]] const RefineStatistics& statistics() const { return statistics_; }
    [[nodiscard]] const SizeField& sizes() const { return sizes_; }
    /// Sets the guard of Theorem 4.2: no edge below its bound is made for quality. The reference is the shortest edge of the mesh as it is now,
    /// or, where less, the shortest that the size goals can ask for.
    void guard_edges();
    [[nodiscard]] std::uint64_t refused() const { return statistics_.guarded + boundary_.refused(); }
    [[nodiscard]] double max_radius_edge() const { return max_radius_edge_; }
    /// Cosine of the angle below which candidates are rejected; 1 or more: circumcentres only.
    void set_sliver_cosine(double cosine, unsigned candidates) {
        sliver_cosine_ = cosine;
        candidates_ = candidates;
        boundary_.candidates = candidates;
    }

private:
    /// For a view of a zone.
    Refiner(ConformingMesh& view, BoundaryRefiner& boundary, Refiner& whole);
    /// Much of drain(), on all workers, where much waits.
    void drain_in_zones();
    void drain_zone(const std::function<bool(std::size_t)>& may_go_on);
    void join(const Refiner& zone);
    [[nodiscard]] bool may_work_in_zones() const { return !max_vertices_ && !sliver_rule_ && given_up_.empty() && !gaps_.any() && boundary_.may_work_in_zones(); }
    RunGuard::Verdict drain();
    void keep_last();
    void requeue_beside_holes();
    void enqueue(const std::vector<TetId>& tets);
    void enqueue(TetId t, Fault fault, double badness);
    void enqueue_all();
    void listen();
    void process(TetId t, InsertionReason reason);
    void split_flat(TetId t);
    void process_centre(TetId t, InsertionReason reason, const Vec3& centre, double radius);
    void split_sized_boundary();
    [[nodiscard]] VertexId refusing_ball(TetId t);
    [[nodiscard]] bool is_relieved(TetId t) const;
    void clear_around(VertexId v);
    void insert_off_centre(TetId t, const Vec3& centre, InsertionReason reason);
    [[nodiscard]] Fault classify_strictly(TetId t, double& squared_badness) const;
    [[nodiscard]] Fault classify_thin(TetId t, double squared_longest, double& squared_badness) const;
    [[nodiscard]] bool strict() const { return boundary_.rules.strict; }
    bool star_is_good(const Cavity& cavity, const Placement& where) const;
    bool star_has_small_sliver(const Cavity& cavity, const Placement& where, double radius);
    bool accepts(const Cavity& cavity, const Placement& where, double radius);
    [[nodiscard]] Fault sliver_fault(TetId t, double six_volumes, double squared_edge, double& squared_badness) const;
    [[nodiscard]] PickEvent describe(TetId t, InsertionReason reason, const Vec3& centre, double radius) const;  ///< a rejected point, but for e_v
    void report_milestones();
    [[nodiscard]] std::size_t more_urgent(InsertionReason reason) const;
    [[nodiscard]] VertexId responsible_vertex(TetId t, InsertionReason reason) const;
    [[nodiscard]] bool is_forced(TetId t, Fault fault) const;
    bool insert_in_cell(TetId t, const Vec3& centre, double radius, InsertionReason reason);

    ConformingMesh& mesh_;
    BoundaryRefiner& boundary_;
    RunGuard& guard_;
    Workers alone_;
    Workers& workers_;
    AcuteExemptions exemptions_;
    ThinGaps gaps_;
    std::optional<Savepoint> last_;       // of refine(), with fewer vertices than the user allows
    std::uint64_t left_at_last_ = 0;      // vertices that were left then, or that were there if the user allows any number
    bool keeps_last_ = false;
    std::shared_ptr<const SizeField> shared_sizes_;  // with views of zones
    const SizeField& sizes_;
    double max_radius_edge_;
    std::optional<std::uint64_t> max_vertices_;
    std::optional<SliverRule> sliver_rule_{};
    std::uint64_t sliver_budget_ = std::numeric_limits<std::uint64_t>::max();
    bool sliver_budget_spent_ = false;
    std::size_t frugal_from_ = std::numeric_limits<std::size_t>::max();
    std::vector<VertexId> relieved_;     // of grade_afresh(): acute vertices
    std::size_t original_vertices_ = 0;  // of the mesh that met its size first: slivers among them are the paper's original ones
    bool size_met_ = false;
    bool outside_rules_ = false;         // the point to be inserted is no pick of the paper's
    double rounding_ = 0;  // input units: a tetrahedron this thin is flat
    double sliver_cosine_ = 2;
    double squared_size_slack_ = 1;
    unsigned candidates_ = 1;
    bool judging_ = false;
    bool reached_hole_ = false;  // the tetrahedron at hand can't be split before the boundary is whole again
    std::vector<BadTetQueue::Entry> beside_holes_;  // such ones
    std::uint32_t splitting_ = 0;                 // the tetrahedron at hand, by its fingerprint
    std::unordered_set<std::uint32_t> given_up_;  // what set off a cascade
    BadTetQueue by_size_, by_radius_edge_, by_sliver_;
    BadTetQueue left_by_size_, left_by_radius_edge_;  // of a view: left the zone
    RefineStatistics statistics_;
    Cavity cavity_;
    std::vector<Subsegment> encroached_segments_;
    std::vector<Subface> encroached_faces_;
};

}  // namespace wellmesh
