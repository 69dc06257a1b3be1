// SPDX-License-Identifier: Apache-2.0
// Splits where the input is acute: at copies of the encroaching vertex, and on the spheres of the balls about acute vertices
// (docs/algorithm/acute.md has the rules, the lemmas and why they end).
#include <algorithm>
#include <cmath>

#include "conforming/boundary_refiner.hpp"
#include "conforming/place_point.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh {
namespace {

/// A copy nearer than this part of the subsegment to one of its ends would make a short piece: the middle does then.
constexpr double kNearestToEnd = 0.2;
/// Part of the room that a foot has before what it is the foot of encroaches one of the pieces.
constexpr double kShift = 0.2;
/// The centre nearer to the axis of a copy than this part of the radius.
constexpr double kShortLever = 0.1;
/// An encroaching vertex's projection is a better place than the circumcentre if it keeps this part of the radius from the corners.
constexpr double kProjectionClearance = 0.3;
constexpr double kProjectionDepth = 0.95;  // of the radius: what encroaches by rounding only may project to anywhere on the rim
/// Splits for conformity need but little jitter; each bit of it costs vertices on symmetric input.
constexpr double kConformityJitter = 0.005;

/// Vertices nearer to each other than this part of a triangle's shortest side would be one, but for rounding.
constexpr double kSameVertex = 1e-9;
/// Within this part of the radius of a Gabriel subface's sphere its facet goes on, up to subsegments that are encroached.
constexpr double kSurelyInside = 0.99;
/// Only subsegments longer than a few of a point's heights over them are told from others that face away.
constexpr double kOutlineReach = 0.1;

double shortest_side(const Vec3& a, const Vec3& b, const Vec3& c) { return std::sqrt(std::min({squared_distance(a, b), squared_distance(b, c), squared_distance(c, a)})); }

}  // namespace

CarriedWitness BoundaryRefiner::witness_of(VertexId v) const {
    const VertexInfo& i = mesh_.info(v);
    return {mesh_.point(v), i.carrier, i.carrier_id, i.generation};
}

/// The vertex nearest to the centre, if it is inside the sphere; else the fallback.
std::optional<CarriedWitness> BoundaryRefiner::nearest_witness(const Vec3& centre, double radius, TetId near, VertexId fallback) {
    if (in_exact_range(flush_to_exact_range(centre)) && mesh_.triangulation().find_conflict_cavity(flush_to_exact_range(centre), near, cavity_)) {
        const VertexId q = nearest_vertex(mesh_, cavity_);
        if (q.valid() && squared_distance(mesh_.point(q), centre) < radius * radius * (1 - 1e-12)) return witness_of(q);
    }
    if (!fallback.valid()) return std::nullopt;
    return witness_of(fallback);
}

/// A vertex no farther than this from p.
VertexId BoundaryRefiner::vertex_within(const Vec3& p, double reach, TetId near) {
    if (!mesh_.triangulation().in_box(p)) return {};
    const TetId t = mesh_.triangulation().locate(p, near);
    for (const VertexId v : mesh_.tets().corners(t))
        if (v != kInfiniteVertex && squared_distance(mesh_.point(v), p) <= reach * reach) return v;
    return {};
}

VertexId BoundaryRefiner::ball_around(const Cavity& cavity) {
    if (!acute_.any()) return {};
    const std::size_t inputs = mesh_.plc().vertices.size();
    for (const BoundaryFace& b : cavity.boundary)
        for (const VertexId v : mesh_.tets().face_corners(b.inside)) {
            if (v.index() >= inputs) continue;
            const double r = acute_.ball_radius(v);
            if (squared_distance(mesh_.point(v), cavity.point) < r * r * (1 - 1e-9)) return v;
        }
    return {};
}

bool BoundaryRefiner::makes_room(const Cavity& cavity, InsertionReason reason) {
    const bool for_size = reason == InsertionReason::size || reason == InsertionReason::boundary_by_size || reason == InsertionReason::lattice;
    for (VertexId v = ball_around(cavity); v.valid(); v = ball_around(cavity)) {
        if (!for_size || !halve_ball(v)) return false;
    }
    return true;
}

/// The corner that is an acute vertex on whose ball's sphere the other two lie.
VertexId BoundaryRefiner::fan_apex(const std::array<VertexId, 3>& corners) {
    for (std::size_t k = 0; k < 3; ++k) {
        const VertexId v = corners[k];
        const auto on_sphere = [&](VertexId w) {  // as the sphere is now
            return mesh_.info(w).ball == v && distance(mesh_.point(v), mesh_.point(w)) <= (1 + 1e-6) * acute_.ball_radius(v);
        };
        if (on_sphere(corners[(k + 1) % 3]) && on_sphere(corners[(k + 2) % 3])) return v;
    }
    return {};
}

Vec3 BoundaryRefiner::at_distance(SegmentId s, VertexId end, double d) const {
    const auto& ends = mesh_.plc().segments[s.index()].ends;
    const Vec3 &v = mesh_.point(end), &other = mesh_.point(ends[ends[0] == end ? 1 : 0]);
    return project_to_segment(mesh_.plc(), s, v + (d / distance(v, other)) * (other - v));
}

VertexId BoundaryRefiner::ball_holding(const Subsegment& s) {
    for (const VertexId end : mesh_.plc().segments[s.segment.index()].ends)
        if ((s.a == end || s.b == end) && distance(mesh_.point(s.a), mesh_.point(s.b)) <= acute_.ball_radius(end) * (1 + 1e-9)) return end;
    return {};
}

VertexId BoundaryRefiner::ball_holding(const Subface& s) {
    if (const VertexId apex = fan_apex(s.corners); apex.valid()) return apex;
    const Vec3 p = project_to_facet(mesh_.plc().facets[s.facet.index()], circumcentre(mesh_.point(s.corners[0]), mesh_.point(s.corners[1]), mesh_.point(s.corners[2])));
    const TetFace face = mesh_.find_subface(s);
    if (!face.valid() || !in_exact_range(p) || !mesh_.triangulation().find_conflict_cavity(p, face.tet(), cavity_)) return {};
    if (const VertexId v = ball_around(cavity_); v.valid()) return v;
    find_encroached(cavity_, Placement::on_facet(s.facet), encroached_segments_, encroached_faces_);
    for (const Subsegment& e : encroached_segments_)
        if (const VertexId v = ball_holding(e); v.valid()) return v;
    return {};
}

/// The foot of q on the subsegment: q encroaches neither piece. Feet alone would make rectangles, whose corners are on one circle, so they are
/// shifted by a part of what q allows.
Vec3 BoundaryRefiner::foot_on_segment(const Subsegment& s, const CarriedWitness& q, double unit) const {
    const Vec3 a = mesh_.point(s.a), b = mesh_.point(s.b);
    const double squared_length = squared_distance(a, b);
    const Vec3 foot = a + (dot(q.point - a, b - a) / squared_length) * (b - a);
    const double room = std::min(squared_distance(foot, q.point) / squared_length, kConformityJitter);
    return project_to_segment(mesh_.plc(), s.segment, foot + (kShift * room * (2 * unit - 1)) * (b - a));
}

/// Empty: inside a ball, where nothing is split for quality.
std::optional<BoundaryRefiner::AcutePlace> BoundaryRefiner::place_on_segment(const Subsegment& s, const SplitRequest& request) {
    const Vec3 a = mesh_.point(s.a), b = mesh_.point(s.b), middle = 0.5 * (a + b);
    const double length = distance(a, b);
    const auto& ends = mesh_.plc().segments[s.segment.index()].ends;
    if (!request.for_conformity())
        for (const VertexId end : ends)
            while ((s.a == end || s.b == end) && length <= acute_.ball_radius(end) * (1 + 1e-9)) {
                if (request.reason != InsertionReason::boundary_by_size || !halve_ball(end)) return std::nullopt;
            }

    std::optional<CarriedWitness> q = request.witness;
    if (!q && request.for_conformity()) q = nearest_witness(middle, length / 2, mesh_.triangulation().tet_of(s.a), request.parent);
    AcutePlace place;
    place.halves = true;
    const std::uint64_t key = mix64(seed_, mix64(std::min(s.a, s.b).value(), std::max(s.a, s.b).value()));
    place.point = project_to_segment(mesh_.plc(), s.segment, middle + (kConformityJitter / 2 * (2 * unit_double(mix64(key, 0)) - 1)) * (b - a));
    // Of segments only: what facets hold may still go elsewhere, and each new place on one of many spokes is copied to all.
    if (q && q->carrier == CarrierKind::segment) {
        const Vec3 foot = foot_on_segment(s, *q, unit_double(mix64(key, 1)));
        const double along = dot(foot - a, b - a) / (length * length);
        if (along >= kNearestToEnd && along <= 1 - kNearestToEnd) {
            place.point = foot;
            place.halves = false;
        }
    }
    if (q)
        if (const auto copy = acute_.copy_on_segment(s.segment, *q)) {
            const Vec3 p = at_distance(s.segment, copy->end, copy->distance);
            const double along = dot(p - a, b - a) / (length * length);
            const bool on_sphere = std::abs(copy->distance - acute_.ball_radius(copy->end)) <= 1e-9 * copy->distance;
            if (along > 0 && along < 1 && (on_sphere || (along >= kNearestToEnd && along <= 1 - kNearestToEnd))) {
                place.point = p;
                place.halves = false;
                place.info.copied = true;
            }
        }
    for (const VertexId end : ends) {
        const double r = acute_.ball_radius(end);
        if (!(r > 0) || !(squared_distance(place.point, mesh_.point(end)) < kSphereReach * kSphereReach * r * r)) continue;
        const Vec3 p = at_distance(s.segment, end, r);
        const double along = dot(p - a, b - a) / (length * length);
        if (!(along > 1e-6 && along < 1 - 1e-6)) continue;
        place.point = p;
        place.halves = false;
        place.info.ball = end;
    }
    return place;
}

BoundaryRefiner::SplitOutcome BoundaryRefiner::split_acute(const Subsegment& s, const AcutePlace& place, const SplitRequest& request) {
    const Vec3 a = mesh_.point(s.a), b = mesh_.point(s.b);
    const double radius = distance(a, b) / 2;
    Triangulation& tri = mesh_.triangulation();
    VertexInfo info = place.info;
    info.reason = request.reason;
    info.parent = request.parent;
    if (place.point == a || place.point == b || !tri.find_conflict_cavity(place.point, tri.tet_of(s.a), cavity_)) return give_up(s);
    if (refuses(request, radius)) return SplitOutcome::refused;
    if (!mesh_.may_insert(cavity_, Placement::on_segment(s))) return SplitOutcome::left_zone;
    const VertexId v = insert_on_segment(s, info);
    record(request, v, mesh_.point(v), mesh_.info(v).insertion_length, true, 0.5 * (a + b), radius, s.a, s.b);
    return SplitOutcome::inserted;
}

/// A point of the arc between the fan triangle's two corners on the sphere: towards the copy of q if that is between them, else in the middle.
Vec3 BoundaryRefiner::cut_arc(FacetId f, const std::array<VertexId, 3>& corners, VertexId apex, const std::optional<CarriedWitness>& q) {
    const std::size_t k = static_cast<std::size_t>(std::find(corners.begin(), corners.end(), apex) - corners.begin());
    const Vec3 &v = mesh_.point(apex), &a = mesh_.point(corners[(k + 1) % 3]), &b = mesh_.point(corners[(k + 2) % 3]);
    const double r = acute_.ball_radius(apex);
    const ValidFacet& facet = mesh_.plc().facets[f.index()];
    const Vec3 n = cross(a - v, b - v);
    if (q)
        if (const auto d = acute_.direction_on_facet(f, apex, *q, (1.0 / 3) * (v + a + b)))
            if (dot(cross(a - v, *d), n) > 1e-6 * squared_norm(n) / r && dot(cross(*d, b - v), n) > 1e-6 * squared_norm(n) / r) return project_to_facet(facet, v + r * *d);
    const std::uint64_t key = mix64(seed_, mix64(apex.value(), mix64(corners[(k + 1) % 3].value(), corners[(k + 2) % 3].value())));
    const Vec3 chord = a + (0.5 + kConformityJitter * (unit_double(key) - 0.5)) * (b - a) - v;
    return project_to_facet(facet, v + (r / norm(chord)) * chord);
}

/// Where to split a subface, or a triangle of the facet's own Delaunay triangulation that is no face of the mesh yet.
BoundaryRefiner::AcutePlace BoundaryRefiner::place_on_facet(FacetId f, const std::array<VertexId, 3>& corners, TetId near, const SplitRequest& request, bool copies) {
    const Vec3 &a = mesh_.point(corners[0]), &b = mesh_.point(corners[1]), &c = mesh_.point(corners[2]);
    const ValidFacet& facet = mesh_.plc().facets[f.index()];
    double radius = 0;
    const Vec3 centre = circumcentre(a, b, c, &radius);
    const auto q = nearest_witness(centre, radius, near, request.reason == InsertionReason::encroachment ? request.parent : VertexId{});
    AcutePlace place;
    const auto candidate = [&] { return CarriedWitness{place.point, CarrierKind::facet, f.value()}; };
    if (const VertexId apex = fan_apex(corners); apex.valid()) {
        place.point = cut_arc(f, corners, apex, q);
        place.info.ball = apex;
        place.witness = candidate();
        return place;
    }
    if (q && copies) {
        if (const auto copy = acute_.copy_on_facet(f, *q, centre, radius)) {
            place.point = copy->point;
            place.info.copied = true;
            place.info.generation = copy->generation;
            place.lever = copy->lever / radius;
            place.witness = *q;
            return place;
        }
        place.point = project_to_facet(facet, q->point);
        const double clear = kProjectionClearance * radius;
        const bool free = std::all_of(corners.begin(), corners.end(), [&](VertexId v) { return squared_distance(mesh_.point(v), place.point) >= clear * clear; });
        place.witness = candidate();
        if (free && squared_distance(place.point, centre) < kProjectionDepth * kProjectionDepth * radius * radius) return place;
    }
    std::array<VertexId, 3> sorted = corners;
    std::sort(sorted.begin(), sorted.end());
    const Vec3 unit = picking_point(2, mix64(seed_, mix64(sorted[0].value(), mix64(sorted[1].value(), sorted[2].value()))), 1);
    place.point = project_to_facet(facet, centre + (kConformityJitter * radius * unit.x) * facet.axis_u + (kConformityJitter * radius * unit.y) * facet.axis_v);
    place.witness = candidate();
    return place;
}

/// A subsegment of the facet that cavity_.point lies on or beyond, within the rounding of the facet; `inside` tells its inner side.
Subsegment BoundaryRefiner::touched_outline(FacetId f, const Vec3& inside) const {
    const ValidFacet& facet = mesh_.plc().facets[f.index()];
    const TetStore& tets = mesh_.tets();
    for (const TetId t : cavity_.tets) {
        if (!mesh_.has_labels(t)) continue;
        for (unsigned e = 0; e < 6; ++e) {
            const SegmentId s = mesh_.labels(t).segments[e];
            if (!s.valid() || !std::binary_search(facet.segments.begin(), facet.segments.end(), s)) continue;
            const VertexId a = tets.corner(t, kEdgeCorners[e][0]), b = tets.corner(t, kEdgeCorners[e][1]);
            const Vec3 along = mesh_.point(b) - mesh_.point(a), across = cross(facet.normal, along), off = cavity_.point - mesh_.point(a);
            const double foot = dot(off, along) / squared_norm(along);
            if (!(foot > 0 && foot < 1)) continue;
            const double length = norm(across), height = dot(off, across) / length, inner = dot(inside - mesh_.point(a), across);
            // Sixteen roundings: of the ends, of the point and of its projection.
            if ((inner > 0 ? height : -height) < 16 * facet.tolerance && std::abs(height) < kOutlineReach * length) return {a, b, s};
        }
    }
    return {};
}

/// The subsegment of the facet that the way from p, inside, to q crosses first; an invalid one if q is inside, too. Rounding and facets that are
/// not recovered yet put points where they do not belong.
Subsegment BoundaryRefiner::first_crossed(FacetId f, const Vec3& p, const Vec3& q) {
    const ValidFacet& facet = mesh_.plc().facets[f.index()];
    const auto flat = [&](const Vec3& x) { return facet_coordinates(facet, x); };
    const auto turn = [](const auto& a, const auto& b, const auto& c) { return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]); };
    const auto from = flat(p), to = flat(q);
    double first = 1;
    SegmentId crossed{};
    for (const SegmentId s : facet.segments) {
        const auto& ends = mesh_.plc().segments[s.index()].ends;
        const auto a = flat(mesh_.point(ends[0])), b = flat(mesh_.point(ends[1]));
        const double left = turn(from, to, a), right = turn(from, to, b), start = turn(a, b, from), stop = turn(a, b, to);
        if ((left > 0) == (right > 0) || (start > 0) == (stop > 0)) continue;
        const double at = start / (start - stop);
        if (at > first || (at == first && crossed.valid())) continue;
        first = at;
        crossed = s;
    }
    if (!crossed.valid()) return {};
    const auto& ends = mesh_.plc().segments[crossed.index()].ends;
    const Vec3 &a = mesh_.point(ends[0]), &b = mesh_.point(ends[1]), at = p + first * (q - p);
    const auto along = [&](const Vec3& x) { return dot(x - a, b - a); };
    Subsegment piece{ends[0], ends[1], crossed};
    double low = 0, high = along(b);
    const double here = along(at);
    for (const VertexId v : mesh_.steiner_vertices_of(crossed)) {
        const double x = along(mesh_.point(v));
        if (x <= here && x > low) {
            low = x;
            piece.a = v;
        } else if (x > here && x < high) {
            high = x;
            piece.b = v;
        }
    }
    return piece;
}

/// Splits a subface (known: labelled) or a triangle that is no face of the mesh yet; or the subsegments that its point would encroach.
BoundaryRefiner::SplitOutcome BoundaryRefiner::split_acute(FacetId f, const std::array<VertexId, 3>& corners, bool labelled, TetId near, const SplitRequest& request, bool copies) {
    AcutePlace place = place_on_facet(f, corners, near, request, copies);
    const ValidFacet& facet = mesh_.plc().facets[f.index()];
    const Placement where = Placement::on_facet(f);
    Triangulation& tri = mesh_.triangulation();
    const Vec3 a = mesh_.point(corners[0]), b = mesh_.point(corners[1]), c = mesh_.point(corners[2]);
    const Vec3 middle = project_to_facet(facet, (1.0 / 3) * (a + b + c));
    const auto found = [&](const Vec3& p) { return tri.in_box(p) && tri.find_conflict_cavity(p, near, cavity_); };
    const auto retreat = [&] {  // the middle of the triangle is never outside, nor a vertex
        place = {};
        place.witness = {middle, CarrierKind::facet, f.value()};
        return found(middle);
    };
    // A copy, or a point of a ball's sphere, within rounding of a vertex would be that vertex once more.
    const auto is_new = [&](const Vec3& p) { return found(p) && distance_to_nearest(mesh_, cavity_) >= kSameVertex * shortest_side(a, b, c); };
    // Another split of the same round has put it there: the facet's triangulation is another one now.
    const auto is_done = [&](const Vec3& p) {
        const VertexId w = labelled ? VertexId{} : vertex_within(p, kSameVertex * shortest_side(a, b, c), near);
        return w.valid() && std::find(corners.begin(), corners.end(), w) == corners.end() && mesh_.is_on_facet(w, f);
    };
    const auto on_sphere = [&](VertexId v, const Vec3& p) {
        const Vec3 out = p - mesh_.point(v);
        return project_to_facet(facet, mesh_.point(v) + (acute_.ball_radius(v) / norm(out)) * out);
    };
    if (!is_new(place.point)) {
        if (is_done(place.point)) return SplitOutcome::gone;
        const VertexId apex = place.info.ball;
        if (!(apex.valid() && is_new(cut_arc(f, corners, apex, std::nullopt))) && !retreat()) return SplitOutcome::gone;
    }
    if (const VertexId v = ball_around(cavity_); v.valid() && !place.info.ball.valid()) {
        const Vec3 p = on_sphere(v, cavity_.point);
        const bool is_free = is_new(p);
        if (!is_free && is_done(p)) return SplitOutcome::gone;
        if (is_free || is_new(on_sphere(v, middle))) place.info.ball = v;
        else if (!retreat()) return SplitOutcome::gone;
    }
    find_encroached(cavity_, where, encroached_segments_, encroached_faces_);
    if (encroached_segments_.empty()) {
        Subsegment piece = touched_outline(f, middle);
        const bool at_rim = [&] {
            double radius = 0;
            const Vec3 centre = circumcentre(a, b, c, &radius);
            return !(squared_distance(cavity_.point, centre) < kSurelyInside * kSurelyInside * radius * radius);
        }();
        if (!piece.segment.valid() && (!labelled || at_rim)) {
            tri.leave_zone();
            if (tri.is_view()) return SplitOutcome::left_zone;  // it does not know all of the segment's vertices
            piece = first_crossed(f, middle, cavity_.point);
        }
        if (piece.segment.valid()) encroached_segments_.push_back(piece);
    }
    if (!encroached_segments_.empty()) {
        const std::vector<Subsegment> targets = encroached_segments_;
        SplitRequest passed = request;
        passed.witness = place.witness;
        // No place there for the copy: halves would chase it beside a corner. Near the axis the copy is as far from the centre as the corners are, and the
        // centre, which splits the axis, serves all facets about it.
        const auto is_halved = [&](const Subsegment& target) {
            const auto at = place_on_segment(target, passed);
            return at && at->halves;
        };
        if (place.lever < kShortLever && std::all_of(targets.begin(), targets.end(), is_halved)) return split_acute(f, corners, labelled, near, request, false);
        for (const Subsegment& target : targets)
            if (mesh_.find_subsegment(target).valid()) split(target, passed);
        return SplitOutcome::deferred;
    }
    if (labelled && !mesh_.holds_carrier(cavity_, where) && !retreat()) return SplitOutcome::gone;
    if (!mesh_.may_insert(cavity_, where)) return SplitOutcome::left_zone;
    VertexInfo info = place.info;
    info.reason = request.reason;
    info.parent = request.parent;
    const VertexId v = mesh_.insert(cavity_, where, info);
    inserted(v);
    record(request, v, mesh_.point(v), mesh_.info(v).insertion_length, true, middle, 0, corners[0], corners[1], corners[2]);
    return SplitOutcome::inserted;
}

}  // namespace wellmesh
