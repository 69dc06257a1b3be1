// SPDX-License-Identifier: Apache-2.0
// Which tetrahedra are to be split, and which new points are welcome.
#include <algorithm>
#include <cmath>
#include <limits>

#include "conforming/place_point.hpp"
#include "core/vec3_math.hpp"
#include "quality/tet_shape.hpp"
#include "refinement/circumsphere.hpp"
#include "refinement/refine.hpp"

namespace wellmesh {
namespace {

/// Beyond this R/L the circumcentre in doubles is noise: the tetrahedron is split at a labelled face or at its longest edge.
constexpr double kFlatRadiusEdge = 1e6;
constexpr double kFlatVolume = 1e-10;  // of the longest edge squared, times the shortest: dihedral angles of about 1e-8 degrees

/// Are all corners on one facet? For four input vertices, which lie on many, the answer is always yes.
bool is_within_facet(const ConformingMesh& mesh, const TetStore::Corners& corners) {
    const auto carrier_at = [&](VertexId v) { return mesh.info(v).carrier; };
    if (std::any_of(corners.begin(), corners.end(), [&](VertexId v) { return carrier_at(v) == CarrierKind::region; })) return false;
    const auto holds_all = [&](FacetId f) { return std::all_of(corners.begin(), corners.end(), [&](VertexId v) { return mesh.is_on_facet(v, f); }); };
    for (const VertexId v : corners)
        if (carrier_at(v) == CarrierKind::facet) return holds_all(FacetId{mesh.info(v).carrier_id});
    for (const VertexId v : corners)
        if (carrier_at(v) == CarrierKind::segment) {
            const std::vector<FacetId>& facets = mesh.plc().segments[mesh.info(v).carrier_id].facets;
            return std::any_of(facets.begin(), facets.end(), holds_all);
        }
    return true;
}

}  // namespace

/// No tetrahedron is flat here: where rounding blurs the circumsphere it is computed exactly.
Refiner::Fault Refiner::classify_strictly(TetId t, double& squared_badness) const {
    const auto& k = mesh_.tets().corners(t);
    const Vec3 &a = mesh_.point(k[0]), &b = mesh_.point(k[1]), &c = mesh_.point(k[2]), &d = mesh_.point(k[3]);
    const Circumsphere sphere = careful_circumsphere(a, b, c, d);
    const double squared_edge = shortest_edge_squared(a, b, c, d);
    const TetSize size = sizes_.of(a, b, c, d, mesh_.cell(t));
    squared_badness = sphere.radius * sphere.radius;
    if (squared_badness > size.max_squared_circumradius || sphere.six_volumes > 6 * size.max_volume) return Fault::size;
    squared_badness /= squared_edge;
    if (!(squared_badness <= max_radius_edge_ * max_radius_edge_)) return Fault::radius_edge;
    return sliver_fault(t, sphere.six_volumes, squared_edge, squared_badness);
}

Refiner::Fault Refiner::sliver_fault(TetId t, double six_volumes, double squared_edge, double& squared_badness) const {
    if (!sliver_rule_ || !sliver_rule_->splits) return Fault::none;
    const auto& k = mesh_.tets().corners(t);
    const double excess =
        sliver_rule_->excess(mesh_.point(k[0]), mesh_.point(k[1]), mesh_.point(k[2]), mesh_.point(k[3]), six_volumes, squared_edge, touches_boundary(mesh_, k));
    if (!(excess > 0)) return Fault::none;
    squared_badness = excess;
    return Fault::sliver;
}

Refiner::Fault Refiner::classify(TetId t, double& squared_badness) const {
    if (strict()) return classify_strictly(t, squared_badness);
    const auto& corners = mesh_.tets().corners(t);
    const Vec3 &a = mesh_.point(corners[0]), &b = mesh_.point(corners[1]), &c = mesh_.point(corners[2]), &d = mesh_.point(corners[3]);
    const Vec3 u = b - a, v = c - a, w = d - a;
    const double six_volume = determinant(u, v, w);
    const double lu = squared_norm(u), lv = squared_norm(v), lw = squared_norm(w);
    const Vec3 n = lu * cross(v, w) + lv * cross(w, u) + lw * cross(u, v);
    const double squared_radius = squared_norm(n) / (4 * six_volume * six_volume);
    const double squared_edge = std::min({lu, lv, lw, squared_norm(v - u), squared_norm(w - u), squared_norm(w - v)});
    squared_badness = squared_radius;
    // No thicker than what rounding does to points of one facet: its circumsphere is noise, however ordinary it looks. Elsewhere points are where they are.
    const double squared_longest = std::max({lu, lv, lw, squared_norm(v - u), squared_norm(w - u), squared_norm(w - v)});
    const double longest = std::sqrt(squared_longest);
    if (!(six_volume > rounding_ * squared_longest) && is_within_facet(mesh_, corners)) {
        squared_badness = std::numeric_limits<double>::infinity();
        return Fault::flat;
    }
    if (!(six_volume > kThinVolume * longest * squared_longest)) return classify_thin(t, squared_longest, squared_badness);
    if (!(squared_radius < kFlatRadiusEdge * kFlatRadiusEdge * squared_edge)) {
        squared_badness = std::numeric_limits<double>::infinity();
        return Fault::flat;
    }
    const TetSize size = sizes_.of(a, b, c, d, mesh_.cell(t));
    if (squared_radius > squared_size_slack_ * size.max_squared_circumradius || six_volume > 6 * size.max_volume) return Fault::size;
    squared_badness = squared_radius / squared_edge;
    if (squared_badness > max_radius_edge_ * max_radius_edge_) return Fault::radius_edge;
    return sliver_fault(t, six_volume, squared_edge, squared_badness);
}

bool Refiner::is_surely_faultless(TetId t, const SquaredShapes& s, std::size_t lane) const {
    if (strict() || (sliver_rule_ && sliver_rule_->splits) || !may_trust(s, lane)) return false;
    // Of what is too flat all else is noise.
    const double six = s.six_volumes[lane], volume = six * six, squared_longest = s.longest_edge[lane] * (1 + kLaneSlack);
    if (!(six > rounding_ * squared_longest && volume > kThinVolume * kThinVolume * squared_longest * squared_longest * squared_longest)) return false;
    const double squared_radius = s.scaled_radius[lane] / (4 * volume);
    if (!(s.radius_edge[lane] < std::min(max_radius_edge_ * max_radius_edge_, kFlatRadiusEdge * kFlatRadiusEdge) * (1 - kLaneSlack))) return false;
    const TetStore::Corners& k = mesh_.tets().corners(t);
    const TetSize size = sizes_.of(mesh_.point(k[0]), mesh_.point(k[1]), mesh_.point(k[2]), mesh_.point(k[3]), mesh_.cell(t));
    return squared_radius < squared_size_slack_ * size.max_squared_circumradius * (1 - kLaneSlack) && six < 6 * size.max_volume * (1 - kLaneSlack);
}

/// Flat, or a needle between a coarse and a fine part: that has little volume, too, but a sound circumsphere, which is computed exactly.
Refiner::Fault Refiner::classify_thin(TetId t, double squared_longest, double& squared_badness) const {
    const auto& k = mesh_.tets().corners(t);
    const Vec3 &a = mesh_.point(k[0]), &b = mesh_.point(k[1]), &c = mesh_.point(k[2]), &d = mesh_.point(k[3]);
    const double squared_edge = shortest_edge_squared(a, b, c, d);
    const Circumsphere sphere = exact_circumsphere(a, b, c, d);
    const double squared_radius = sphere.radius * sphere.radius;
    squared_badness = std::numeric_limits<double>::infinity();
    if (!(sphere.six_volumes > kFlatVolume * squared_longest * std::sqrt(squared_edge)) || !(squared_radius < kFlatRadiusEdge * kFlatRadiusEdge * squared_edge)) return Fault::flat;
    const TetSize size = sizes_.of(a, b, c, d, mesh_.cell(t));
    squared_badness = squared_radius;
    if (squared_radius > squared_size_slack_ * size.max_squared_circumradius || sphere.six_volumes > 6 * size.max_volume) return Fault::size;
    squared_badness = squared_radius / squared_edge;
    if (squared_badness > max_radius_edge_ * max_radius_edge_) return Fault::radius_edge;
    return sliver_fault(t, sphere.six_volumes, squared_edge, squared_badness);
}

/// An edge that an acute angle of the input made short would be made anew, and shorter.
bool Refiner::is_forced(TetId t, Fault fault) const {
    if (fault == Fault::none || fault == Fault::size) return false;
    if (is_in_gap(t)) return true;
    if (fault == Fault::sliver) return false;
    // Flat ones between copies are for moves to mend; and where edges grade out of what copies made, too many vertices would be needed.
    if (fault == Fault::flat || mesh_.vertex_count() > frugal_from_ || is_relieved(t)) return exemptions_.feature_at(t).has_value();
    return exemptions_.forces_shortest_edge(t);
}

std::optional<ForcedBy> Refiner::forced_by(TetId t) {
    if (!boundary_.acute().any()) return std::nullopt;
    if (const auto feature = exemptions_.feature_at(t)) return feature;
    if (!may_be_excused(mesh_, t)) return std::nullopt;
    const VertexId ball = refusing_ball(t);
    return ball.valid() ? exemptions_.feature_at(ball) : std::nullopt;
}

bool Refiner::star_is_good(const Cavity& cavity, const Placement& where) const {
    const TetStore& tets = mesh_.tets();
    for (const BoundaryFace& b : cavity.boundary) {
        const TetId behind = b.inside.tet();
        if (!mesh_.in_domain(behind)) continue;
        const auto c = tets.face_corners(b.inside);
        if (c[0] == kInfiniteVertex || c[1] == kInfiniteVertex || c[2] == kInfiniteVertex) continue;
        if (where.carrier != CarrierKind::region && mesh_.has_labels(behind)) {
            const FacetId f = mesh_.facet_at(b.inside);
            // A flat tetrahedron against the carrier's own subface will lie outside.
            if (f.valid() && (where.carrier == CarrierKind::facet ? f.value() == where.carrier_id : true)) continue;
        }
        if (has_dihedral_below(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), cavity.point, sliver_cosine_)) return false;
    }
    return true;
}

bool Refiner::star_has_small_sliver(const Cavity& cavity, const Placement& where, double radius) {
    const SliverRule& rule = *sliver_rule_;
    return !visit_new_star(mesh_, cavity, where, [&](const Vec3& p, const Vec3& q, const Vec3& r, CellId, bool touches) {
        const double squared_edge = shortest_edge_squared(p, q, r, cavity.point);
        if (!(rule.excess(p, q, r, cavity.point, six_volumes(p, q, r, cavity.point), squared_edge, touches) > 0)) return true;
        const Circumsphere sphere = careful_circumsphere(p, q, r, cavity.point);
        return !(sphere.radius < rule.smallness(radius) && sphere.radius * sphere.radius <= max_radius_edge_ * max_radius_edge_ * squared_edge);
    });
}

bool Refiner::accepts(const Cavity& cavity, const Placement& where, double radius) {
    return sliver_rule_ ? !star_has_small_sliver(cavity, where, radius) : star_is_good(cavity, where);
}

}  // namespace wellmesh
