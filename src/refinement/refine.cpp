// SPDX-License-Identifier: Apache-2.0
#include "refinement/refine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "conforming/place_point.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "quality/tet_shape.hpp"
#include "refinement/circumsphere.hpp"

namespace wellmesh {
namespace {

/// Candidates matter only where the tetrahedra that they make may stay: within this factor of the size bound.
constexpr double kJudgeWithin = 1.5;
/// Beyond this R/L the circumcentre in doubles is noise: the tetrahedron is split at a labelled face or at its longest edge.
constexpr double kFlatRadiusEdge = 1e6;
/// About acute angles refinement leaves only what is directly forced until it has made so many vertices, then all that touches an acute feature.
constexpr double kGenerousGrowth = 3;
constexpr std::size_t kGenerousAllowance = 500;
constexpr double kFlatVolume = 1e-10;  // of the cubed longest edge: dihedral angles of about 1e-8 degrees

SizeFieldDomain sampled_domain(const ConformingMesh& mesh, RunGuard& guard, const Limits& limits) {
    const auto cell_at = [&mesh, near = TetId{}](const Vec3& p) mutable {
        near = mesh.triangulation().locate(p, near);
        return mesh.tets().is_finite(near) ? mesh.cell(near) : CellId{0};
    };
    return {cell_at, [&mesh, &guard] { return guard.poll(mesh.vertex_count(), mesh.tets().live(), 0) == RunGuard::Verdict::go_on; }, limits.max_vertices};
}

}  // namespace

Refiner::Refiner(ConformingMesh& mesh, BoundaryRefiner& boundary, RunGuard& guard, const MeshOptions& options)
    : mesh_(mesh), boundary_(boundary), guard_(guard), exemptions_(mesh, boundary.acute()), sizes_(mesh.plc(), options.size, sampled_domain(mesh, guard, options.limits)),
      max_radius_edge_(options.quality.max_radius_edge_ratio),
      max_vertices_(options.limits.max_vertices) {
    double largest = 0;
    for (const Vec3& p : mesh.plc().vertices) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    rounding_ = 64 * largest * 0x1p-53;  // heights of a few ulp
    boundary_.on_insert = [this](VertexId) { enqueue(mesh_.triangulation().new_tets()); };
    boundary_.on_repair = [this](const std::vector<TetId>& tets) { enqueue(tets); };
    boundary_.judge = [this](const Cavity& cavity, const Placement& where, double radius) { return !judging_ || accepts(cavity, where, radius); };
}

void Refiner::set_sliver_rule(const SliverRule& rule) {
    sliver_rule_ = rule;
    candidates_ = boundary_.candidates = rule.candidates;
}

void Refiner::guard_edges() {
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < mesh_.tets().slots(); ++i) {
        const TetId t{i};
        if (!mesh_.tets().is_finite(t) || !mesh_.in_domain(t)) continue;
        const auto& c = mesh_.tets().corners(t);
        shortest = std::min(shortest, shortest_edge_squared(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3])));
    }
    shortest = std::sqrt(shortest);
    // A tetrahedron too large has at least the bound for circumradius, or that of the regular one of the bound's volume. Its point makes edges of
    // (1 - delta) R; on what its centre encroaches, sqrt(1/2) less, twice (Lemma 2.5).
    shortest = std::min(shortest, (1 - boundary_.rules.delta) / 2 * kCircumradiusPerEdgeLength * sizes_.smallest());
    // One bound for all places: the finest one's edges are on the boundaries of its neighbours, too, and grade from there.
    boundary_.reference_edge = shortest;
}

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
    // No thicker than what rounding does to points of one facet: its circumsphere is noise, however ordinary it looks.
    const double squared_longest = std::max({lu, lv, lw, squared_norm(v - u), squared_norm(w - u), squared_norm(w - v)});
    const double longest = std::sqrt(squared_longest);
    if (!(six_volume > std::max(kFlatVolume * longest, rounding_) * squared_longest)) {
        squared_badness = std::numeric_limits<double>::infinity();
        return Fault::flat;
    }
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

void Refiner::enqueue(const std::vector<TetId>& tets) {
    for (const TetId t : tets) {
        if (!mesh_.in_domain(t) || mesh_.tets().is_ghost(t)) continue;
        double badness = 0;
        const Fault fault = classify(t, badness);
        if (is_forced(t, fault)) continue;
        switch (fault) {
            case Fault::none: break;
            case Fault::size: by_size_.push(t, mesh_.tets().corners(t), badness); break;
            case Fault::radius_edge:
            case Fault::flat: by_radius_edge_.push(t, mesh_.tets().corners(t), badness); break;
            case Fault::sliver: by_sliver_.push(t, mesh_.tets().corners(t), badness); break;
        }
    }
}

void Refiner::enqueue_all() {
    std::vector<TetId> all;
    for (std::size_t i = 0; i < mesh_.tets().slots(); ++i)
        if (mesh_.tets().is_finite(TetId{i})) all.push_back(TetId{i});
    enqueue(all);
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

void Refiner::report_milestones() {
    if (!by_size_.empty()) return;
    if (!std::exchange(size_met_, true)) original_vertices_ = mesh_.vertex_slots();
    if (!boundary_.recorder) return;
    boundary_.recorder->on_milestone(InsertionRecorder::Milestone::size_met);
    if (by_radius_edge_.empty()) boundary_.recorder->on_milestone(InsertionRecorder::Milestone::almost_good);
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

/// An edge that an acute angle of the input made short would be made anew, and shorter.
bool Refiner::is_forced(TetId t, Fault fault) const {
    if (fault != Fault::radius_edge && fault != Fault::flat) return false;
    // Flat ones between copies are for moves to mend; and where edges grade out of what copies made, too many vertices would be needed.
    if (fault == Fault::flat || mesh_.vertex_count() > frugal_from_) return exemptions_.feature_at(t).has_value();
    return exemptions_.forces_shortest_edge(t);
}

std::optional<ForcedBy> Refiner::forced_by(TetId t) {
    if (!boundary_.acute().any()) return std::nullopt;
    if (const auto feature = exemptions_.feature_at(t)) return feature;
    const auto& k = mesh_.tets().corners(t);
    if (std::count_if(k.begin(), k.end(), [&](VertexId v) { return mesh_.info(v).carrier != CarrierKind::region; }) < 2) return std::nullopt;
    double radius = 0;
    const Vec3 centre = flush_to_exact_range(circumcentre(mesh_.point(k[0]), mesh_.point(k[1]), mesh_.point(k[2]), mesh_.point(k[3]), &radius));
    if (!in_exact_range(centre) || !mesh_.triangulation().find_conflict_cavity(centre, t, cavity_)) return std::nullopt;
    if (const VertexId v = boundary_.ball_around(cavity_); v.valid()) return exemptions_.feature_at(v);
    boundary_.find_encroached(cavity_, Placement::in_cell(mesh_.cell(t)), encroached_segments_, encroached_faces_);
    VertexId ball{};
    if (!encroached_segments_.empty()) {
        ball = boundary_.ball_holding(longest_of(mesh_, encroached_segments_));
    } else if (!encroached_faces_.empty()) {
        double depth = 0;
        ball = boundary_.ball_holding(Subface{holder_of_projection(mesh_, encroached_faces_, centre, depth)});
    }
    return ball.valid() ? exemptions_.feature_at(ball) : std::nullopt;
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
        for (unsigned k = 1; k < candidates_ && !sliver_free; ++k) {
            const Vec3 p = flush_to_exact_range(centre + boundary_.rules.region(radius) * picking_point(3, key, k));
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
    const Vec3 centre = flush_to_exact_range(circumcentre(a, b, c, d, &radius));
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

/// Splits what is larger than its own segment or facet may have it, as large as pieces of tetrahedra within their bound can be: there is none here.
void Refiner::split_sized_boundary() {
    if (!sizes_.has_bare_entities()) return;
    const TetStore& tets = mesh_.tets();
    const SplitRequest request{InsertionReason::boundary_by_size, VertexId{}};
    std::size_t before = 0;
    do {
        before = mesh_.vertex_count();
        for (std::size_t i = 0; i < tets.slots(); ++i) {
            const TetId t{i};
            if (guard_.poll(before, tets.live(), 0) != RunGuard::Verdict::go_on) return;
            if (!tets.is_finite(t) || !mesh_.has_labels(t)) continue;
            const TetLabels labels = mesh_.labels(t);
            const auto c = tets.corners(t);
            const std::size_t vertices = mesh_.vertex_count();
            for (unsigned e = 0; e < 6 && mesh_.vertex_count() == vertices; ++e) {
                const VertexId a = c[kEdgeCorners[e][0]], b = c[kEdgeCorners[e][1]];
                if (labels.segments[e].valid() && distance(mesh_.point(a), mesh_.point(b)) > 2 * kCircumradiusPerEdgeLength * sizes_.of_segment(labels.segments[e]))
                    boundary_.split(Subsegment{a, b, labels.segments[e]}, request);
            }
            for (unsigned f = 0; f < 4 && mesh_.vertex_count() == vertices; ++f) {
                if (!labels.facets[f].valid()) continue;
                const auto fc = tets.face_corners(TetFace{t, f});
                double radius = 0;
                circumcentre(mesh_.point(fc[0]), mesh_.point(fc[1]), mesh_.point(fc[2]), &radius);
                if (radius > kCircumradiusPerEdgeLength * sizes_.of_facet(labels.facets[f])) boundary_.split(Subface{fc, labels.facets[f]}, request);
            }
            if (mesh_.vertex_count() != vertices) boundary_.conform();
        }
    } while (mesh_.vertex_count() > before);  // what rounding keeps from being split stays
}

RunGuard::Verdict Refiner::refine() {
    if (boundary_.acute().any()) frugal_from_ = static_cast<std::size_t>(kGenerousGrowth * static_cast<double>(mesh_.vertex_count())) + kGenerousAllowance;
    frugal_from_ += static_cast<std::size_t>(std::min(2 * sizes_.expected_vertices(), 1e9));
    split_sized_boundary();
    enqueue_all();
    keeps_last_ = max_vertices_.has_value() || boundary_.acute().any();
    RunGuard::Verdict verdict = RunGuard::Verdict::go_on;
    try {
        verdict = drain();
    } catch (const MeshError& e) {
        // A cascade at acute input that met the ceiling: the mesh before it is as good as any.
        if (e.code() != ErrorCode::budget_exhausted || !last_) throw;
        mesh_ = std::move(*last_);
        verdict = RunGuard::Verdict::out_of_vertices;
    }
    keeps_last_ = false;
    if (last_ && guard_.has_too_many(mesh_.vertex_count())) mesh_ = std::move(*last_);
    last_.reset();
    return verdict;
}

/// A cascade may take more vertices than are left, by hundreds: then the last copy is the result. One is made whenever half as many are left as at the
/// one before, so there are few, and little is lost; where only the algorithm's own ceiling is to be feared, whenever there are twice as many.
void Refiner::keep_last() {
    const std::uint64_t count = mesh_.vertex_count(), left = max_vertices_ ? *max_vertices_ - std::min(count, *max_vertices_) : count;
    const bool due = !last_ || (max_vertices_ ? left <= left_at_last_ / 2 : count >= 2 * left_at_last_);
    if (!due || left == 0 || !guard_.can_double()) return;
    last_ = mesh_;
    left_at_last_ = left;
}

RunGuard::Verdict Refiner::drain() {
    while (true) {
        if (!boundary_.idle()) {
            judging_ = sliver_rule_.has_value();
            boundary_.step();
            continue;
        }
        if (keeps_last_) keep_last();
        report_milestones();
        if (!by_sliver_.empty() && mesh_.vertex_count() >= sliver_budget_) {
            sliver_budget_spent_ = true;
            by_sliver_.clear();
        }
        if (by_size_.empty() && by_radius_edge_.empty() && by_sliver_.empty()) return RunGuard::Verdict::go_on;
        const RunGuard::Verdict verdict = guard_.poll(mesh_.vertex_count(), mesh_.tets().live(), by_size_.size() + by_radius_edge_.size() + by_sliver_.size());
        if (verdict != RunGuard::Verdict::go_on) {
            by_size_.clear();
            by_radius_edge_.clear();
            by_sliver_.clear();
            return verdict;
        }
        BadTetQueue& queue = !by_size_.empty() ? by_size_ : !by_radius_edge_.empty() ? by_radius_edge_ : by_sliver_;
        const BadTetQueue::Entry e = queue.pop();
        if (!mesh_.tets().is_live(e.tet) || mesh_.tets().is_ghost(e.tet) || BadTetQueue::fingerprint(mesh_.tets().corners(e.tet)) != e.fingerprint) continue;
        if (!mesh_.in_domain(e.tet)) continue;
        double badness = 0;
        const Fault fault = classify(e.tet, badness);
        if (fault == Fault::none || is_forced(e.tet, fault)) continue;
        const std::size_t vertices_before = mesh_.vertex_count();
        if (fault == Fault::flat) split_flat(e.tet);
        else process(e.tet, fault == Fault::size ? InsertionReason::size : fault == Fault::sliver ? InsertionReason::sliver : InsertionReason::radius_edge);
        // It may have survived when the boundary was split instead: then it waits again. If nothing could be done it is given up.
        if (mesh_.vertex_count() != vertices_before && mesh_.tets().is_finite(e.tet) && BadTetQueue::fingerprint(mesh_.tets().corners(e.tet)) == e.fingerprint && mesh_.in_domain(e.tet)) {
            queue.push(e.tet, mesh_.tets().corners(e.tet), badness);
        }
    }
}

RunGuard::Verdict Refiner::split(TetId t, InsertionReason reason) {
    const std::uint32_t print = BadTetQueue::fingerprint(mesh_.tets().corners(t));
    double badness = 0;
    squared_size_slack_ = kSizeTolerance * kSizeTolerance;
    for (unsigned attempts = 0; attempts < 64; ++attempts) {
        if (!mesh_.tets().is_finite(t) || BadTetQueue::fingerprint(mesh_.tets().corners(t)) != print || !mesh_.in_domain(t)) break;
        if (classify(t, badness) == Fault::flat) split_flat(t);
        else process(t, reason);
        judging_ = sliver_rule_.has_value();
        while (!boundary_.idle()) boundary_.step();
    }
    const RunGuard::Verdict verdict = drain();
    squared_size_slack_ = 1;
    return verdict;
}

}  // namespace wellmesh
