// SPDX-License-Identifier: Apache-2.0
#include "shape/best_insertion.hpp"

#include <algorithm>
#include <cmath>

#include "conforming/place_point.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "shape/star_judge.hpp"

namespace wellmesh {
namespace {

constexpr double kPatternReach = 0.4;  // of the circumradius (half the length of a subsegment)
constexpr unsigned kSamplesInside = 40, kSamplesOnFacet = 30, kSamplesOnSegment = 12;

}  // namespace

/// @param unit  of the unit ball, disk or interval
Vec3 BestInsertion::candidate(const Placement& where, const Vec3& centre, double reach, const Vec3& unit) const {
    if (where.carrier == CarrierKind::segment) {
        const Vec3 half = 0.5 * (mesh_.point(where.b) - mesh_.point(where.a));
        return project_to_segment(mesh_.plc(), SegmentId{where.carrier_id}, centre + (kPatternReach * unit.x) * half);
    }
    if (where.carrier == CarrierKind::facet) {
        const ValidFacet& facet = mesh_.plc().facets[where.carrier_id];
        return project_to_facet(facet, centre + (kPatternReach * reach) * (unit.x * facet.axis_u + unit.y * facet.axis_v));
    }
    return flush_to_exact_range(centre + (kPatternReach * reach) * unit);
}

VertexId BestInsertion::insert_at(TetId t, const Placement& where, const Vec3& centre, double reach, unsigned samples, double limit) {
    if (!std::isfinite(reach)) return {};
    Triangulation& tri = mesh_.triangulation();
    const auto corners = mesh_.tets().corners(t);
    const std::uint64_t key = mix64(seed_, mix64(mix64(corners[0].value(), corners[1].value()), mix64(corners[2].value(), corners[3].value())));
    Vec3 best{};
    double best_cosine = limit;
    bool found = false;
    PickingPoints points(where.carrier == CarrierKind::region ? 3 : where.carrier == CarrierKind::facet ? 2 : 1, key);
    for (unsigned k = 0; k < samples; ++k) {
        const Vec3 p = candidate(where, centre, reach, k == 0 ? Vec3{} : points.next());
        ++evaluations_;
        if (!tri.in_conflict(t, p)) continue;
        StarJudge star(mesh_, judge_, where, p, best_cosine);
        if (!tri.grow_conflict_cavity(p, t, cavity_, [&](const BoundaryFace& b) { return star.take(b); })) continue;
        boundary_.find_encroached(cavity_, where, encroached_segments_, encroached_faces_);
        if (!encroached_segments_.empty() || !encroached_faces_.empty()) continue;
        if (where.carrier != CarrierKind::region && (!mesh_.holds_carrier(cavity_, where) || mesh_.would_break(cavity_, where))) continue;
        best = p;
        best_cosine = star.worst();
        found = true;
        if (best_cosine <= judge_.goal()) break;
    }
    if (!found) return {};
    const bool others_left = tri.left_zone();
    tri.forget_leaving();
    const auto fail = [&] {
        if (others_left) tri.leave_zone();
        return VertexId{};
    };
    if (where.carrier == CarrierKind::segment && !boundary_.has_both_stars({where.a, where.b, SegmentId{where.carrier_id}})) return fail();
    if (!tri.find_conflict_cavity(best, t, cavity_) || !mesh_.may_insert(cavity_, where)) return fail();
    mesh_.save(cavity_.tets, before_);
    const InsertionReason reason = where.carrier == CarrierKind::region ? InsertionReason::sliver : InsertionReason::boundary_by_sliver;
    const VertexId v = mesh_.insert(cavity_, where, {.reason = reason, .parent = *std::max_element(corners.begin(), corners.end())});
    changed_ = tri.new_tets();
    const bool fits = std::none_of(changed_.begin(), changed_.end(),
                                   [&](TetId n) { return boundary_.has_encroached(n) || (judge_.counts(n) && judge_.badness(n) > limit); });
    if (!fits) {
        mesh_.undo_new_insertion(v, where, before_);
        return fail();
    }
    ++count_;
    return v;
}

VertexId BestInsertion::insert(TetId t, double limit) {
    const auto c = mesh_.tets().corners(t);
    double radius = 0;
    const Vec3 centre = circumcentre(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]), &radius);
    if (const VertexId v = insert_at(t, Placement::in_cell(mesh_.cell(t)), centre, radius, kSamplesInside, limit); v.valid()) return v;
    // A refused point leaves the same tetrahedra under new numbers.
    const auto alive = [&] { return judge_.counts(t) && mesh_.tets().corners(t) == c; };
    for (unsigned f = 0; f < 4 && alive(); ++f) {
        const FacetId facet = mesh_.facet_at(TetFace{t, f});
        if (!facet.valid()) continue;
        const auto fc = mesh_.tets().face_corners(TetFace{t, f});
        const Vec3 middle = circumcentre(mesh_.point(fc[0]), mesh_.point(fc[1]), mesh_.point(fc[2]), &radius);
        if (const VertexId v = insert_at(t, Placement::on_facet(facet), middle, radius, kSamplesOnFacet, limit); v.valid()) return v;
    }
    for (unsigned e = 0; e < 6 && alive(); ++e) {
        const SegmentId s = mesh_.segment_at(t, e);
        if (!s.valid()) continue;
        const VertexId a = c[kEdgeCorners[e][0]], b = c[kEdgeCorners[e][1]];
        if (const VertexId v = insert_at(t, Placement::on_segment({a, b, s}), 0.5 * (mesh_.point(a) + mesh_.point(b)), 1, kSamplesOnSegment, limit); v.valid()) return v;
    }
    return {};
}

}  // namespace wellmesh
