// SPDX-License-Identifier: Apache-2.0
// Splits encroached subsegments, then encroached subfaces, until every segment is a chain of edges with empty diametral spheres and
// every facet a union of faces with empty equatorial spheres (the Gabriel property) [Shewchuk98].
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "conforming/acute_geometry.hpp"
#include "conforming/conforming_mesh.hpp"
#include "conforming/insertion_recorder.hpp"
#include "core/run_guard.hpp"
#include "core/workers.hpp"

namespace wellmesh {

/// Why something is split: for the vertex's record.
struct SplitRequest {
    InsertionReason reason = InsertionReason::encroachment;
    VertexId parent{};  ///< the encroaching vertex, or the one responsible for the tetrahedron whose centre encroaches
    std::uint32_t rejected = PickEvent::kNone;  ///< the recorder's number of that centre
    double projection_depth = 0;                ///< as in PickEvent
    bool outside_rules = false;                 ///< as in PickEvent
    /// The point, a vertex or a candidate, whose copy is to be inserted where the input is acute. Empty: found by its nearness.
    std::optional<CarriedWitness> witness{};
    [[nodiscard]] bool for_conformity() const { return reason == InsertionReason::encroachment || reason == InsertionReason::recovery; }
};

/// How points are picked. The defaults are the practical mode's (docs/decisions/0010).
struct PickingRules {
    /// Radius of a picking region relative to the circumradius (half the length of a subsegment) [LiTeng01, 2.3].
    double delta = 0.3;
    /// Splits avoid the exact centre by up to this part of the radius: on symmetric input midpoints make cospherical structures that are
    /// split for ever. 0 where the paper's inequalities prove the end and want circumcentres.
    double jitter = 0.05;
    /// The paper to the letter: one encroached subsegment at a time, since the first split may encroach the next, and slivers avoided by
    /// every split.
    bool strict = false;
    /// The region's radius is at most this, in input units.
    double reach = std::numeric_limits<double>::infinity();
    /// Radius of the picking region of an element with this circumradius.
    [[nodiscard]] double region(double radius) const { return std::min(delta * radius, reach); }
};

struct ZoneViews;

class BoundaryRefiner {
public:
    /// @param acute  where copies and balls are needed; it must know the mesh's own PLC.
    BoundaryRefiner(ConformingMesh& mesh, RunGuard& guard, std::uint64_t seed, AcuteGeometry& acute) : mesh_(mesh), guard_(guard), seed_(seed), acute_(acute) {}

    /// Called after every insertion, with the new vertex; the triangulation's new_tets() are still its star.
    std::function<void(VertexId)> on_insert{};
    /// Called after recovery has found cells anew, with the tetrahedra that may have changed theirs.
    std::function<void(const std::vector<TetId>&)> on_repair{};
    /// Accepts or rejects a candidate point of a picking region; the first accepted one is used, or the centre. Empty: the centre always.
    /// Given the radius of the element's own sphere. True: the star of this point holds no new small sliver.
    using Judge = std::function<bool(const Cavity&, const Placement&, double radius)>;
    Judge judge{};
    unsigned candidates = 1;
    PickingRules rules{};
    /// Told of every point that is picked or rejected; none: nobody keeps account.
    InsertionRecorder* recorder = nullptr;
    /// Length, in input units, that Theorem 4.2 compares with: splits for quality that would make an edge shorter than its bound are refused. 0: none are.
    double reference_edge = 0;

    /// Makes every segment a chain of edges and every facet a union of faces, then finds the cell of every tetrahedron.
    /// @throws MeshError{budget_exhausted, cancelled, unsupported_acute}
    void recover_all();
    /// The same after relabel(): recovers what is broken, then finds all cells. @return false, half way, if that takes more vertices than `most`
    [[nodiscard]] bool recover_broken(Workers& workers, std::size_t most = std::numeric_limits<std::size_t>::max());
    /// Splits until nothing is encroached; recovers what splits destroyed. @throws as recover_all does.
    void conform();
    /// Splits at most one subsegment or subface. @return false if none is waiting.
    bool step();
    /// Holes in facets of many vertices, which are recovered as a whole, wait until there are enough of them to be worth it. Cells around them are unknown.
    bool lets_holes_wait = false;
    /// Is there nothing to do but to mend holes that may wait?
    [[nodiscard]] bool only_holes_wait() const { return mesh_.has_broken() && segments_.empty() && faces_.empty() && holes_may_wait(); }
    [[nodiscard]] bool has_holes() const { return mesh_.has_broken() || cells_stale_; }
    [[nodiscard]] bool idle() const { return segments_.empty() && faces_.empty() && idle_but_for_queues(); }
    [[nodiscard]] std::size_t waiting() const { return segments_.size() + faces_.size(); }
    /// The mesh was put back to an earlier one that conformed: what waits is of the abandoned one.
    void forget_waiting() {
        segments_.clear();
        faces_.clear();
        cells_stale_ = false;
    }

    // --- zones, for several workers at once (delaunay/zones.hpp)
    /// For a view of a zone: takes over the rules, and of what waits what is all in the zone. Nothing judges candidates.
    BoundaryRefiner(ConformingMesh& view, BoundaryRefiner& whole, const ZoneViews& parts, std::uint8_t zone);
    /// May zones share in the work? Not where somebody keeps account of the order.
    [[nodiscard]] bool may_work_in_zones() const { return !recorder && !rules.strict && idle_but_for_queues(); }
    /// As conform(), but what leaves the zone goes on waiting, for join(), and so does all when it may not go on.
    void conform_in_zone(const std::function<bool(std::size_t)>& may_go_on);
    void join(const BoundaryRefiner& zone);

    /// In a view: are the stars of both ends in the zone? They have the labels of a subsegment that is split or healed.
    [[nodiscard]] bool has_both_stars(const Subsegment& s);

    /// Looks for encroached subsegments and subfaces among the new tetrahedra.
    void enqueue_encroached(const std::vector<TetId>& tets);
    /// Does a corner of t encroach a labelled edge or face of t?
    [[nodiscard]] bool has_encroached(TetId t) const;

    /// Subsegments and subfaces that cavity.point would encroach, except on its own carrier.
    void find_encroached(const Cavity& cavity, const Placement& where, std::vector<Subsegment>& segments, std::vector<Subface>& faces) const;

    /// In a view of a zone anything may also leave it: nothing has changed then, or a subsegment was split instead.
    enum class SplitOutcome { inserted, deferred, gone, refused, left_zone };
    SplitOutcome split(const Subsegment& s, const SplitRequest& request);
    /// Deferred: a subsegment had to be split instead.
    SplitOutcome split(const Subface& s, const SplitRequest& request);

    /// The acute input vertex in whose ball the cavity's point lies, invalid if in none: its Delaunay neighbour, since balls are empty.
    [[nodiscard]] VertexId ball_around(const Cavity& cavity);
    /// The acute vertex in whose ball this would be split for quality, hence is not; invalid if in none.
    [[nodiscard]] VertexId ball_holding(const Subsegment& s);
    [[nodiscard]] VertexId ball_holding(const Subface& s);
    /// May the cavity's point be inserted for this reason? Not in a ball, unless its size is asked for: then the ball shrinks.
    [[nodiscard]] bool makes_room(const Cavity& cavity, InsertionReason reason);
    [[nodiscard]] AcuteGeometry& acute() { return acute_; }

    [[nodiscard]] std::uint64_t seed() const { return seed_; }
    [[nodiscard]] std::uint64_t refused() const { return refused_; }
    /// Edges shorter than this are not made for quality: (1 - delta) / 4 of the reference [LiTeng01, Theorem 4.2]. The theorem does not know
    /// that vertices may encroach other parts of the boundary; the splits that this needs may be shorter, and lower the reference.
    [[nodiscard]] double shortest_allowed(double reference) const { return (1 - rules.delta) / 4 * std::min(reference, shortest_for_conformity_); }

private:
    struct WaitingSegment { Subsegment s; VertexId encroacher; };
    struct WaitingFace { Subface s; VertexId encroacher; };

    [[nodiscard]] bool holes_may_wait() const;
    [[nodiscard]] bool idle_but_for_queues() const { return !mesh_.has_broken() && !cells_stale_; }
    SplitOutcome split_here(const Subsegment& s, const SplitRequest& request);
    SplitOutcome split_here(const Subface& s, const SplitRequest& request);
    bool halve_ball(VertexId v);

    template <class OnEdge, class OnFace>
    void visit_encroached(TetId t, OnEdge&& on_edge, OnFace&& on_face) const;
    template <class Segments, class Faces>
    void list_encroached(TetId t, Segments& segments, Faces& faces) const;
    void recover_segments();
    [[nodiscard]] TetFace sole_triangle(FacetId f);
    bool recover_facet(FacetId f);
    bool recover_facets(std::vector<FacetId> todo, std::size_t most);
    void repair_broken();
    void refresh_cells();
    void find_all_cells();
    bool enqueue_all_encroached(Workers& workers);
    void drain_segments();
    void inserted(VertexId v);
    bool refuses(const SplitRequest& request, double radius);
    template <class... Corners>
    std::uint32_t record(const SplitRequest& request, VertexId v, const Vec3& point, double nearest, bool sliver_free, const Vec3& centre, double radius, Corners... corners) {
        if (!recorder) return PickEvent::kNone;
        return record_event(request, v, point, nearest, sliver_free, {sizeof...(Corners), {corners...}, centre, radius});
    }
    std::uint32_t record_event(const SplitRequest& request, VertexId v, const Vec3& point, double nearest, bool sliver_free, const PickedElement& element);
    void poll_or_throw(SegmentId s);
    void poll_or_throw(FacetId f);
    void queue_chain(SegmentId s);
    [[nodiscard]] double segment_length(SegmentId s) const;
    void try_insert_on_facet(FacetId f, const Vec3& wanted, TetId near, const SplitRequest& request);

    // where the input is acute (acute_splits.cpp)
    struct AcutePlace {
        Vec3 point{};
        VertexInfo info{};        // copied, generation, ball
        CarriedWitness witness{}; // for the subsegments that the point encroaches
        double lever = 1;         // of a copy about a shared segment: the centre's distance from that, in radii
        bool halves = false;      // the middle of a subsegment, for want of a better place
    };
    [[nodiscard]] CarriedWitness witness_of(VertexId v) const;
    [[nodiscard]] std::optional<CarriedWitness> nearest_witness(const Vec3& centre, double radius, TetId near, VertexId fallback);
    [[nodiscard]] std::optional<AcutePlace> place_on_segment(const Subsegment& s, const SplitRequest& request);
    [[nodiscard]] AcutePlace place_on_facet(FacetId f, const std::array<VertexId, 3>& corners, TetId near, const SplitRequest& request, bool copies);
    [[nodiscard]] VertexId vertex_within(const Vec3& p, double reach, TetId near);
    [[nodiscard]] VertexId fan_apex(const std::array<VertexId, 3>& corners);
    [[nodiscard]] Vec3 cut_arc(FacetId f, const std::array<VertexId, 3>& corners, VertexId apex, const std::optional<CarriedWitness>& q);
    [[nodiscard]] Vec3 at_distance(SegmentId s, VertexId end, double d) const;
    [[nodiscard]] Vec3 foot_on_segment(const Subsegment& s, const CarriedWitness& q, double unit) const;
    [[nodiscard]] Subsegment touched_outline(FacetId f, const Vec3& inside) const;
    [[nodiscard]] Subsegment first_crossed(FacetId f, const Vec3& p, const Vec3& q);
    VertexId insert_on_segment(const Subsegment& s, const VertexInfo& info);
    /// Throws; but a view leaves that to the whole.
    SplitOutcome give_up(const Subsegment& s);
    [[noreturn]] void give_up(const Subface& s) const;
    SplitOutcome split_acute(const Subsegment& s, const AcutePlace& place, const SplitRequest& request);
    /// Without copies the place is the circumcentre.
    SplitOutcome split_acute(FacetId f, const std::array<VertexId, 3>& corners, bool labelled, TetId near, const SplitRequest& request, bool copies = true);

    ConformingMesh& mesh_;
    RunGuard& guard_;
    std::uint64_t seed_;
    AcuteGeometry& acute_;
    std::deque<WaitingSegment> segments_;
    std::deque<WaitingFace> faces_;
    std::vector<WaitingSegment> left_segments_;  // of a view: left the zone
    std::vector<WaitingFace> left_faces_;
    std::vector<TetId> star_;
    Cavity cavity_;
    std::vector<Subsegment> encroached_segments_;
    std::vector<Subface> encroached_faces_;
    std::size_t stalled_ = 0;  // subfaces in a row that wait for others to be split first
    std::uint64_t refused_ = 0;
    double shortest_for_conformity_ = std::numeric_limits<double>::infinity();
    bool cells_stale_ = false;  // facets were recovered since cells were last found
};

/// Finds the cell of every tetrahedron by flooding from the labelled faces. @throws MeshError{internal_invariant} if the surface leaks.
void classify_cells(ConformingMesh& mesh);
/// The same for live tetrahedra whose cell is unknown, all others keeping theirs. @return false if what surrounds them does not tell, or contradicts
/// itself: then all must be found again.
[[nodiscard]] bool classify_again(ConformingMesh& mesh, const std::vector<TetId>& unknown);

/// Do all labelled faces of t have t's cell on its side, as far as they show it?
[[nodiscard]] bool is_on_its_side(const ConformingMesh& mesh, TetId t);

/// Distance from cavity.point to the nearest vertex, which is one of the cavity's: nearest neighbours are Delaunay neighbours.
[[nodiscard]] double distance_to_nearest(const ConformingMesh& mesh, const Cavity& cavity);
[[nodiscard]] VertexId nearest_vertex(const ConformingMesh& mesh, const Cavity& cavity);

/// Which of several encroached elements to split: the longest subsegment.
[[nodiscard]] const Subsegment& longest_of(const ConformingMesh& mesh, const std::vector<Subsegment>& segments);
/// The subface that holds the projection of p [LiTeng01, 2.3]; failing that, the nearest one.
/// @param depth  gets the least barycentric coordinate of the projection; below 0 it lies outside.
[[nodiscard]] const Subface& holder_of_projection(const ConformingMesh& mesh, const std::vector<Subface>& faces, const Vec3& p, double& depth);

/// A low-discrepancy sequence in the unit ball, disk (z = 0) or interval (y = z = 0), its own for each key. No trigonometry: the same on
/// every platform.
class PickingPoints {
public:
    PickingPoints(unsigned dimension, std::uint64_t key);
    [[nodiscard]] Vec3 next();

private:
    unsigned dimension_, index_ = 0;
    std::array<double, 3> start_;
};

/// Point k (1, 2, ...) of such a sequence; point 0 is the centre.
[[nodiscard]] Vec3 picking_point(unsigned dimension, std::uint64_t key, unsigned k);

}  // namespace wellmesh
