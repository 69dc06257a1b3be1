// SPDX-License-Identifier: Apache-2.0
#include "strategies/local_improver.hpp"

#include <algorithm>
#include <cmath>

#include "conforming/place_point.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "shape/corners.hpp"

namespace wellmesh {
namespace {

constexpr unsigned kMostPasses = 16;  // over what could not be improved before its surroundings changed; three or four are the rule
/// Gains below this, in a cosine or in V / L^3, are rounding and would let insertions go on for ever.
constexpr double kLeastGain = 1e-4;

}  // namespace

/// Larger is worse: the cosine of the smallest angle, or 1 / (1 + V / L^3). kNoAngleCosine for a flat or inverted tetrahedron.
double LocalImprover::badness(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) const {
    if (rule_.measure == SliverMeasure::dihedral) return max_cos_dihedral(a, b, c, d);
    const double volumes = six_volumes(a, b, c, d), squared_edge = shortest_edge_squared(a, b, c, d);
    return volumes > 0 ? 1 / (1 + volumes / (6 * squared_edge * std::sqrt(squared_edge))) : kNoAngleCosine;
}

double LocalImprover::badness(TetId t) const {
    const auto& c = mesh_.tets().corners(t);
    return badness(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]));
}

double LocalImprover::excess(TetId t) const {
    const auto& k = mesh_.tets().corners(t);
    const Vec3 &a = mesh_.point(k[0]), &b = mesh_.point(k[1]), &c = mesh_.point(k[2]), &d = mesh_.point(k[3]);
    return rule_.excess(a, b, c, d, six_volumes(a, b, c, d), shortest_edge_squared(a, b, c, d), touches_boundary(mesh_, k));
}

/// Does abcd keep the bounds on radius-edge ratio and size?
bool LocalImprover::in_bounds(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, CellId cell, double& squared_radius) const {
    const Vec3 u = b - a, v = c - a, w = d - a;
    const double six_volume = determinant(u, v, w);
    if (!(six_volume > 0)) return false;
    squared_radius = squared_norm(scaled_circumcentre(u, v, w)) / (4 * six_volume * six_volume);
    const TetSize size = sizes_.of(a, b, c, d, cell);
    return squared_radius <= squared_radius_edge_ * shortest_edge_squared(a, b, c, d) && squared_radius <= size.max_squared_circumradius &&
           six_volume <= 6 * size.max_volume;
}

void LocalImprover::push(TetId t) {
    if (!counts(t)) return;
    if (const double by = excess(t); by > 0) {
        heap_.push_back({by, mesh_.tets().corners(t)});
        std::push_heap(heap_.begin(), heap_.end());
    }
}

// ------------------------------------------------------------------------------------------------ picking regions

LocalImprover::Region LocalImprover::region_of(const Subsegment& s) const {
    const Vec3 &a = mesh_.point(s.a), &b = mesh_.point(s.b);
    return {Placement::on_segment(s), 0.5 * (a + b), distance(a, b) / 2, mix64(s.a.value(), s.b.value()), std::max(rule_.candidates / 4, 1U)};
}

bool LocalImprover::region_of(const Subface& s, Region& region) {
    const TetFace face = mesh_.find_subface(s);
    if (!face.valid()) return false;
    std::array<VertexId, 3> sorted = s.corners;
    std::sort(sorted.begin(), sorted.end());
    region = {Placement::on_facet(s.facet), {}, 0, mix64(sorted[0].value(), mix64(sorted[1].value(), sorted[2].value())), std::max(rule_.candidates / 2, 1U)};
    region.centre = circumcentre(mesh_.point(s.corners[0]), mesh_.point(s.corners[1]), mesh_.point(s.corners[2]), &region.radius);
    // Its own centre may encroach a subsegment, which is to be split instead.
    if (!mesh_.triangulation().find_conflict_cavity(candidate(region, 0), face.tet(), cavity_)) return false;
    boundary_.find_encroached(cavity_, region.where, encroached_segments_, encroached_faces_);
    if (!encroached_segments_.empty()) region = region_of(longest_of(mesh_, encroached_segments_));
    return true;
}

/// Where t may be removed from: the region of what its circumcentre encroaches, the lowest dimension first, then its own, of which other points may
/// encroach nothing.
void LocalImprover::find_regions(TetId t) {
    regions_.clear();
    const auto c = mesh_.tets().corners(t);
    Region own{Placement::in_cell(mesh_.cell(t)), {}, 0, mix64(mix64(c[0].value(), c[1].value()), mix64(c[2].value(), c[3].value())), rule_.candidates};
    own.centre = circumcentre(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]), &own.radius);
    if (!std::isfinite(own.radius)) return;
    if (mesh_.triangulation().find_conflict_cavity(flush_to_exact_range(own.centre), t, cavity_)) {
        boundary_.find_encroached(cavity_, own.where, encroached_segments_, encroached_faces_);
        if (!encroached_segments_.empty()) {
            regions_.push_back(region_of(longest_of(mesh_, encroached_segments_)));
        } else if (!encroached_faces_.empty()) {
            double depth = 0;
            const Subface chosen = holder_of_projection(mesh_, encroached_faces_, own.centre, depth);
            if (Region region; region_of(chosen, region)) regions_.push_back(region);
        }
    }
    regions_.push_back(own);
}

/// Try k of the region; the first is the centre, or near it where exact centres make cospherical structures (PickingRules::jitter).
Vec3 LocalImprover::candidate(const Region& region, unsigned k) const {
    const PickingRules& rules = boundary_.rules;
    const std::uint64_t key = mix64(boundary_.seed(), region.key);
    const double r = k == 0 ? rules.jitter * region.radius : rules.region(region.radius);
    if (region.where.carrier == CarrierKind::region) return flush_to_exact_range(region.centre + rules.region(region.radius) * picking_point(3, key, k));
    if (region.where.carrier == CarrierKind::facet) {
        const ValidFacet& facet = mesh_.plc().facets[region.where.carrier_id];
        const Vec3 u = r * picking_point(2, key, std::max(k, 1U));
        return project_to_facet(facet, region.centre + u.x * facet.axis_u + u.y * facet.axis_v);
    }
    const Vec3 d = mesh_.point(region.where.b) - mesh_.point(region.where.a);
    return project_to_segment(mesh_.plc(), SegmentId{region.where.carrier_id}, region.centre + (r * picking_point(1, key, std::max(k, 1U)).x / norm(d)) * d);
}

// ------------------------------------------------------------------------------------------------ removal

/// Badness of the worst tetrahedron that the cavity's point would make, among those smaller than b circumradii of t; more than `limit` if the point is refused.
double LocalImprover::judge_candidate(TetId t, const Region& region, double limit) {
    const bool inside = region.where.carrier == CarrierKind::region;
    if (inside && !mesh_.triangulation().in_last_cavity(t)) return kNoAngleCosine;
    if (inside && mesh_.cell(cavity_.tets[0]).value() != region.where.carrier_id) return kNoAngleCosine;
    const double smallness = rule_.smallness(region.radius);
    double worst = 0;
    const bool good = visit_new_star(mesh_, cavity_, region.where, [&](const Vec3& p, const Vec3& q, const Vec3& r, CellId cell, bool) {
        double squared_radius = 0;
        if (!in_bounds(p, q, r, cavity_.point, cell, squared_radius)) return false;
        if (!(squared_radius < smallness * smallness)) return true;
        worst = std::max(worst, badness(p, q, r, cavity_.point));
        return worst <= limit;
    });
    if (!good || (!inside && (!mesh_.holds_carrier(cavity_, region.where) || mesh_.would_break(cavity_, region.where)))) return kNoAngleCosine;
    boundary_.find_encroached(cavity_, region.where, encroached_segments_, encroached_faces_);
    if (!encroached_segments_.empty() || !encroached_faces_.empty()) return kNoAngleCosine;
    return distance_to_nearest(mesh_, cavity_) < boundary_.shortest_allowed(boundary_.reference_edge) ? kNoAngleCosine : worst;
}

/// Is what was just inserted as it was judged, with nothing encroached? Labels are known for certain only now.
bool LocalImprover::fits(double limit, double smallness) const {
    for (const TetId n : mesh_.triangulation().new_tets()) {
        if (boundary_.has_encroached(n)) return false;
        if (!counts(n)) continue;
        const auto& c = mesh_.tets().corners(n);
        double squared_radius = 0;
        if (!in_bounds(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]), mesh_.cell(n), squared_radius)) return false;
        if (squared_radius < smallness * smallness && badness(n) > limit) return false;
    }
    return true;
}

/// Has nothing changed around these corners since no try for them was good?
bool LocalImprover::is_stuck(const TetStore::Corners& corners) {
    const auto known = stuck_.find(key_of(corners));
    if (known == stuck_.end()) return false;
    touched_.resize(mesh_.vertex_slots(), 0);
    return std::all_of(corners.begin(), corners.end(), [&](VertexId v) { return touched_[v.index()] <= known->second; });
}

void LocalImprover::touch(const std::vector<TetId>& tets) {
    touched_.resize(mesh_.vertex_slots(), 0);
    ++clock_;
    for (const TetId t : tets)
        for (const VertexId v : mesh_.tets().corners(t))
            if (v != kInfiniteVertex) touched_[v.index()] = clock_;
}

/// Finds the best try of a region. @return its number, or the number of tries if none is good.
unsigned LocalImprover::best_try(TetId t, const Region& region, double limit) {
    // Good for either threshold.
    const double enough = rule_.measure == SliverMeasure::dihedral ? std::min(rule_.inside, rule_.at_boundary)
                                                                   : 1 / (1 + std::max(rule_.inside, rule_.at_boundary));
    unsigned chosen = region.tries;
    for (unsigned k = 0; k < region.tries; ++k) {
        if (!mesh_.triangulation().find_conflict_cavity(candidate(region, k), t, cavity_)) continue;
        const double worst = judge_candidate(t, region, limit);
        if (worst > limit) continue;
        limit = worst;
        chosen = k;
        if (worst <= enough) break;
    }
    return chosen;
}

bool LocalImprover::remove(TetId t) {
    const TetStore::Corners corners = mesh_.tets().corners(t);
    const VertexId parent = *std::max_element(corners.begin(), corners.end());
    const double limit = badness(t) - kLeastGain;
    find_regions(t);
    for (const Region& region : regions_) {
        t = find_tet(mesh_, corners);  // an insertion that was undone gave it another id
        const unsigned chosen = best_try(t, region, limit);
        if (chosen == region.tries || !mesh_.triangulation().find_conflict_cavity(candidate(region, chosen), t, cavity_)) continue;
        mesh_.save(cavity_.tets, before_);
        const bool inside = region.where.carrier == CarrierKind::region;
        const InsertionReason reason = inside ? InsertionReason::sliver : InsertionReason::boundary_by_sliver;
        const VertexId v = mesh_.insert(cavity_, region.where, {.reason = reason, .parent = parent});
        if (fits(limit, rule_.smallness(region.radius))) {
            ++insertions_;
            return true;
        }
        mesh_.undo_insertion(v, region.where, before_);
    }
    return false;
}

RunGuard::Verdict LocalImprover::pass(std::uint64_t vertex_budget) {
    while (!heap_.empty()) {
        std::pop_heap(heap_.begin(), heap_.end());
        const Waiting w = heap_.back();
        heap_.pop_back();
        const TetId t = find_tet(mesh_, w.corners);
        if (!t.valid()) continue;
        if (mesh_.vertex_count() >= vertex_budget) {
            budget_spent_ = true;
            return RunGuard::Verdict::go_on;
        }
        const RunGuard::Verdict verdict = guard_.poll(mesh_.vertex_count(), mesh_.tets().live(), heap_.size() + 1);
        if (verdict != RunGuard::Verdict::go_on) return verdict;
        if (is_stuck(w.corners)) continue;
        if (remove(t)) {
            touch(mesh_.triangulation().new_tets());
            for (const TetId n : mesh_.triangulation().new_tets()) push(n);
            if (const TetId still = find_tet(mesh_, w.corners); still.valid()) push(still);  // what it encroached was split
        } else {
            stuck_[key_of(w.corners)] = clock_;
        }
    }
    return RunGuard::Verdict::go_on;
}

RunGuard::Verdict LocalImprover::improve(std::uint64_t vertex_budget) {
    RunGuard::Verdict verdict = RunGuard::Verdict::go_on;
    for (unsigned p = 0; p < kMostPasses && verdict == RunGuard::Verdict::go_on && !budget_spent_; ++p) {
        const std::uint64_t before = insertions_;
        heap_.clear();
        for (std::size_t i = 0; i < mesh_.tets().slots(); ++i) push(TetId{i});
        verdict = pass(vertex_budget);
        if (insertions_ == before) break;
    }
    return verdict;
}

}  // namespace wellmesh
