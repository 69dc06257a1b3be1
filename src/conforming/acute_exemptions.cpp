// SPDX-License-Identifier: Apache-2.0
#include "conforming/acute_exemptions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "conforming/place_point.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh {
namespace {

constexpr double kNoAngle = 180;
/// Edges between cells that meet at more than this are no shorter than refinement itself makes them: at 60 degrees the third side of a
/// triangle is as long as the other two.
constexpr double kForcedBelowDeg = 60;

double degrees_between(const Vec3& a, const Vec3& b) { return std::atan2(norm(cross(a, b)), dot(a, b)) * (180 / std::numbers::pi); }

}  // namespace

AcuteExemptions::AcuteExemptions(const ConformingMesh& mesh, AcuteGeometry& acute) : mesh_(mesh), acute_(acute) {
    const ValidPlc& plc = mesh.plc();
    if (!acute.any()) return;
    vertex_deg_.assign(plc.vertices.size(), kNoAngle);
    segment_deg_.assign(plc.segments.size(), kNoAngle);
    for (const AcuteFeature& f : plc.acute_features) {
        auto& angle = f.kind == EntityKind::vertex ? vertex_deg_[f.id] : segment_deg_[f.id];
        angle = std::min(angle, f.angle_deg);
        if (f.kind == EntityKind::vertex) continue;
        for (const VertexId v : plc.segments[f.id].ends) vertex_deg_[v.index()] = std::min(vertex_deg_[v.index()], f.angle_deg);
    }
}

void AcuteExemptions::meet_at_vertex(VertexId v, const Vec3& p, const Vec3& q, std::optional<Meeting>& best) const {
    if (vertex_deg_[v.index()] == kNoAngle) return;
    const Vec3& o = mesh_.point(v);
    if (p == o || q == o) return;
    const double seen = degrees_between(p - o, q - o);
    if (seen < 90 && (!best || seen < best->seen_deg)) best = Meeting{{EntityKind::vertex, v.value(), vertex_deg_[v.index()]}, seen};
}

void AcuteExemptions::meet_at_segment(SegmentId s, const Vec3& p, const Vec3& q, std::optional<Meeting>& best) const {
    if (segment_deg_[s.index()] == kNoAngle) return;
    const auto& ends = mesh_.plc().segments[s.index()].ends;
    const Vec3& a = mesh_.point(ends[0]);
    const Vec3 along = mesh_.point(ends[1]) - a;
    const auto offset = [&](const Vec3& x) { return (x - a) - (dot(x - a, along) / squared_norm(along)) * along; };
    const Vec3 u = offset(p), w = offset(q);
    if (!(squared_norm(u) > 0 && squared_norm(w) > 0)) return;
    const double seen = degrees_between(u, w);
    if (seen < 90 && (!best || seen < best->seen_deg)) best = Meeting{{EntityKind::segment, s.value(), segment_deg_[s.index()]}, seen};
}

/// Where the cells that carry p and q meet. Points of one facet meet only in the corners of its segments that carry them.
std::optional<AcuteExemptions::Meeting> AcuteExemptions::meeting_of(VertexId p, VertexId q) const {
    const VertexInfo &a = mesh_.info(p), &b = mesh_.info(q);
    const ValidPlc& plc = mesh_.plc();
    const auto facets_a = acute_.facets_of(a.carrier, a.carrier_id), facets_b = acute_.facets_of(b.carrier, b.carrier_id);
    const auto segments_a = acute_.segments_of(a.carrier, a.carrier_id), segments_b = acute_.segments_of(b.carrier, b.carrier_id);
    const Vec3 &x = mesh_.point(p), &y = mesh_.point(q);
    std::optional<Meeting> best;
    for (const SegmentId s : segments_a)
        for (const SegmentId t : segments_b) {
            if (s == t) return std::nullopt;  // both on one segment
            for (const VertexId v : plc.segments[s.index()].ends)
                if (plc.segments[t.index()].ends[0] == v || plc.segments[t.index()].ends[1] == v) meet_at_vertex(v, x, y, best);
        }
    const bool together = std::any_of(facets_a.begin(), facets_a.end(), [&](FacetId f) { return std::binary_search(facets_b.begin(), facets_b.end(), f); });
    if (together) return best;
    for (const FacetId f : facets_a)
        for (const FacetId g : facets_b) {
            for (const SegmentId s : acute_.shared_segments(f, g)) meet_at_segment(s, x, y, best);
            const auto &few = plc.facets[f.index()].vertices, &many = plc.facets[g.index()].vertices;
            const bool swap = few.size() > many.size();
            for (const VertexId v : swap ? many : few)
                if (acute_.is_on_facet(v, swap ? f : g)) meet_at_vertex(v, x, y, best);
        }
    const auto segments_to_facets = [&](std::span<const SegmentId> segments, std::span<const FacetId> facets) {
        for (const SegmentId s : segments)
            for (const VertexId v : plc.segments[s.index()].ends)
                for (const FacetId f : facets)
                    if (acute_.is_on_facet(v, f)) meet_at_vertex(v, x, y, best);
    };
    segments_to_facets(segments_a, facets_b);
    segments_to_facets(segments_b, facets_a);
    return best;
}

std::array<VertexId, 2> AcuteExemptions::shortest_edge(TetId t) const {
    const auto& c = mesh_.tets().corners(t);
    double shortest = std::numeric_limits<double>::infinity();
    std::array<VertexId, 2> out{};
    for (const auto& e : kEdgeCorners) {
        const double d = squared_distance(mesh_.point(c[e[0]]), mesh_.point(c[e[1]]));
        if (d >= shortest) continue;
        shortest = d;
        out = {c[e[0]], c[e[1]]};
    }
    return out;
}

bool AcuteExemptions::forces_shortest_edge(TetId t) const {
    if (!acute_.any()) return false;
    const auto [p, q] = shortest_edge(t);
    if (!on_boundary(p) || !on_boundary(q)) return false;
    const auto meeting = meeting_of(p, q);
    return meeting && meeting->seen_deg < kForcedBelowDeg;
}

/// The sharpest acute vertex of the cells that carry the copied end of a tetrahedron's shortest edge, if that is all on the boundary.
std::optional<ForcedBy> AcuteExemptions::origin_of_copy(TetId t) const {
    const auto ends = shortest_edge(t);
    if (!on_boundary(ends[0]) || !on_boundary(ends[1])) return std::nullopt;
    std::optional<ForcedBy> best;
    const auto offer = [&](VertexId v) {
        const double angle = vertex_deg_[v.index()];
        if (angle != kNoAngle && (!best || angle < best->angle_deg)) best = ForcedBy{EntityKind::vertex, v.value(), angle};
    };
    for (const VertexId v : ends) {
        const VertexInfo& info = mesh_.info(v);
        if (!info.copied) continue;
        if (info.carrier == CarrierKind::segment)
            for (const VertexId end : mesh_.plc().segments[info.carrier_id].ends) offer(end);
        else if (info.carrier == CarrierKind::facet)
            for (const VertexId w : mesh_.plc().facets[info.carrier_id].vertices) offer(w);
    }
    return best;
}

/// Is the circumcentre in the ball about v, where nothing is inserted?
bool AcuteExemptions::holds_centre(TetId t, VertexId v) const {
    const auto& c = mesh_.tets().corners(t);
    const Vec3 centre = circumcentre(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]));
    return distance(centre, mesh_.point(v)) < acute_.ball_radius(v);
}

std::optional<ForcedBy> AcuteExemptions::feature_at(VertexId v) const {
    if (v.index() >= vertex_deg_.size() || vertex_deg_[v.index()] == kNoAngle) return std::nullopt;
    return ForcedBy{EntityKind::vertex, v.value(), vertex_deg_[v.index()]};
}

std::optional<ForcedBy> AcuteExemptions::feature_at(TetId t) const {
    if (!acute_.any()) return std::nullopt;
    const auto& c = mesh_.tets().corners(t);
    std::optional<Meeting> best;
    const auto offer = [&](const std::optional<Meeting>& m) {
        if (m && (!best || m->seen_deg < best->seen_deg)) best = m;
    };
    for (const auto& e : kEdgeCorners)
        if (on_boundary(c[e[0]]) && on_boundary(c[e[1]])) offer(meeting_of(c[e[0]], c[e[1]]));
    if (best) return best->feature;
    if (std::count_if(c.begin(), c.end(), [&](VertexId v) { return on_boundary(v); }) < 2) return std::nullopt;
    for (const VertexId v : c) {
        const VertexId ball = mesh_.info(v).carrier == CarrierKind::input_vertex ? v : mesh_.info(v).ball;
        if (!ball.valid() || vertex_deg_[ball.index()] == kNoAngle) continue;
        const ForcedBy by{EntityKind::vertex, ball.value(), vertex_deg_[ball.index()]};
        if (v != ball || holds_centre(t, v)) return by;
    }
    return origin_of_copy(t);
}

}  // namespace wellmesh
