// SPDX-License-Identifier: Apache-2.0
#include "shape/vertex_mover.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "conforming/place_point.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "shape/star_judge.hpp"

namespace wellmesh {
namespace {

constexpr double kReach = 0.3;       // of the mean incident edge: how far a vertex may be sampled; other candidates may go 1.5 times as far
constexpr double kNearReach = 0.4;   // of that: every other sample stays this near
/// A hole costs the square of its tetrahedra. Stars have 25, and hundreds only where an acute angle forces them.
constexpr std::size_t kMostTets = 400;
constexpr double kGain = 0.1;        // of the way to the goal, in cosine: less is no progress
constexpr double kFlatCosine = 0.99996;  // of half a degree: where the input is acute anything better than flat is progress,
constexpr std::array kFineSteps{0.1, -0.1, 0.03, -0.03, 0.01, -0.01, 0.003, -0.003};  // and small steps, in reaches, are all that fit between copies
constexpr std::size_t kTrials = 3;   // how many of the best candidates are tried in earnest where the boundary may still refuse them
constexpr std::size_t kExcusedTrials = 12;  // and where the star has tetrahedra that are excused, which candidates do not know
constexpr std::size_t kMostFailures = 6;  // faces of cavities that are remembered
constexpr double kRefused = std::numeric_limits<double>::infinity();  // worse than any shape: the place itself is not to be had

}  // namespace

VertexMover VertexMover::for_zone(ConformingMesh& view, BoundaryRefiner& boundary, const TetJudge& judge) {
    VertexMover out(view, boundary, judge, seed_);
    if (attempts_.size() < mesh_.vertex_slots()) attempts_.resize(mesh_.vertex_slots(), 0);
    out.attempts_ = attempts_.view();
    out.follow_gradients_ = follow_gradients_;
    return out;
}

void VertexMover::join(const VertexMover& zone) {
    const MoveStatistics& s = zone.statistics_;
    statistics_.moves += s.moves;
    statistics_.smoothings += s.smoothings;
    statistics_.removals += s.removals;
    statistics_.attempts += s.attempts;
    statistics_.evaluations += s.evaluations;
    statistics_.undone += s.undone;
}

Vec3 VertexMover::on_carrier(const Vec3& p) const {
    if (where_.carrier == CarrierKind::segment) return project_to_segment(mesh_.plc(), SegmentId{where_.carrier_id}, p);
    if (where_.carrier == CarrierKind::facet) return project_to_facet(mesh_.plc().facets[where_.carrier_id], p);
    return flush_to_exact_range(p);
}

bool VertexMover::find_placement() {
    const VertexInfo& info = mesh_.info(vertex_);
    where_ = Placement{info.carrier, info.carrier_id, {}, {}};
    if (info.carrier != CarrierKind::segment) return true;
    for (const TetId t : hole_.star) {
        if (!mesh_.has_labels(t)) continue;
        const unsigned at = mesh_.tets().find_corner(t, vertex_);
        for (unsigned k = 0; k < 4; ++k) {
            if (k == at || !mesh_.segment_at(t, kEdgeOf[at][k]).valid()) continue;
            const VertexId w = mesh_.tets().corner(t, k);
            if (w == where_.a || w == where_.b) continue;
            (where_.a.valid() ? where_.b : where_.a) = w;
        }
    }
    return where_.b.valid();
}

/// Finds the hole that v would leave, and what the star is like. @return false if v can't move.
bool VertexMover::look_at_star(VertexId v) {
    if (mesh_.info(v).carrier == CarrierKind::input_vertex || !mesh_.triangulation().is_inserted(v)) return false;
    vertex_ = v;
    if (!mesh_.triangulation().find_hole(v, hole_, kMostTets) || !mesh_.has_room_to_move(std::max(kMostTets, hole_.filling.size()))) return false;
    if (!find_placement()) return false;
    if (where_.carrier == CarrierKind::segment && !boundary_.has_both_stars({where_.a, where_.b, SegmentId{where_.carrier_id}})) return false;
    home_ = mesh_.point(v);
    optimal_ = middle_ = Vec3{};
    star_cosine_ = 0;
    double volume = 0, length = 0;
    std::size_t edges = 0;
    for (const TetId t : hole_.star) {
        if (!judge_.counts(t)) continue;
        star_cosine_ = std::max(star_cosine_, judge_.shape_badness(t));
        const auto f = mesh_.tets().face_corners(TetFace{t, mesh_.tets().find_corner(t, v)});
        const Vec3 a = mesh_.point(f[0]) - home_, b = mesh_.point(f[1]) - home_, c = mesh_.point(f[2]) - home_;
        optimal_ = optimal_ + 0.5 * scaled_circumcentre(a, b, c);  // |volume| (circumcentre - home), times six
        volume += determinant(a, b, c);
        middle_ = middle_ + a + b + c;
        length += norm(a) + norm(b) + norm(c);
        edges += 3;
    }
    if (edges == 0) return false;
    optimal_ = (1 / volume) * optimal_;
    middle_ = (1.0 / static_cast<double>(edges)) * middle_;
    mean_edge_ = length / static_cast<double>(edges);
    return true;
}

/// Copies of vertices make flat tetrahedra of four points on one circle; any step off the circle does away with them.
bool VertexMover::is_flat_at_acute() const { return star_cosine_ > kFlatCosine && boundary_.acute().any(); }

void VertexMover::offer(const Vec3& offset, double reach) {
    const double far = norm(offset);
    if (!(far > 0) || !std::isfinite(far)) return;
    proposals_.push_back(on_carrier(home_ + std::min(1.0, 1.5 * reach / far) * offset));
}

/// The circumcentre c lies on the axis of the face opposite the vertex a, at a height t above its plane, a at a height h; by |a - c|^2 = r^2 + t^2
/// with the face's fixed circumradius r, dt/da = (a - c) / h, so the gradient of R^2 = r^2 + t^2 is 2 t (a - c) / h.
void VertexMover::propose_gradients(TetId worst, double reach) {
    const auto f = mesh_.tets().face_corners(TetFace{worst, mesh_.tets().find_corner(worst, vertex_)});
    const Vec3 p = mesh_.point(f[0]) - home_, q = mesh_.point(f[1]) - home_, r = mesh_.point(f[2]) - home_;
    const Vec3 normal = cross(q - p, r - p), centre = (1 / (2 * determinant(p, q, r))) * scaled_circumcentre(p, q, r);  // from home
    const double t = dot(centre - p, normal), h = -dot(p, normal);
    if (const double radius = norm(centre); std::isfinite(radius) && radius > 0)
        for (const double step : {0.25, 0.5, 1.0}) offer((t * h > 0 ? -step : step) * (reach / radius) * centre, reach);
    for (const double step : {0.25, -0.25, 0.5, -0.5}) offer((step * reach / norm(normal)) * normal, reach);
}

/// Of the vertex at hand, so that who else has been tried meanwhile makes no difference.
std::uint32_t VertexMover::count_attempt() {
    if (attempts_.size() < mesh_.vertex_slots()) attempts_.resize(mesh_.vertex_slots(), 0);
    return ++attempts_[vertex_.index()];
}

/// Places to try: the optimal-Delaunay point, the neighbours' middle, offsets against the worst tetrahedron's opposite face, then samples.
void VertexMover::propose(TetId worst, unsigned samples) {
    proposals_.clear();
    const double reach = kReach * mean_edge_;
    const std::uint64_t key = mix64(seed_, mix64(vertex_.value(), count_attempt()));
    offer(optimal_, reach);
    offer(middle_, reach);
    if (follow_gradients_) propose_gradients(worst, reach);
    const auto scale = [&](unsigned k) { return ((k & 1U) ? 1.0 : kNearReach) * reach; };
    PickingPoints points(where_.carrier == CarrierKind::region ? 3 : where_.carrier == CarrierKind::facet ? 2 : 1, key);
    if (where_.carrier == CarrierKind::region) {
        const auto f = mesh_.tets().face_corners(TetFace{worst, mesh_.tets().find_corner(worst, vertex_)});
        const Vec3 n = cross(mesh_.point(f[1]) - mesh_.point(f[0]), mesh_.point(f[2]) - mesh_.point(f[0]));
        for (const double step : {0.4, -0.4, 1.0, -1.0}) offer((step * reach / norm(n)) * n, reach);
        for (unsigned k = 1; k <= samples; ++k) offer(scale(k) * points.next(), reach);
    } else if (where_.carrier == CarrierKind::facet) {
        const ValidFacet& facet = mesh_.plc().facets[where_.carrier_id];
        for (unsigned k = 1; k <= samples; ++k) {
            const Vec3 u = scale(k) * points.next();
            offer(u.x * facet.axis_u + u.y * facet.axis_v, reach);
            if (is_flat_at_acute() && k <= kFineSteps.size()) offer(std::abs(kFineSteps[k - 1]) * (u.x * facet.axis_u + u.y * facet.axis_v), reach);
        }
    } else {
        const Vec3 d = mesh_.point(where_.b) - mesh_.point(where_.a);
        for (unsigned k = 1; k <= samples / 2; ++k) offer((reach * points.next().x / norm(d)) * d, reach);
        if (is_flat_at_acute())
            for (const double step : kFineSteps) offer((step * reach / norm(d)) * d, reach);
    }
}

bool VertexMover::take_out() {
    mesh_.save(hole_.star, star_before_);
    if (!mesh_.remove(hole_)) return false;
    ++statistics_.attempts;
    filling_ = mesh_.triangulation().new_tets();
    judge_filling();
    return true;
}

void VertexMover::judge_filling() {
    failures_.clear();
    filling_cosine_.resize(filling_.size());
    for (std::size_t i = 0; i < filling_.size(); ++i) filling_cosine_[i] = judge_.counts(filling_[i]) ? judge_.badness(filling_[i]) : 0;
    worst_filling_ = static_cast<std::size_t>(std::max_element(filling_cosine_.begin(), filling_cosine_.end()) - filling_cosine_.begin());
}

void VertexMover::put_back() {
    mesh_.triangulation().set_point(vertex_, home_);
    mesh_.undo_removal(vertex_, where_, star_before_, filling_);
}

void VertexMover::note(bool removed) {
    if (log_.is_open()) log_.note({vertex_, where_, home_, removed, star_before_, removed ? ConformingMesh::Snapshot{} : cavity_before_});
}

bool VertexMover::encroaches_nothing() {
    boundary_.find_encroached(cavity_, where_, encroached_segments_, encroached_faces_);
    return encroached_segments_.empty() && encroached_faces_.empty();
}

/// A tetrahedron that p would delete; an invalid id if p would leave something of the filling that is worse than `limit`.
TetId VertexMover::conflicting_tet(const Vec3& p, double limit) {
    const TetId worst = filling_[worst_filling_];
    if (filling_cosine_[worst_filling_] > limit) return mesh_.triangulation().in_conflict(worst, p) ? worst : TetId{};
    return mesh_.triangulation().locate(p, worst);
}

/// Candidates for one hole mostly fail on the same few faces. A face between a tetrahedron in conflict with p and one that isn't is on the boundary of p's
/// cavity, which need not be found for that.
bool VertexMover::fails_like_others(StarJudge& star, const Vec3& p) {
    const Triangulation& tri = mesh_.triangulation();
    for (const BoundaryFace& face : failures_)
        if (!star.take(face) && tri.in_conflict(face.inside.tet(), p) && !tri.in_conflict(face.outside.tet(), p)) {
            note_failure(BoundaryFace{face});
            return true;
        }
    return false;
}

void VertexMover::note_failure(const BoundaryFace& face) {
    const auto same = std::find_if(failures_.begin(), failures_.end(), [&](const BoundaryFace& f) { return f.inside == face.inside; });
    if (same != failures_.end()) failures_.erase(same);
    else if (failures_.size() == kMostFailures) failures_.pop_back();
    failures_.insert(failures_.begin(), face);
}

double VertexMover::try_point(const Vec3& p, double limit) {
    Triangulation& tri = mesh_.triangulation();
    ++statistics_.evaluations;
    StarJudge known(mesh_, judge_, where_, p, limit);
    if (fails_like_others(known, p)) return kRefused;
    const TetId seed = conflicting_tet(p, limit);
    if (!seed.valid()) return kRefused;
    // Where the cavity is in two cells the point encroaches what is between them: any tetrahedron of it tells the cell.
    const bool inside = where_.carrier == CarrierKind::region;
    if (inside && mesh_.cell(seed).value() != where_.carrier_id) return kRefused;
    StarJudge star(mesh_, judge_, where_, p, limit);
    if (!tri.grow_conflict_cavity(p, seed, cavity_, [&](const BoundaryFace& b) { return star.take(b); })) {
        if (!tri.left_zone()) note_failure(cavity_.boundary.back());
        return kRefused;
    }
    if (cavity_.boundary.size() > kMostTets) return kRefused;
    for (std::size_t i = 0; i < filling_.size(); ++i)
        if (filling_cosine_[i] > limit && !tri.in_last_cavity(filling_[i])) return kRefused;
    if (!encroaches_nothing()) return kRefused;
    if (!inside && (!mesh_.holds_carrier(cavity_, where_) || mesh_.would_break(cavity_, where_))) return kRefused;
    return star.worst();
}

/// Is everything that changed at least as good as `limit`, and nothing labelled in it encroached?
bool VertexMover::fits(double limit, bool is_judged) const {
    for (const TetId t : changed_) {
        if (!mesh_.tets().is_live(t)) continue;
        if (boundary_.has_encroached(t)) return false;
        if (is_judged) continue;
        if (judge_.counts(t) && judge_.badness(t) > limit && !(excuses && excuses(t) && judge_.shape_badness(t) <= star_cosine_)) return false;
    }
    return true;
}

/// Badness of the star but for what is excused in it.
double VertexMover::unexcused_star_cosine(double goal) const {
    double worst = 0;
    for (const TetId t : hole_.star)
        if (judge_.counts(t))
            if (const double cosine = judge_.shape_badness(t); cosine > worst && !(cosine > goal && excuses(t))) worst = cosine;
    return worst;
}

/// Puts the vertex at p, if what comes of it is as promised.
bool VertexMover::put(const Vec3& p, double judged, double limit) {
    Triangulation& tri = mesh_.triangulation();
    if (!tri.find_conflict_cavity(p, filling_[0], cavity_)) return false;
    std::erase_if(filling_, [&](TetId t) { return tri.in_last_cavity(t); });
    mesh_.save(cavity_.tets, cavity_before_);
    mesh_.reinsert(vertex_, cavity_, where_);
    changed_ = tri.new_tets();
    changed_.insert(changed_.end(), filling_.begin(), filling_.end());
    // Inside a cell the trial judged the very tetrahedra that are there now, by a bound as tight, unless some are excused.
    const bool is_judged = where_.carrier == CarrierKind::region && judged <= limit && !(beside_excused_ && excuses);
    if (fits(limit, is_judged)) {
        note(false);
        return true;
    }
    ++statistics_.undone;
    mesh_.undo_insertion(vertex_, where_, cavity_before_);
    filling_.insert(filling_.end(), tri.new_tets().begin(), tri.new_tets().end());
    judge_filling();
    return false;
}

bool VertexMover::move(VertexId v, TetId worst, double goal, unsigned samples) {
    if (!look_at_star(v)) return false;
    propose(worst, samples);
    const bool excusing = beside_excused_ && excuses;
    const double before = excusing ? unexcused_star_cosine(goal) : star_cosine_;
    const bool is_excused = before < star_cosine_;
    if (!take_out()) return false;
    double limit = before - std::max(kWorthwhile, kGain * (before - goal));
    if (excusing) limit = std::max(limit, goal);
    if (before > kFlatCosine && is_flat_at_acute()) limit = kFlatCosine;
    // What is excused is known once it is there: until then anything goes.
    double best = is_excused ? kNoAngleCosine : limit;
    ranked_.clear();
    for (const Vec3& p : proposals_) {
        const double cosine = try_point(p, best);
        if (mesh_.triangulation().left_zone()) break;  // another turn may have more room for it
        if (cosine > best) continue;
        ranked_.push_back({p, cosine});
        if (cosine <= goal) break;                                    // good enough
        if (where_.carrier == CarrierKind::region && !is_excused) best = cosine;  // inside, nothing can spoil the best one later
    }
    if (!mesh_.triangulation().left_zone() && put_best(limit, is_excused ? kExcusedTrials : kTrials)) {
        ++statistics_.moves;
        return true;
    }
    put_back();
    return false;
}

/// Puts the vertex at the best of the candidates that the boundary does not refuse.
bool VertexMover::put_best(double limit, std::size_t trials) {
    std::stable_sort(ranked_.begin(), ranked_.end(), [](const Candidate& a, const Candidate& b) { return a.cosine < b.cosine; });
    for (std::size_t k = 0; k < std::min(trials, ranked_.size()); ++k)
        if (put(ranked_[k].point, ranked_[k].cosine, limit)) return true;
    return false;
}

bool VertexMover::smooth(VertexId v, double floor) {
    if (!look_at_star(v)) return false;
    proposals_.clear();
    const double reach = kReach * mean_edge_;
    offer(optimal_, reach);
    offer(0.5 * optimal_, reach);
    if (proposals_.empty() || norm(proposals_[0] - home_) < 0.01 * mean_edge_ || !take_out()) return false;
    const double limit = std::max(floor, star_cosine_);
    for (const Vec3& p : proposals_)
        if (const double cosine = try_point(p, limit); cosine <= limit && put(p, cosine, limit)) {
            ++statistics_.smoothings;
            return true;
        }
    put_back();
    return false;
}

bool VertexMover::remove(VertexId v, double limit) {
    if (!look_at_star(v) || !take_out()) return false;
    changed_ = filling_;
    if (fits_without(limit)) {
        ++statistics_.removals;
        note(true);
        return true;
    }
    put_back();
    return false;
}

bool VertexMover::fits_without(double limit) const { return fits(std::max(limit, star_cosine_ - kWorthwhile)); }

bool VertexMover::drop(VertexId v) {
    if (!look_at_star(v) || !take_out()) return false;
    changed_ = filling_;
    ++statistics_.removals;
    note(true);
    return true;
}

bool VertexMover::pull(VertexId v, const Vec3& target, double limit) {
    if (!look_at_star(v)) return false;
    const Vec3 whole = target - home_;
    const bool is_excused = beside_excused_ && excuses && unexcused_star_cosine(limit) < star_cosine_;
    if (!take_out()) return false;
    ranked_.clear();
    const double bound = is_excused ? kNoAngleCosine : limit;
    for (const double part : {0.5, 0.35, 0.65, 0.2, 0.8}) {
        const Vec3 p = on_carrier(home_ + part * whole);
        if (const double cosine = try_point(p, bound); cosine <= bound) ranked_.push_back({p, cosine});
    }
    if (put_best(limit, is_excused ? kExcusedTrials : kTrials)) {
        ++statistics_.moves;
        return true;
    }
    put_back();
    return false;
}

}  // namespace wellmesh
