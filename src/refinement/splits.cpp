// SPDX-License-Identifier: Apache-2.0
// How a tetrahedron is split: by a point near its circumcentre, or by one of the boundary that this encroaches.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "conforming/place_point.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "quality/tet_shape.hpp"
#include "refinement/circumsphere.hpp"
#include "refinement/refine.hpp"

namespace wellmesh {
namespace {

/// Candidates matter only where the tetrahedra that they make may stay: within this factor of the size bound.
constexpr double kJudgeWithin = 1.5;

}  // namespace

std::size_t Refiner::more_urgent(InsertionReason reason) const {
    const std::size_t boundary = boundary_.waiting();
    if (reason == InsertionReason::size) return boundary;
    return boundary + by_size_.size() + (reason == InsertionReason::sliver ? by_radius_edge_.size() : 0);
}

PickEvent Refiner::describe(TetId t, InsertionReason reason, const Vec3& centre, double radius) const {
    PickEvent e;
    e.reason = reason;
    e.element = {4, mesh_.tets().corners(t), centre, radius};
    e.point = centre;
    e.parent = responsible_vertex(t, reason);
    e.more_urgent = more_urgent(reason);
    e.outside_rules = outside_rules_;
    return e;
}

/// The vertex that Lemma 5.1 holds responsible: the younger end of the shortest edge, or for created slivers the youngest vertex [LiTeng01].
VertexId Refiner::responsible_vertex(TetId t, InsertionReason reason) const {
    const auto& c = mesh_.tets().corners(t);
    const VertexId youngest = *std::max_element(c.begin(), c.end());
    if (reason == InsertionReason::sliver && youngest.index() >= original_vertices_) return youngest;
    double shortest = 1e300;
    VertexId younger{};
    for (const auto& e : kEdgeCorners) {
        const double d = squared_distance(mesh_.point(c[e[0]]), mesh_.point(c[e[1]]));
        if (d < shortest) {
            shortest = d;
            younger = std::max(c[e[0]], c[e[1]]);
        }
    }
    return younger;
}

bool Refiner::insert_in_cell(TetId t, const Vec3& centre, double radius, InsertionReason reason) {
    const CellId cell = mesh_.cell(t);
    const Placement where = Placement::in_cell(cell);
    Triangulation& tri = mesh_.triangulation();
    const VertexId parent = responsible_vertex(t, reason);
    ++statistics_.candidates;
    const bool centre_first = !sliver_rule_ || sliver_rule_->centre_first;
    bool sliver_free = !judging_ || (centre_first && accepts(cavity_, where, radius));
    if (!sliver_free) {
        const auto& c = mesh_.tets().corners(t);
        const std::uint64_t key = mix64(boundary_.seed(), mix64(mix64(c[0].value(), c[1].value()), mix64(c[2].value(), c[3].value())));
        PickingPoints points(3, key);
        for (unsigned k = 1; k < candidates_ && !sliver_free; ++k) {
            const Vec3 p = flush_to_exact_range(centre + boundary_.rules.region(radius) * points.next());
            ++statistics_.candidates;
            if (!tri.find_conflict_cavity(p, t, cavity_) || mesh_.cell(cavity_.tets[0]) != cell) continue;
            if (!accepts(cavity_, where, radius) || boundary_.ball_around(cavity_).valid()) continue;
            boundary_.find_encroached(cavity_, where, encroached_segments_, encroached_faces_);
            sliver_free = encroached_segments_.empty() && encroached_faces_.empty();
        }
        if (!sliver_free) {
            ++statistics_.fallbacks;
            if (!tri.find_conflict_cavity(centre, t, cavity_)) return false;
        }
    }
    if (!boundary_.makes_room(cavity_, reason)) return false;
    if (reason != InsertionReason::size) {
        const double allowed = boundary_.shortest_allowed(boundary_.reference_edge);
        // The sphere is empty, so the first comparison settles nearly all.
        if ((1 - boundary_.rules.delta) * radius < allowed && distance_to_nearest(mesh_, cavity_) < allowed) {
            ++statistics_.guarded;
            return false;
        }
    }
    if (!mesh_.may_insert(cavity_, where)) return false;
    PickEvent event;
    if (boundary_.recorder) event = describe(t, reason, centre, radius);
    const VertexId v = mesh_.insert(cavity_, where, {.reason = reason, .parent = parent});
    ++statistics_.insertions;
    if (boundary_.recorder) {
        event.vertex = v;
        event.point = mesh_.point(v);
        event.nearest = mesh_.info(v).insertion_length;
        event.sliver_free = sliver_free;
        boundary_.recorder->on_pick(event);
    }
    boundary_.enqueue_encroached(tri.new_tets());
    enqueue(tri.new_tets());
    return true;
}

void Refiner::split_flat(TetId t) {
    SplitRequest request{InsertionReason::boundary_by_radius_edge, responsible_vertex(t, InsertionReason::radius_edge)};
    request.outside_rules = true;
    if (mesh_.has_labels(t))
        for (unsigned f = 0; f < 4; ++f) {
            const FacetId facet = mesh_.labels(t).facets[f];
            if (facet.valid() && boundary_.split(Subface{mesh_.tets().face_corners(TetFace{t, f}), facet}, request) != BoundaryRefiner::SplitOutcome::gone) return;
        }
    const auto& c = mesh_.tets().corners(t);
    double longest = 0;
    unsigned edge = 0;
    for (unsigned e = 0; e < 6; ++e) {
        const double d = squared_distance(mesh_.point(c[kEdgeCorners[e][0]]), mesh_.point(c[kEdgeCorners[e][1]]));
        if (d > longest) {
            longest = d;
            edge = e;
        }
    }
    const SegmentId s = mesh_.segment_at(t, edge);
    const VertexId a = c[kEdgeCorners[edge][0]], b = c[kEdgeCorners[edge][1]];
    if (s.valid()) {
        boundary_.split(Subsegment{a, b, s}, request);
        return;
    }
    const Vec3 p = flush_to_exact_range(mesh_.point(a) + 0.51 * (mesh_.point(b) - mesh_.point(a)));
    if (!mesh_.triangulation().find_conflict_cavity(p, t, cavity_) || mesh_.cell(cavity_.tets[0]) != mesh_.cell(t)) return;
    boundary_.find_encroached(cavity_, Placement::in_cell(mesh_.cell(t)), encroached_segments_, encroached_faces_);
    if (!encroached_segments_.empty()) {
        boundary_.split(Subsegment{encroached_segments_[0]}, request);
    } else if (!encroached_faces_.empty()) {
        boundary_.split(Subface{encroached_faces_[0]}, request);
    } else {
        const bool was_judging = std::exchange(judging_, false);
        outside_rules_ = true;
        insert_in_cell(t, p, std::sqrt(longest) / 2, InsertionReason::radius_edge);
        outside_rules_ = false;
        judging_ = was_judging;
    }
}

void Refiner::process(TetId t, InsertionReason reason) {
    const auto corners = mesh_.tets().corners(t);
    const Vec3 &a = mesh_.point(corners[0]), &b = mesh_.point(corners[1]), &c = mesh_.point(corners[2]), &d = mesh_.point(corners[3]);
    if (strict()) {
        judging_ = true;
        const Circumsphere sphere = careful_circumsphere(a, b, c, d);
        process_centre(t, reason, flush_to_exact_range(sphere.centre), sphere.radius);
        return;
    }
    double radius = 0;
    Vec3 centre = flush_to_exact_range(circumcentre(a, b, c, d, &radius));
    if (is_thin(a, b, c, d)) {
        const Circumsphere sphere = exact_circumsphere(a, b, c, d);
        centre = flush_to_exact_range(sphere.centre);
        radius = sphere.radius;
    }
    judging_ = sliver_rule_ || sliver_cosine_ < 1;
    if (!sliver_rule_ && judging_ && reason == InsertionReason::size) {
        const TetSize size = sizes_.of(a, b, c, d, mesh_.cell(t));
        const double bound = std::min(std::sqrt(size.max_squared_circumradius), kCircumradiusPerRootOfVolume * std::cbrt(size.max_volume));
        judging_ = radius < kJudgeWithin * bound;
    }
    process_centre(t, reason, centre, radius);
}

/// Where the boundary may not be split, as in the balls about acute vertices: a point on the way from the circumcentre to the shortest edge that encroaches
/// nothing and makes no edge shorter than that one.
void Refiner::insert_off_centre(TetId t, const Vec3& centre, InsertionReason reason) {
    const auto& k = mesh_.tets().corners(t);
    double shortest = std::numeric_limits<double>::infinity();
    Vec3 middle{};
    for (const auto& e : kEdgeCorners) {
        const Vec3 &a = mesh_.point(k[e[0]]), &b = mesh_.point(k[e[1]]);
        if (squared_distance(a, b) >= shortest) continue;
        shortest = squared_distance(a, b);
        middle = 0.5 * (a + b);
    }
    shortest = std::sqrt(shortest);
    const Placement where = Placement::in_cell(mesh_.cell(t));
    for (const double way : {0.15, 0.3, 0.45, 0.6}) {
        const Vec3 p = flush_to_exact_range(centre + way * (middle - centre));
        if (!mesh_.triangulation().find_conflict_cavity(p, t, cavity_) || mesh_.cell(cavity_.tets[0]) != mesh_.cell(t)) continue;
        if (distance_to_nearest(mesh_, cavity_) < shortest) return;
        boundary_.find_encroached(cavity_, where, encroached_segments_, encroached_faces_);
        if (!encroached_segments_.empty() || !encroached_faces_.empty()) continue;
        const bool was_judging = std::exchange(judging_, false);
        const bool inserted = insert_in_cell(t, p, distance(p, middle), reason);
        judging_ = was_judging;
        if (inserted) return;
    }
}

/// Inserts a point of the picking region, or splits what the centre encroaches.
void Refiner::process_centre(TetId t, InsertionReason reason, const Vec3& centre, double radius) {
    const Placement where = Placement::in_cell(mesh_.cell(t));
    if (!mesh_.triangulation().find_conflict_cavity(centre, t, cavity_)) return;
    reached_hole_ = mesh_.reaches_hole(cavity_);
    if (reached_hole_) return;
    boundary_.find_encroached(cavity_, where, encroached_segments_, encroached_faces_);
    if (!encroached_segments_.empty() || !encroached_faces_.empty()) {
        const InsertionReason why = reason == InsertionReason::size     ? InsertionReason::boundary_by_size
                                    : reason == InsertionReason::sliver ? InsertionReason::boundary_by_sliver
                                                                        : InsertionReason::boundary_by_radius_edge;
        SplitRequest request{why, responsible_vertex(t, reason)};
        if (boundary_.recorder) {
            PickEvent event = describe(t, reason, centre, radius);
            event.nearest = distance_to_nearest(mesh_, cavity_);
            request.rejected = boundary_.recorder->on_pick(event);
        }
        BoundaryRefiner::SplitOutcome outcome{};
        if (!encroached_segments_.empty()) {
            outcome = boundary_.split(Subsegment{longest_of(mesh_, encroached_segments_)}, request);
        } else {
            const Subface chosen = holder_of_projection(mesh_, encroached_faces_, centre, request.projection_depth);
            outcome = boundary_.split(chosen, request);
        }
        if (outcome == BoundaryRefiner::SplitOutcome::refused && boundary_.acute().any() && reason != InsertionReason::sliver) insert_off_centre(t, centre, reason);
    } else if (mesh_.cell(cavity_.tets[0]) == mesh_.cell(t)) {
        insert_in_cell(t, centre, radius, reason);
    }
}

}  // namespace wellmesh
