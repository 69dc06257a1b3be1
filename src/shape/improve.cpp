// SPDX-License-Identifier: Apache-2.0
#include "shape/improve.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "conforming/place_point.hpp"
#include "core/check.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "quality/tet_shape.hpp"

namespace wellmesh {
namespace {

constexpr double kReach = 0.3;             // of the mean incident edge: how far a vertex may move at once
constexpr double kInsertionReach = 0.4;    // of the circumradius: picking region of a last-resort insertion
constexpr unsigned kInsertionSamples = 40;
constexpr unsigned kMoveSamples = 30, kPatientMoveSamples = 60;
constexpr unsigned kPasses = 6;            // patience with moves saves vertices: splitting comes after
constexpr unsigned kSplitRounds = 10;
constexpr double kVertexBudget = 1.5;      // splits may not add more than half the vertices again
constexpr double kWorthwhile = 1e-4;       // least gain in cosine: smaller steps are no progress

constexpr unsigned kTriesUntouched = 3;    // failures after which a tetrahedron rests until its neighbourhood changes

std::uint64_t key_of(TetStore::Corners c) {
    std::sort(c.begin(), c.end());
    return mix64(mix64(c[0].value(), c[1].value()), mix64(c[2].value(), c[3].value()));
}

double cosine_of_degrees(double degrees) { return std::cos(degrees * (std::numbers::pi / 180)); }

}  // namespace

double ShapeImprover::cosine_of(TetId t) const {
    const auto& c = mesh_.tets().corners(t);
    return max_cos_dihedral(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]));
}

bool ShapeImprover::still_there(const Bad& bad) const {
    return mesh_.tets().is_finite(bad.tet) && BadTetQueue::fingerprint(mesh_.tets().corners(bad.tet)) == bad.fingerprint && mesh_.in_domain(bad.tet);
}

std::size_t ShapeImprover::count_bad(double angle_deg) const {
    const double goal = cosine_of_degrees(angle_deg);
    std::size_t n = 0;
    for (std::size_t i = 0; i < mesh_.tets().slots(); ++i)
        n += mesh_.tets().is_finite(TetId{i}) && mesh_.in_domain(TetId{i}) && cosine_of(TetId{i}) > goal;
    return n;
}

bool ShapeImprover::within_bounds(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, CellId cell) const {
    const Vec3 u = b - a, v = c - a, w = d - a;
    const double six_volumes = determinant(u, v, w);
    const double lu = squared_norm(u), lv = squared_norm(v), lw = squared_norm(w);
    const double squared_radius = squared_norm(lu * cross(v, w) + lv * cross(w, u) + lw * cross(u, v)) / (4 * six_volumes * six_volumes);
    const double squared_edge = std::min({lu, lv, lw, squared_norm(v - u), squared_norm(w - u), squared_norm(w - v)});
    const double rho = refiner_.max_radius_edge();
    const CellSize& size = refiner_.sizes()[cell.index()];
    return squared_radius <= rho * rho * squared_edge && squared_radius <= kSizeTolerance * kSizeTolerance * size.max_squared_circumradius &&
           six_volumes <= 6 * size.max_volume;
}

bool ShapeImprover::is_within_bounds(TetId t) const {
    const auto& c = mesh_.tets().corners(t);
    return within_bounds(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]), mesh_.cell(t));
}

double ShapeImprover::star_cosine(const Cavity& cavity, const Placement& where, double limit) const {
    const TetStore& tets = mesh_.tets();
    double worst = 0;
    for (const BoundaryFace& b : cavity.boundary) {
        const TetId behind = b.inside.tet();
        if (!mesh_.in_domain(behind)) continue;
        const auto c = tets.face_corners(b.inside);
        if (c[2] == kInfiniteVertex || c[1] == kInfiniteVertex || c[0] == kInfiniteVertex) continue;
        const Vec3 &p0 = mesh_.point(c[0]), &p1 = mesh_.point(c[1]), &p2 = mesh_.point(c[2]);
        const double cosine = max_cos_dihedral(p0, p1, p2, cavity.point);
        if (cosine <= limit && within_bounds(p0, p1, p2, cavity.point, mesh_.cell(behind))) {
            worst = std::max(worst, cosine);
            continue;
        }
        // A flat tetrahedron on a subface of the point's own carrier will belong to the other side.
        if (where.carrier != CarrierKind::region && mesh_.facet_at(b.inside).valid() && side_of_equatorial_sphere(p0, p1, p2, cavity.point) == Sign::positive) continue;
        return kNoAngleCosine;
    }
    return worst;
}

Vec3 ShapeImprover::on_carrier(const Placement& where, const Vec3& p) const {
    if (where.carrier == CarrierKind::segment) return project_to_segment(mesh_.plc(), SegmentId{where.carrier_id}, p);
    if (where.carrier == CarrierKind::facet) return project_to_facet(mesh_.plc().facets[where.carrier_id], p);
    return flush_to_exact_range(p);
}

bool ShapeImprover::placement_of(VertexId v, const std::vector<TetId>& star, Placement& where) const {
    const VertexInfo& info = mesh_.info(v);
    where = Placement{info.carrier, info.carrier_id, {}, {}};
    if (info.carrier != CarrierKind::segment) return info.carrier != CarrierKind::input_vertex;
    for (const TetId t : star) {
        if (!mesh_.has_labels(t)) continue;
        const unsigned at = mesh_.tets().find_corner(t, v);
        for (unsigned k = 0; k < 4; ++k) {
            if (k == at || !mesh_.segment_at(t, kEdgeOf[at][k]).valid()) continue;
            const VertexId w = mesh_.tets().corner(t, k);
            if (w == where.a || w == where.b) continue;
            (where.a.valid() ? where.b : where.a) = w;
        }
    }
    return where.b.valid();
}

/// Places to try: the optimal-Delaunay point, the star's middle, offsets against the worst tetrahedron's opposite face, then samples.
void ShapeImprover::propose(VertexId v, TetId worst, const Placement& where, unsigned samples) {
    proposals_.clear();
    const Vec3 here = mesh_.point(v);
    Vec3 odt{}, middle{};
    double volume = 0, length = 0;
    std::size_t edges = 0;
    for (const TetId t : star_) {
        if (mesh_.tets().is_ghost(t) || !mesh_.in_domain(t)) continue;
        const auto& c = mesh_.tets().corners(t);
        const double w = six_volumes(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]));
        odt = odt + w * (circumcentre(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3])) - here);
        volume += w;
        for (const VertexId x : c) {
            if (x == v) continue;
            middle = middle + (mesh_.point(x) - here);
            length += distance(mesh_.point(x), here);
            ++edges;
        }
    }
    if (edges == 0) return;
    const double reach = kReach * length / static_cast<double>(edges);
    const auto offer = [&](const Vec3& offset) {
        const double far = norm(offset);
        if (!(far > 0) || !std::isfinite(far)) return;
        proposals_.push_back(on_carrier(where, here + std::min(1.0, 1.5 * reach / far) * offset));
    };
    const std::uint64_t key = mix64(seed_, mix64(v.value(), ++clock_));
    if (where.carrier == CarrierKind::region) {
        offer((1 / volume) * odt);
        offer((1.0 / static_cast<double>(edges)) * middle);
        const unsigned at = mesh_.tets().find_corner(worst, v);
        const auto f = mesh_.tets().face_corners(TetFace{worst, at});
        const Vec3 n = cross(mesh_.point(f[1]) - mesh_.point(f[0]), mesh_.point(f[2]) - mesh_.point(f[0]));
        for (const double step : {0.4, -0.4, 1.0, -1.0}) offer((step * reach / norm(n)) * n);
        for (unsigned k = 1; k <= samples; ++k) offer(((k & 1U) ? 1.0 : 0.4) * reach * picking_point(3, key, k));
    } else if (where.carrier == CarrierKind::facet) {
        const ValidFacet& facet = mesh_.plc().facets[where.carrier_id];
        offer((1.0 / static_cast<double>(edges)) * middle);
        for (unsigned k = 1; k <= samples; ++k) {
            const Vec3 u = ((k & 1U) ? 1.0 : 0.4) * reach * picking_point(2, key, k);
            offer(u.x * facet.axis_u + u.y * facet.axis_v);
        }
    } else {
        const Vec3 d = mesh_.point(where.b) - mesh_.point(where.a);
        for (unsigned k = 1; k <= samples / 2; ++k) offer((reach * picking_point(1, key, k).x / norm(d)) * d);
    }
}

/// Are all of these (finite, domain) tetrahedra better than `cosine` and within bounds, and nothing labelled in them encroached?
bool ShapeImprover::fits(const std::vector<TetId>& tets, double cosine) const {
    for (const TetId t : tets) {
        if (!mesh_.tets().is_live(t)) continue;
        if (!mesh_.tets().is_ghost(t) && mesh_.in_domain(t) && (cosine_of(t) > cosine || !is_within_bounds(t))) return false;
        if (boundary_.has_encroached(t)) return false;
    }
    return true;
}

void ShapeImprover::touch(const std::vector<TetId>& tets) {
    if (touched_.size() < mesh_.vertex_slots()) touched_.resize(mesh_.vertex_slots() + 64, 0);
    ++clock_;
    for (const TetId t : tets) {
        if (!mesh_.tets().is_live(t)) continue;
        for (const VertexId v : mesh_.tets().corners(t))
            if (v != kInfiniteVertex) touched_[v.index()] = clock_;
        if (mesh_.tets().is_ghost(t) || !mesh_.in_domain(t)) continue;
        const double cosine = cosine_of(t);
        if (cosine > goal_cosine_) {
            heap_.push_back({cosine, t, BadTetQueue::fingerprint(mesh_.tets().corners(t))});
            std::push_heap(heap_.begin(), heap_.end());
        }
    }
}

bool ShapeImprover::move_vertex(VertexId v, TetId worst, unsigned samples) {
    Triangulation& tri = mesh_.triangulation();
    if (!tri.find_hole(v, hole_)) return false;
    star_ = hole_.star;
    Placement where;
    if (!placement_of(v, star_, where)) return false;
    const bool boundary = where.carrier != CarrierKind::region;
    double old_cosine = 0;
    for (const TetId t : star_)
        if (!mesh_.tets().is_ghost(t) && mesh_.in_domain(t)) old_cosine = std::max(old_cosine, cosine_of(t));
    propose(v, worst, where, samples);
    const Vec3 home = mesh_.point(v);
    mesh_.save(star_, star_before_);
    if (!mesh_.remove(hole_)) return false;
    ++statistics_.attempts;
    filling_ = tri.new_tets();
    filling_cosine_.resize(filling_.size());
    for (std::size_t i = 0; i < filling_.size(); ++i)
        filling_cosine_[i] = mesh_.tets().is_ghost(filling_[i]) || !mesh_.in_domain(filling_[i]) ? 0 : is_within_bounds(filling_[i]) ? cosine_of(filling_[i]) : kNoAngleCosine;
    const CellId cell = boundary ? CellId{} : CellId{where.carrier_id};
    ranked_.clear();
    double limit = old_cosine - kWorthwhile;
    for (const Vec3& p : proposals_) {
        ++statistics_.evaluations;
        if (!tri.find_conflict_cavity(p, filling_[0], cavity_)) continue;
        if (!boundary && mesh_.cell(cavity_.tets[0]) != cell) continue;
        bool good = true;
        for (std::size_t i = 0; i < filling_.size() && good; ++i)
            if (filling_cosine_[i] > limit && !tri.in_last_cavity(filling_[i])) good = false;
        if (!good) continue;
        const double cosine = star_cosine(cavity_, where, limit);
        if (cosine > limit) continue;
        if (boundary && (!mesh_.holds_carrier(cavity_, where) || mesh_.would_break(cavity_, where))) continue;
        boundary_.find_encroached(cavity_, where, encroached_segments_, encroached_faces_);
        if (!encroached_segments_.empty() || !encroached_faces_.empty()) continue;
        ranked_.push_back({p, cosine});
        if (cosine <= goal_cosine_) break;  // good enough
        if (!boundary) limit = cosine;      // inside, nothing can spoil the best one later
    }
    std::stable_sort(ranked_.begin(), ranked_.end(), [](const Candidate& a, const Candidate& b) { return a.cosine < b.cosine; });
    constexpr std::size_t kTrials = 3;
    for (std::size_t k = 0; k < std::min(kTrials, ranked_.size()); ++k) {
        if (!tri.find_conflict_cavity(ranked_[k].point, filling_[0], cavity_)) continue;
        mesh_.save(cavity_.tets, cavity_before_);
        mesh_.reinsert(v, cavity_, where);
        std::vector<TetId> changed = tri.new_tets();
        for (const TetId t : filling_)
            if (std::find(changed.begin(), changed.end(), t) == changed.end()) changed.push_back(t);
        if (fits(changed, old_cosine - kWorthwhile)) {
            ++statistics_.moves;
            touch(changed);
            return true;
        }
        ++statistics_.undone;
        mesh_.undo_insertion(v, where, cavity_before_);
        for (const TetId t : tri.new_tets()) filling_.push_back(t);  // ids may have changed hands
    }
    tri.set_point(v, home);
    mesh_.undo_removal(v, where, star_before_);
    return false;
}

/// The best of sampled points of the picking region, if its star is better than everything that it destroys.
bool ShapeImprover::insert_best(TetId t) {
    Triangulation& tri = mesh_.triangulation();
    const auto corners = mesh_.tets().corners(t);
    double radius = 0;
    const Vec3 centre = circumcentre(mesh_.point(corners[0]), mesh_.point(corners[1]), mesh_.point(corners[2]), mesh_.point(corners[3]), &radius);
    if (!std::isfinite(radius)) return false;
    const CellId cell = mesh_.cell(t);
    const Placement where = Placement::in_cell(cell);
    const std::uint64_t key = mix64(seed_, mix64(mix64(corners[0].value(), corners[1].value()), mix64(corners[2].value(), corners[3].value())));
    Vec3 best{};
    double best_cosine = cosine_of(t) - kWorthwhile;
    bool found = false;
    for (unsigned k = 0; k < kInsertionSamples; ++k) {
        const Vec3 p = flush_to_exact_range(centre + (kInsertionReach * radius) * picking_point(3, key, k));
        ++statistics_.evaluations;
        if (!tri.find_conflict_cavity(p, t, cavity_) || mesh_.cell(cavity_.tets[0]) != cell) continue;
        double destroyed = 0;
        for (const TetId d : cavity_.tets)
            if (!mesh_.tets().is_ghost(d) && mesh_.in_domain(d)) destroyed = std::max(destroyed, cosine_of(d));
        const double limit = std::min(best_cosine, destroyed - kWorthwhile);
        const double cosine = star_cosine(cavity_, where, limit);
        if (cosine > limit) continue;
        boundary_.find_encroached(cavity_, where, encroached_segments_, encroached_faces_);
        if (!encroached_segments_.empty() || !encroached_faces_.empty()) continue;
        best = p;
        best_cosine = cosine;
        found = true;
    }
    if (!found || !tri.find_conflict_cavity(best, t, cavity_)) return false;
    mesh_.insert(cavity_, where, {CarrierKind::region, InsertionReason::sliver, cell.value(), *std::max_element(corners.begin(), corners.end()), 0});
    ++statistics_.insertions;
    const std::vector<TetId> changed = tri.new_tets();
    touch(changed);
    return true;
}

/// The domain tetrahedron with these corners, if there is one: taking a vertex out and putting it back changes ids.
TetId ShapeImprover::find_tet(const TetStore::Corners& corners) {
    const TetFace face = mesh_.triangulation().find_face(corners[0], corners[1], corners[2]);
    if (!face.valid()) return {};
    for (const TetFace side : {face, mesh_.tets().across(face)})
        if (mesh_.tets().corner(side.tet(), side.face()) == corners[3] && mesh_.in_domain(side.tet())) return side.tet();
    return {};
}

void ShapeImprover::mend(const TetStore::Corners& corners, unsigned samples, bool may_insert) {
    std::uint64_t last_change = 0;
    for (const VertexId v : corners) last_change = std::max(last_change, touched_[v.index()]);
    Stuck& stuck = stuck_[key_of(corners)];
    if (stuck.when < last_change) stuck = {clock_, 0};
    if (stuck.failures >= kTriesUntouched) return;
    std::array<VertexId, 4> order = corners;
    std::sort(order.begin(), order.end(), [&](VertexId a, VertexId b) {
        const auto ka = static_cast<int>(mesh_.info(a).carrier), kb = static_cast<int>(mesh_.info(b).carrier);
        return ka != kb ? ka > kb : a < b;
    });
    for (const VertexId v : order) {
        if (mesh_.info(v).carrier == CarrierKind::input_vertex) continue;
        const TetId t = find_tet(corners);
        if (!t.valid() || move_vertex(v, t, samples)) return;
    }
    const TetId t = find_tet(corners);
    if (t.valid() && may_insert && insert_best(t)) return;
    stuck.when = clock_;
    ++stuck.failures;
}

RunGuard::Verdict ShapeImprover::pass(double goal_cosine, unsigned samples, bool may_insert) {
    goal_cosine_ = goal_cosine;
    heap_.clear();
    touched_.resize(std::max(touched_.size(), mesh_.vertex_slots()), 0);
    for (std::size_t i = 0; i < mesh_.tets().slots(); ++i) {
        const TetId t{i};
        if (!mesh_.tets().is_finite(t) || !mesh_.in_domain(t)) continue;
        const double cosine = cosine_of(t);
        if (cosine > goal_cosine) heap_.push_back({cosine, t, BadTetQueue::fingerprint(mesh_.tets().corners(t))});
    }
    std::make_heap(heap_.begin(), heap_.end());
    while (!heap_.empty()) {
        std::pop_heap(heap_.begin(), heap_.end());
        const Bad bad = heap_.back();
        heap_.pop_back();
        if (!still_there(bad)) continue;
        const RunGuard::Verdict verdict = guard_.poll(mesh_.vertex_count(), mesh_.tets().live(), heap_.size() + 1);
        if (verdict != RunGuard::Verdict::go_on) return verdict;
        mend(TetStore::Corners(mesh_.tets().corners(bad.tet)), samples, may_insert);
    }
    return RunGuard::Verdict::go_on;
}

RunGuard::Verdict ShapeImprover::improve(double angle_deg) {
    const double goal = cosine_of_degrees(angle_deg);
    const std::size_t vertices_at_start = mesh_.vertex_count();
    for (unsigned round = 0;; ++round) {
        std::size_t bad = count_bad(angle_deg);
        for (unsigned p = 0; p < kPasses && bad > 0; ++p) {
            const RunGuard::Verdict verdict = pass(goal, p == 0 ? kMoveSamples : kPatientMoveSamples, p > 0);
            if (verdict != RunGuard::Verdict::go_on) return verdict;
            const std::size_t left = count_bad(angle_deg);
            if (p > 0 && left >= bad) break;
            bad = left;
        }
        if (bad == 0 || round == kSplitRounds) return RunGuard::Verdict::go_on;
        if (static_cast<double>(mesh_.vertex_count()) > kVertexBudget * static_cast<double>(vertices_at_start) + 1000) return RunGuard::Verdict::go_on;
        // Moves are exhausted: split what is left, then move again.
        std::vector<Bad> left;
        for (std::size_t i = 0; i < mesh_.tets().slots(); ++i)
            if (mesh_.tets().is_finite(TetId{i}) && mesh_.in_domain(TetId{i}) && cosine_of(TetId{i}) > goal)
                left.push_back({cosine_of(TetId{i}), TetId{i}, BadTetQueue::fingerprint(mesh_.tets().corners(TetId{i}))});
        std::sort(left.begin(), left.end(), [](const Bad& a, const Bad& b) { return b < a; });
        for (const Bad& b : left) {
            if (!still_there(b)) continue;
            ++statistics_.splits;
            const RunGuard::Verdict verdict = refiner_.split(b.tet, InsertionReason::sliver);
            if (verdict != RunGuard::Verdict::go_on) return verdict;
        }
    }
}

}  // namespace wellmesh
