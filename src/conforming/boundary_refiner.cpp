// SPDX-License-Identifier: Apache-2.0
#include "conforming/boundary_refiner.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "conforming/place_point.hpp"
#include "core/check.hpp"
#include "core/edge_key.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh {
namespace {

/// Pieces of a segment never get shorter than this part of it unless splits chase each other about an acute angle.
constexpr double kShortestPiece = 1e-9;
/// Of candidates for a point: none has been looked at.
constexpr unsigned kNoneYet = std::numeric_limits<unsigned>::max();

}  // namespace

// ------------------------------------------------------------------------------------------------ queues

/// Calls on_edge(edge, encroacher) and on_face(face, encroacher) for the labelled edges and faces of t that t's own corners encroach.
template <class OnEdge, class OnFace>
void BoundaryRefiner::visit_encroached(TetId t, OnEdge&& on_edge, OnFace&& on_face) const {
    if (!mesh_.has_labels(t)) return;
    const TetLabels& l = mesh_.labels(t);
    const auto& c = mesh_.tets().corners(t);
    for (unsigned e = 0; e < 6; ++e) {
        if (!l.segments[e].valid()) continue;
        const Vec3 &a = mesh_.point(c[kEdgeCorners[e][0]]), &b = mesh_.point(c[kEdgeCorners[e][1]]);
        for (const unsigned k : {unsigned{kEdgeCorners[5 - e][0]}, unsigned{kEdgeCorners[5 - e][1]}})
            if (c[k] != kInfiniteVertex && side_of_diametral_sphere(a, b, mesh_.point(c[k])) == Sign::positive) {
                on_edge(e, c[k]);
                break;
            }
    }
    for (unsigned f = 0; f < 4; ++f) {
        if (!l.facets[f].valid() || c[f] == kInfiniteVertex) continue;
        const auto fc = mesh_.tets().face_corners(TetFace{t, f});
        if (side_of_equatorial_sphere(mesh_.point(fc[0]), mesh_.point(fc[1]), mesh_.point(fc[2]), mesh_.point(c[f])) == Sign::positive) on_face(f, c[f]);
    }
}

template <class Segments, class Faces>
void BoundaryRefiner::list_encroached(TetId t, Segments& segments, Faces& faces) const {
    visit_encroached(
        t,
        [&](unsigned e, VertexId by) {
            const auto& c = mesh_.tets().corners(t);
            segments.push_back({{c[kEdgeCorners[e][0]], c[kEdgeCorners[e][1]], mesh_.labels(t).segments[e]}, by});
        },
        [&](unsigned f, VertexId by) { faces.push_back({{mesh_.tets().face_corners(TetFace{t, f}), mesh_.labels(t).facets[f]}, by}); });
}

void BoundaryRefiner::enqueue_encroached(const std::vector<TetId>& tets) {
    for (const TetId t : tets) list_encroached(t, segments_, faces_);
}

bool BoundaryRefiner::has_encroached(TetId t) const {
    bool found = false;
    visit_encroached(t, [&](unsigned, VertexId) { found = true; }, [&](unsigned, VertexId) { found = true; });
    return found;
}

/// @return false, with some of them waiting, if labels and cells contradict each other
bool BoundaryRefiner::enqueue_all_encroached(Workers& workers) {
    constexpr std::size_t kGrain = std::size_t{1} << 14;
    struct Found {
        std::vector<WaitingSegment> segments;
        std::vector<WaitingFace> faces;
        bool agree = true;
    };
    const std::size_t slots = mesh_.tets().slots();
    std::vector<Found> found((slots + kGrain - 1) / kGrain);
    workers.for_ranges(slots, kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        Found& here = found[piece];
        for (std::size_t i = begin; i < end; ++i) {
            const TetId t{i};
            if (!mesh_.has_labels(t) || !mesh_.tets().is_live(t)) continue;
            here.agree = here.agree && is_on_its_side(mesh_, t);
            list_encroached(t, here.segments, here.faces);
        }
    });
    bool agree = true;
    for (const Found& f : found) {
        segments_.insert(segments_.end(), f.segments.begin(), f.segments.end());
        faces_.insert(faces_.end(), f.faces.begin(), f.faces.end());
        agree = agree && f.agree;
    }
    return agree;
}

void BoundaryRefiner::find_encroached(const Cavity& cavity, const Placement& where, std::vector<Subsegment>& segments, std::vector<Subface>& faces) const {
    DistinctEdges<Subsegment> distinct(segments);
    faces.clear();
    const TetStore& store = mesh_.tets();
    const Vec3& p = cavity.point;
    const auto on_carrier = [&](FacetId f) {
        if (where.carrier == CarrierKind::facet) return f.value() == where.carrier_id;
        if (where.carrier != CarrierKind::segment) return false;
        const auto& facets = mesh_.plc().segments[where.carrier_id].facets;
        return std::find(facets.begin(), facets.end(), f) != facets.end();
    };
    for (const TetId t : cavity.tets) {
        if (!mesh_.has_labels(t)) continue;
        const TetLabels& l = mesh_.labels(t);
        const auto& c = store.corners(t);
        for (unsigned e = 0; e < 6; ++e) {
            if (!l.segments[e].valid()) continue;
            const VertexId a = std::min(c[kEdgeCorners[e][0]], c[kEdgeCorners[e][1]]), b = std::max(c[kEdgeCorners[e][0]], c[kEdgeCorners[e][1]]);
            if (where.carrier == CarrierKind::segment && l.segments[e].value() == where.carrier_id) continue;
            if (distinct.is_listed(edge_key(a, b))) continue;
            if (side_of_diametral_sphere(mesh_.point(a), mesh_.point(b), p) == Sign::positive) distinct.add({a, b, l.segments[e]});
        }
        for (unsigned f = 0; f < 4; ++f) {
            if (!l.facets[f].valid() || on_carrier(l.facets[f])) continue;
            const bool destroyed = mesh_.triangulation().in_last_cavity(store.across(t, f).tet());
            if (destroyed && t > store.across(t, f).tet()) continue;  // seen from the other side
            const auto fc = store.face_corners(TetFace{t, f});
            if (destroyed || side_of_equatorial_sphere(mesh_.point(fc[0]), mesh_.point(fc[1]), mesh_.point(fc[2]), p) == Sign::positive)
                faces.push_back({fc, l.facets[f]});
        }
    }
    distinct.finish();
}

void BoundaryRefiner::inserted(VertexId v) {
    const InsertionReason reason = mesh_.info(v).reason;
    if (reason == InsertionReason::encroachment || reason == InsertionReason::recovery)
        shortest_for_conformity_ = std::min(shortest_for_conformity_, mesh_.info(v).insertion_length);
    enqueue_encroached(mesh_.triangulation().new_tets());
    if (on_insert) on_insert(v);
}

// ------------------------------------------------------------------------------------------------ splits

double distance_to_nearest(const ConformingMesh& mesh, const Cavity& cavity) {
    return distance(cavity.point, mesh.point(nearest_vertex(mesh, cavity)));
}

VertexId nearest_vertex(const ConformingMesh& mesh, const Cavity& cavity) {
    double shortest = std::numeric_limits<double>::infinity();
    VertexId nearest{};
    for (const BoundaryFace& b : cavity.boundary)
        for (const VertexId v : mesh.tets().face_corners(b.inside)) {
            if (v == kInfiniteVertex) continue;
            const double d = squared_distance(cavity.point, mesh.point(v));
            if (d > shortest || (d == shortest && v >= nearest)) continue;
            shortest = d;
            nearest = v;
        }
    return nearest;
}

const Subsegment& longest_of(const ConformingMesh& mesh, const std::vector<Subsegment>& segments) {
    return *std::max_element(segments.begin(), segments.end(), [&](const Subsegment& x, const Subsegment& y) {
        return squared_distance(mesh.point(x.a), mesh.point(x.b)) < squared_distance(mesh.point(y.a), mesh.point(y.b));
    });
}

const Subface& holder_of_projection(const ConformingMesh& mesh, const std::vector<Subface>& faces, const Vec3& p, double& depth) {
    const auto depth_in = [&](const Subface& s) {
        const Vec3 &a = mesh.point(s.corners[0]), &b = mesh.point(s.corners[1]), &c = mesh.point(s.corners[2]);
        const Vec3 n = cross(b - a, c - a);
        const double area = squared_norm(n);
        return std::min({dot(cross(b - p, c - p), n), dot(cross(c - p, a - p), n), dot(cross(a - p, b - p), n)}) / area;
    };
    const Subface& chosen = *std::max_element(faces.begin(), faces.end(), [&](const Subface& x, const Subface& y) { return depth_in(x) < depth_in(y); });
    depth = depth_in(chosen);
    return chosen;
}

/// @pre cavity_ is that of the point to be inserted, from the picking region of an element of this circumradius.
bool BoundaryRefiner::refuses(const SplitRequest& request, double radius) {
    const bool for_quality = request.reason == InsertionReason::boundary_by_radius_edge || request.reason == InsertionReason::boundary_by_sliver;
    // Spheres of what is split for quality are empty, so the first comparison settles nearly all.
    const double allowed = shortest_allowed(reference_edge);
    if (!for_quality || (1 - rules.delta) * radius >= allowed || distance_to_nearest(mesh_, cavity_) >= allowed) return false;
    ++refused_;
    return true;
}

std::uint32_t BoundaryRefiner::record_event(const SplitRequest& request, VertexId v, const Vec3& point, double nearest, bool sliver_free, const PickedElement& element) {
    PickEvent e;
    e.reason = request.reason;
    e.element = element;
    e.point = point;
    e.vertex = v;
    e.rejected = request.rejected;
    if (request.rejected == PickEvent::kNone) e.parent = request.parent;
    e.nearest = nearest;
    e.sliver_free = sliver_free;
    e.projection_depth = request.projection_depth;
    e.outside_rules = request.outside_rules;
    return recorder->on_pick(e);
}

double BoundaryRefiner::segment_length(SegmentId s) const {
    const auto& ends = mesh_.plc().segments[s.index()].ends;
    return distance(mesh_.point(ends[0]), mesh_.point(ends[1]));
}

BoundaryRefiner::SplitOutcome BoundaryRefiner::split(const Subsegment& s, const SplitRequest& request) {
    const SplitOutcome outcome = split_here(s, request);
    return mesh_.triangulation().left_zone() ? SplitOutcome::left_zone : outcome;
}

BoundaryRefiner::SplitOutcome BoundaryRefiner::split(const Subface& s, const SplitRequest& request) {
    const SplitOutcome outcome = split_here(s, request);
    return mesh_.triangulation().left_zone() ? SplitOutcome::left_zone : outcome;
}

/// In a view: labels of a subsegment are on the stars of its ends.
bool BoundaryRefiner::has_both_stars(const Subsegment& s) {
    Triangulation& tri = mesh_.triangulation();
    return !tri.is_view() || (tri.find_star(s.a, star_) && tri.find_star(s.b, star_));
}

/// Balls give way in order, which views know nothing of. @return false: not here
bool BoundaryRefiner::halve_ball(VertexId v) {
    mesh_.triangulation().leave_zone();
    if (mesh_.triangulation().is_view()) return false;
    acute_.halve_ball(v);
    return true;
}

BoundaryRefiner::SplitOutcome BoundaryRefiner::split_here(const Subsegment& s, const SplitRequest& request) {
    if (!has_both_stars(s)) return SplitOutcome::left_zone;
    const Vec3 a = mesh_.point(s.a), b = mesh_.point(s.b);
    const std::uint64_t key = mix64(seed_, mix64(std::min(s.a, s.b).value(), std::max(s.a, s.b).value()));
    const Placement where = Placement::on_segment(s);
    std::optional<AcutePlace> place;
    if (acute_.copies()) {
        place = place_on_segment(s, request);
        if (!place) return SplitOutcome::refused;
        if (request.for_conformity() || place->info.ball.valid()) return split_acute(s, *place, request);
    }
    const Vec3 middle = 0.5 * (a + b);
    const double radius = distance(a, b) / 2;
    Triangulation& tri = mesh_.triangulation();
    const double jitter = rules.jitter * (2 * unit_double(mix64(key, 0)) - 1);
    unsigned at_hand = kNoneYet;  // the candidate whose cavity was found last: judging it leaves that as it is
    const auto found = [&](unsigned k) {
        if (std::exchange(at_hand, k) == k) return true;
        const double at = k == 0 ? jitter : std::min(rules.delta, rules.reach / radius) * picking_point(1, key, k).x;
        const Vec3 p = project_to_segment(mesh_.plc(), s.segment, middle + (at / 2) * (b - a));
        if (p != a && p != b && !acute_.in_ball_of_segment(s.segment, p) && tri.find_conflict_cavity(p, tri.tet_of(s.a), cavity_)) return true;
        at_hand = kNoneYet;
        return false;
    };
    unsigned chosen = 0;
    bool sliver_free = !judge;
    if (judge)
        for (unsigned k = 0; k < std::max(candidates / 4, 1U) && !sliver_free; ++k)
            if (found(k) && judge(cavity_, where, radius)) {
                chosen = k;
                sliver_free = true;
            }
    if (distance(a, b) < kShortestPiece * segment_length(s.segment) || !found(chosen)) {
        // A ball that was halved for this may still hold the middle, but not the place of the copy.
        const bool is_in_ball = place && acute_.in_ball_of_segment(s.segment, middle + (jitter / 2) * (b - a));
        return is_in_ball && !acute_.in_ball_of_segment(s.segment, place->point) ? split_acute(s, *place, request) : give_up(s);
    }
    if (refuses(request, radius)) return SplitOutcome::refused;
    if (!mesh_.may_insert(cavity_, where)) return SplitOutcome::left_zone;
    const VertexId v = insert_on_segment(s, {.reason = request.reason, .parent = request.parent});
    record(request, v, mesh_.point(v), mesh_.info(v).insertion_length, sliver_free, middle, radius, s.a, s.b);
    return SplitOutcome::inserted;
}

BoundaryRefiner::SplitOutcome BoundaryRefiner::give_up(const Subsegment& s) {
    mesh_.triangulation().leave_zone();
    if (mesh_.triangulation().is_view()) return SplitOutcome::left_zone;
    const Vec3 &a = mesh_.point(s.a), &b = mesh_.point(s.b), middle = 0.5 * (a + b);
    throw MeshError(ErrorCode::budget_exhausted, guard_.stage(),
                    fmt::format("segment {} can't be split any further: its pieces have shrunk to {} near ({}, {}, {})", s.segment.value() + 1, distance(a, b), middle.x,
                                middle.y, middle.z),
                    {{EntityKind::segment, s.segment.value() + 1, middle}});
}

void BoundaryRefiner::give_up(const Subface& s) const {
    const Vec3 middle = (1.0 / 3) * (mesh_.point(s.corners[0]) + mesh_.point(s.corners[1]) + mesh_.point(s.corners[2]));
    const std::size_t facet = mesh_.plc().facets[s.facet.index()].source_facet + 1;
    throw MeshError(ErrorCode::budget_exhausted, guard_.stage(),
                    fmt::format("facet {} can't be split any further: its pieces have shrunk to the rounding of its plane near ({}, {}, {})", facet, middle.x, middle.y, middle.z),
                    {{EntityKind::facet, facet, middle}});
}

/// Inserts cavity_.point on the subsegment.
VertexId BoundaryRefiner::insert_on_segment(const Subsegment& s, const VertexInfo& info) {
    const VertexId v = mesh_.insert(cavity_, Placement::on_segment(s), info);
    for (const Subsegment& half : {Subsegment{s.a, v, s.segment}, Subsegment{v, s.b, s.segment}})
        if (!mesh_.find_subsegment(half).valid()) segments_.push_back({half, VertexId{}});
    inserted(v);
    return v;
}

BoundaryRefiner::SplitOutcome BoundaryRefiner::split_here(const Subface& s, const SplitRequest& request) {
    const TetFace face = mesh_.find_subface(s);
    if (!face.valid()) return SplitOutcome::gone;
    const Vec3 &a = mesh_.point(s.corners[0]), &b = mesh_.point(s.corners[1]), &c = mesh_.point(s.corners[2]);
    double radius = 0;
    const Vec3 centre = circumcentre(a, b, c, &radius);
    std::array<VertexId, 3> sorted = s.corners;
    std::sort(sorted.begin(), sorted.end());
    const std::uint64_t key = mix64(seed_, mix64(sorted[0].value(), mix64(sorted[1].value(), sorted[2].value())));
    const ValidFacet& facet = mesh_.plc().facets[s.facet.index()];
    const Placement where = Placement::on_facet(s.facet);
    Triangulation& tri = mesh_.triangulation();
    if (acute_.copies()) {
        if (request.for_conformity()) return split_acute(s.facet, s.corners, true, face.tet(), request);
        for (VertexId v = fan_apex(s.corners); v.valid(); v = fan_apex(s.corners)) {
            if (request.reason != InsertionReason::boundary_by_size) return SplitOutcome::refused;
            if (!halve_ball(v)) return SplitOutcome::left_zone;
        }
    }
    unsigned at_hand = kNoneYet;
    const auto found = [&](unsigned k) {
        if (std::exchange(at_hand, k) == k) return true;
        const Vec3 unit = picking_point(2, key, k == 0 ? 1 : k);
        const double r = k == 0 ? rules.jitter * radius : rules.region(radius);
        const Vec3 p = project_to_facet(facet, centre + (r * unit.x) * facet.axis_u + (r * unit.y) * facet.axis_v);
        if (tri.find_conflict_cavity(p, face.tet(), cavity_) && !(k > 0 && ball_around(cavity_).valid())) return true;
        at_hand = kNoneYet;
        return false;
    };
    // The centre decides whether a subsegment has to be split instead.
    if (!found(0)) return SplitOutcome::gone;
    find_encroached(cavity_, where, encroached_segments_, encroached_faces_);
    if (!encroached_segments_.empty()) {
        const std::vector<Subsegment> targets = encroached_segments_;
        SplitRequest passed = request;
        if (acute_.copies()) passed.witness = CarriedWitness{cavity_.point, CarrierKind::facet, s.facet.value()};
        passed.rejected = record(request, VertexId{}, cavity_.point, recorder ? distance_to_nearest(mesh_, cavity_) : 0, true, centre, radius, s.corners[0], s.corners[1],
                                 s.corners[2]);
        passed.projection_depth = 0;
        bool refused = false;
        for (const Subsegment& target : targets) {
            refused = mesh_.find_subsegment(target).valid() && split(target, passed) == SplitOutcome::refused;
            if (rules.strict || refused) break;
        }
        return refused ? SplitOutcome::refused : SplitOutcome::deferred;
    }
    unsigned chosen = 0;
    bool sliver_free = !judge || judge(cavity_, where, radius);
    for (unsigned k = 1; k < std::max(candidates / 2, 1U) && !sliver_free; ++k) {
        if (!found(k)) continue;
        find_encroached(cavity_, where, encroached_segments_, encroached_faces_);
        if (encroached_segments_.empty() && judge(cavity_, where, radius)) {
            chosen = k;
            sliver_free = true;
        }
    }
    if (!found(chosen)) return SplitOutcome::gone;
    if (!mesh_.holds_carrier(cavity_, where)) {
        // Rounding or a facet that is not Gabriel yet put the centre outside the facet: the middle of the triangle never is.
        const Vec3 p = project_to_facet(facet, a + (1.0 / 3) * ((b - a) + (c - a)));
        if (!tri.find_conflict_cavity(p, face.tet(), cavity_)) return SplitOutcome::gone;
    }
    if (refuses(request, radius) || !makes_room(cavity_, request.reason)) return SplitOutcome::refused;
    if (!mesh_.may_insert(cavity_, where)) return SplitOutcome::left_zone;
    const VertexId v = mesh_.insert(cavity_, where, {.reason = request.reason, .parent = request.parent});
    inserted(v);
    record(request, v, mesh_.point(v), mesh_.info(v).insertion_length, sliver_free, centre, radius, s.corners[0], s.corners[1], s.corners[2]);
    return SplitOutcome::inserted;
}

void BoundaryRefiner::poll_or_throw(SegmentId s) {
    guard_.require(mesh_.vertex_count(), mesh_.tets().live(), waiting(),
                   [&] { return ElementRef{EntityKind::segment, s.value() + 1U, mesh_.point(mesh_.plc().segments[s.index()].ends[0])}; });
}

void BoundaryRefiner::poll_or_throw(FacetId f) {
    guard_.require(mesh_.vertex_count(), mesh_.tets().live(), waiting(), [&] {
        const ValidFacet& facet = mesh_.plc().facets[f.index()];
        return ElementRef{EntityKind::facet, facet.source_facet + 1U, facet.origin};
    });
}

bool BoundaryRefiner::holes_may_wait() const {
    constexpr std::size_t kVerticesPerHole = 128;
    return lets_holes_wait && !cells_stale_ && mesh_.has_only_holes() && mesh_.broken_facets().size() * kVerticesPerHole < mesh_.steiner_vertices_ever(mesh_.broken_facets().back());
}

bool BoundaryRefiner::step() {
    if (!segments_.empty()) {
        const WaitingSegment w = segments_.front();
        segments_.pop_front();
        if (!w.encroacher.valid() && mesh_.triangulation().find_edge(w.s.a, w.s.b).valid()) {
            // A piece that was missing has appeared: label it, and see whether it is encroached.
            mesh_.label_edge(w.s.a, w.s.b, w.s.segment);
            std::vector<TetId> star;
            mesh_.triangulation().find_star(w.s.a, star);
            enqueue_encroached(star);
            return true;
        }
        if (w.encroacher.valid() && !mesh_.find_subsegment(w.s).valid()) return true;  // split in the meantime
        poll_or_throw(w.s.segment);
        split(w.s, {w.encroacher.valid() ? InsertionReason::encroachment : InsertionReason::recovery, w.encroacher});
        return true;
    }
    if (mesh_.has_broken() && (faces_.empty() || !holes_may_wait())) {
        repair_broken();
        return true;
    }
    if (cells_stale_) {
        refresh_cells();
        return true;
    }
    if (!faces_.empty()) {
        const WaitingFace w = faces_.front();
        faces_.pop_front();
        if (!mesh_.find_subface(w.s).valid()) return true;  // split in the meantime
        poll_or_throw(w.s.facet);
        const std::size_t before = mesh_.vertex_count();
        const SplitOutcome outcome = split(w.s, {InsertionReason::encroachment, w.encroacher});
        if (mesh_.vertex_count() != before) stalled_ = 0;
        else if (outcome == SplitOutcome::gone ? mesh_.find_subface(w.s).valid() : outcome == SplitOutcome::deferred && ++stalled_ > faces_.size()) give_up(w.s);
        if (outcome == SplitOutcome::deferred) faces_.push_back(w);
        return true;
    }
    return false;
}

void BoundaryRefiner::conform() {
    while (step()) {}
}

void BoundaryRefiner::drain_segments() {
    while (true) {
        while (!segments_.empty()) step();
        const std::vector<SegmentId> broken = mesh_.take_broken_segments();
        if (broken.empty()) return;
        for (const SegmentId s : broken) queue_chain(s);
    }
}

}  // namespace wellmesh
