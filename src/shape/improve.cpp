// SPDX-License-Identifier: Apache-2.0
#include "shape/improve.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "shape/corners.hpp"

namespace wellmesh {
namespace {
constexpr unsigned kMoveSamples = 30, kPatientMoveSamples = 60;
constexpr unsigned kPatientPasses = 2;    // patience with moves saves vertices: smoothing and splitting come after
constexpr unsigned kSmoothingRounds = 4;
constexpr double kWorthRepeating = 0.85;  // part of the bad tetrahedra that may be left for another pass or smoothing to be tried
constexpr unsigned kSplitRounds = 16;     // on one rung,
constexpr unsigned kRemovalRounds = 3;    // of which later ones take nothing out again, else removals and splits may undo each other for ever
constexpr double kVertexBudget = 1.5;     // splits may not add more than half the vertices again,
constexpr std::size_t kVertexAllowance = 100;  // and so many on small meshes
constexpr std::uint64_t kCascadeCeiling = 2, kCascadeAllowance = 10000;  // beyond the budget; more is a cascade beside an acute angle
constexpr unsigned kMostCascades = 16;    // that are undone, one tetrahedron each given up, before a round of splits is
constexpr unsigned kTriesUntouched = 3;   // failures after which a tetrahedron rests until its neighbourhood changes
constexpr unsigned kTriesInAll = 4;       // smoothings around a tetrahedron, and last resorts, that failed: it waits for a split then
constexpr unsigned kLastTries = 3;
constexpr double kRungDeg = 5;
constexpr double kFirstRungDeg = 30;      // of moves alone, which mostly reach it, and do so better straight away than from rung to rung
constexpr double kStraightDeg = 35;       // goals up to this are mostly reached, and are aimed at straight away
/// From this angle on the aspect ratio is a goal too. The angle alone does not bound it: 30 degrees leave needles of R/r up to 11 at R/L = 2.
constexpr double kAspectFromDeg = 30, kMaxAspect = 8;
/// Smoothing may make angles this small, relative to the goal, on the way: moves mend them.
constexpr double kSmoothingFloor = 0.8;

/// Has the number of bad tetrahedra fallen enough to do the same again?
bool worth_it(std::size_t before, std::size_t after) { return static_cast<double>(after) <= kWorthRepeating * static_cast<double>(before); }

double cosine_of_degrees(double degrees) { return std::cos(degrees * (std::numbers::pi / 180)); }

}  // namespace

ImproveStatistics ShapeImprover::statistics() const {
    const MoveStatistics& m = mover_.statistics();
    return {m.moves, m.smoothings, m.removals, m.attempts, m.evaluations + insertion_.evaluations(), insertion_.count(), splits_, m.undone};
}

std::size_t ShapeImprover::count_bad(double angle_deg) const {
    const double goal = cosine_of_degrees(angle_deg);
    std::size_t n = 0;
    for (std::size_t i = 0; i < mesh_.tets().slots(); ++i) n += judge_.counts(TetId{i}) && judge_.cosine(TetId{i}) > goal;
    return n;
}

double ShapeImprover::worst_cosine() const {
    double worst = -1;
    for (std::size_t i = 0; i < mesh_.tets().slots(); ++i)
        if (judge_.counts(TetId{i}) && judge_.cosine(TetId{i}) > worst && !is_left_alone(TetId{i})) worst = judge_.cosine(TetId{i});
    return worst;
}

/// Of the shape, and of what refinement left too long and thin beside acute angles without being excused by them.
double ShapeImprover::badness_of(TetId t) {
    const double shape = judge_.shape_badness(t);
    if (!refiner_.knows_forced() || judge_.keeps_radius_edge(t) || refiner_.forced_by(t)) return shape;
    return kNoAngleCosine;
}

ShapeImprover::Bad ShapeImprover::listed(TetId t, double badness) const {
    const Corners& corners = mesh_.tets().corners(t);
    return {badness, corners, blocks_.of(mesh_.point(corners[0]))};
}

void ShapeImprover::push(TetId t, double badness) {
    heap_.push_back(listed(t, badness));
    std::push_heap(heap_.begin(), heap_.end(), IsLater{});
}

void ShapeImprover::collect_bad() {
    blocks_ = Blocks(mesh_.triangulation().low(), mesh_.triangulation().high(), mesh_.tets().live());
    heap_.clear();
    left_.clear();
    for (std::size_t i = 0; i < mesh_.tets().slots(); ++i) {
        const TetId t{i};
        if (!judge_.counts(t) || is_surely_good(t)) continue;
        const double cosine = badness_of(t);
        if (cosine > goal_cosine_ && !is_left_alone(t)) left_.push_back(listed(t, cosine));
    }
}

void ShapeImprover::touch(const std::vector<TetId>& tets) {
    if (touched_.size() < mesh_.vertex_slots()) {
        touched_.resize(mesh_.vertex_slots() + 64, 0);
        tried_.resize(touched_.size());
    }
    ++clock_;
    for (const TetId t : tets) {
        if (!mesh_.tets().is_live(t)) continue;
        for (const VertexId v : mesh_.tets().corners(t))
            if (v != kInfiniteVertex) touched_[v.index()] = clock_;
        if (!judge_.counts(t) || is_surely_good(t)) continue;
        if (const double cosine = badness_of(t); cosine > goal_cosine_ && !is_left_alone(t)) push(t, cosine);
    }
}

/// What an acute angle of the input forces is given its chance to move, but no splits: they would not end.
bool ShapeImprover::is_left_alone(TetId t) const { return leaves_forced_ && refiner_.forced_by(t).has_value(); }

void ShapeImprover::leave_forced_alone() {
    leaves_forced_ = true;
    if (refiner_.knows_forced()) mover_.excuses = [this](TetId t) { return judge_.keeps_size(t) && is_left_alone(t); };
    std::erase_if(left_, [&](const Bad& b) {
        const TetId t = find_tet(mesh_, b.corners);
        return !t.valid() || is_left_alone(t);
    });
}

/// @return is the tetrahedron gone, or not to be tried now? If not, it is left over.
bool ShapeImprover::mend(const Bad& bad, unsigned samples, LastResort last_resort) {
    std::uint64_t last_change = 0;
    for (const VertexId v : bad.corners) last_change = std::max(last_change, touched_[v.index()]);
    const std::uint64_t key = key_of(bad.corners);
    if (const auto known = stuck_.find(key); known != stuck_.end()) {
        Stuck& before = known->second;
        if (before.pass == pass_) return true;  // listed already; changes around it are for the next pass
        if (before.when < last_change) before.failures = 0;
        if (before.failures >= kTriesUntouched) {
            before.pass = pass_;
            return false;
        }
    }
    const Corners order = freest_first(mesh_, bad.corners);
    for (const VertexId v : order) {
        if (mesh_.info(v).carrier == CarrierKind::input_vertex) continue;
        Tried& tried = tried_[v.index()];
        if (tried.when < touched_[v.index()]) tried = {};
        if (tried.failures >= kTriesUntouched || (tried.failures > 0 && tried.pass == pass_)) continue;
        const TetId t = find_tet(mesh_, bad.corners);
        if (!t.valid()) return true;
        if (mover_.move(v, t, goal_cosine_, samples)) {
            touch(mover_.changed());
            return true;
        }
        tried = {clock_, pass_, tried.failures + 1};
    }
    Stuck& stuck = stuck_[key];
    if (last_resort != LastResort::none && stuck.last_resorts < kTriesInAll) {
        ++stuck.last_resorts;
        for (const VertexId v : order)
            if (last_resort == LastResort::remove_or_insert && mover_.remove(v, goal_cosine_)) {
                touch(mover_.changed());
                return true;
            }
        if (const TetId t = find_tet(mesh_, bad.corners); t.valid() && insertion_.insert(t, bad.badness - kWorthwhile).valid()) {
            touch(insertion_.changed());
            return true;
        }
    }
    stuck.when = clock_;
    stuck.pass = pass_;
    ++stuck.failures;
    return false;
}

/// Tries to mend every bad tetrahedron once, and those that this makes; what can't be mended is in left_ afterwards.
RunGuard::Verdict ShapeImprover::pass(unsigned samples, LastResort last_resort) {
    ++pass_;
    touched_.resize(std::max(touched_.size(), mesh_.vertex_slots()), 0);
    tried_.resize(touched_.size());
    heap_.insert(heap_.end(), left_.begin(), left_.end());
    left_.clear();
    std::make_heap(heap_.begin(), heap_.end(), IsLater{});
    while (!heap_.empty()) {
        std::pop_heap(heap_.begin(), heap_.end(), IsLater{});
        Bad bad = heap_.back();
        heap_.pop_back();
        const TetId t = find_tet(mesh_, bad.corners);
        if (!t.valid()) continue;
        bad.badness = badness_of(t);  // its corners may have moved since
        if (bad.badness <= goal_cosine_) continue;
        const RunGuard::Verdict verdict = guard_.poll(mesh_.vertex_count(), mesh_.tets().live(), heap_.size() + 1);
        if (verdict != RunGuard::Verdict::go_on) return verdict;
        if (!mend(bad, samples, last_resort)) left_.push_back(bad);
    }
    // Neighbours may have mended some of them since; a tetrahedron may be listed twice.
    std::erase_if(left_, [&](Bad& b) {
        const TetId t = find_tet(mesh_, b.corners);
        if (!t.valid()) return true;
        b.badness = badness_of(t);
        return b.badness <= goal_cosine_;
    });
    return RunGuard::Verdict::go_on;
}

/// Passes until nothing is bad or fewer do not get.
RunGuard::Verdict ShapeImprover::passes(unsigned samples, unsigned most, LastResort last_resort) {
    std::size_t before = left_.size() + heap_.size();
    for (unsigned p = 0; p < most && before > 0; ++p) {
        const RunGuard::Verdict verdict = pass(samples, last_resort);
        if (verdict != RunGuard::Verdict::go_on) return verdict;
        if (!worth_it(before, left_.size())) break;
        before = left_.size();
    }
    return RunGuard::Verdict::go_on;
}

/// Moves the vertices near bad tetrahedra to their optimal-Delaunay points, once each.
RunGuard::Verdict ShapeImprover::smooth_around_bad(unsigned rings) {
    marked_.resize(std::max(marked_.size(), mesh_.vertex_slots()), 0);
    const std::uint64_t stamp = ++clock_;
    around_.clear();
    const auto take = [&](VertexId v) {
        if (v == kInfiniteVertex || marked_[v.index()] == stamp) return;
        marked_[v.index()] = stamp;
        around_.push_back(v);
    };
    for (const Bad& b : left_)
        if (stuck_[key_of(b.corners)].smoothings++ < kTriesInAll)
            for (const VertexId v : b.corners) take(v);
    std::size_t done = 0;
    for (unsigned r = 0; r < rings; ++r)
        for (const std::size_t end = around_.size(); done < end; ++done) {
            mesh_.triangulation().find_star(around_[done], star_);
            for (const TetId t : star_)
                if (judge_.counts(t))
                    for (const VertexId w : mesh_.tets().corners(t)) take(w);
        }
    const double floor = std::cos(kSmoothingFloor * std::acos(goal_cosine_));
    for (const VertexId v : around_) {
        const RunGuard::Verdict verdict = guard_.poll(mesh_.vertex_count(), mesh_.tets().live(), left_.size());
        if (verdict != RunGuard::Verdict::go_on) return verdict;
        if (mover_.smooth(v, floor)) touch(mover_.changed());
    }
    return RunGuard::Verdict::go_on;
}

/// All that moves can do, then what single removals and insertions can.
RunGuard::Verdict ShapeImprover::settle(LastResort last_resort) {
    RunGuard::Verdict verdict = passes(kMoveSamples, 1, LastResort::none);
    if (verdict == RunGuard::Verdict::go_on) verdict = passes(kPatientMoveSamples, kPatientPasses, LastResort::none);
    for (unsigned r = 0; r < kSmoothingRounds && !left_.empty() && verdict == RunGuard::Verdict::go_on; ++r) {
        const std::size_t before = left_.size();
        verdict = smooth_around_bad(1);
        if (verdict == RunGuard::Verdict::go_on) verdict = passes(kPatientMoveSamples, kPatientPasses, LastResort::none);
        if (!worth_it(before, left_.size())) break;
    }
    if (!left_.empty() && verdict == RunGuard::Verdict::go_on) verdict = passes(kPatientMoveSamples, kPatientPasses, last_resort);
    return verdict;
}

/// Splits what is worse than this: of neighbours only the worst, as moves may mend the others then.
RunGuard::Verdict ShapeImprover::split_worse_than(double cosine) {
    std::sort(left_.begin(), left_.end(), [](const Bad& a, const Bad& b) { return b < a; });
    marked_.resize(std::max(marked_.size(), mesh_.vertex_slots()), 0);
    const std::uint64_t stamp = ++clock_;
    const std::size_t first_new = mesh_.vertex_slots();
    for (const Bad& b : left_) {
        if (b.badness <= cosine) break;
        if (given_up_.contains(key_of(b.corners))) continue;
        if (std::any_of(b.corners.begin(), b.corners.end(), [&](VertexId v) { return marked_[v.index()] == stamp; })) continue;
        const TetId t = find_tet(mesh_, b.corners);
        if (!t.valid()) continue;
        for (const VertexId v : b.corners) marked_[v.index()] = stamp;
        ++splits_;
        splitting_ = key_of(b.corners);
        const RunGuard::Verdict verdict = refiner_.split(t, InsertionReason::sliver);
        if (verdict != RunGuard::Verdict::go_on) return verdict;
    }
    for (std::size_t v = first_new; v < mesh_.vertex_slots(); ++v) {
        if (!mesh_.triangulation().is_inserted(VertexId{v})) continue;
        mesh_.triangulation().find_star(VertexId{v}, star_);
        touch(star_);
    }
    collect_bad();
    return RunGuard::Verdict::go_on;
}

/// The same, but a split that sets off a cascade at acute input, which ends at the algorithm's ceiling or where segments can't be split any further, is
/// undone with all others since `last`; they are tried again, but for that one.
RunGuard::Verdict ShapeImprover::split_or_go_back(double cosine, const ConformingMesh& last) {
    for (unsigned cascades = 0; cascades < kMostCascades; ++cascades) {
        RunGuard::Verdict verdict = RunGuard::Verdict::out_of_vertices;
        try {
            verdict = split_worse_than(cosine);
        } catch (const MeshError& e) {
            if (e.code() != ErrorCode::budget_exhausted) throw;
        }
        if (verdict != RunGuard::Verdict::out_of_vertices || guard_.user_limit_spent()) return verdict;
        given_up_.insert(splitting_);
        mesh_ = last;
        refiner_.forget_waiting();
        collect_bad();
    }
    return RunGuard::Verdict::go_on;
}

/// Splits and moves until nothing is worse than this rung of the ladder.
RunGuard::Verdict ShapeImprover::climb(double rung_cosine, std::size_t vertices_at_start, bool& reached) {
    const auto is_below = [&](const Bad& b) { return b.badness > rung_cosine && !given_up_.contains(key_of(b.corners)); };
    const auto below = [&] { return std::any_of(left_.begin(), left_.end(), is_below); };
    std::optional<ConformingMesh> last;
    double last_worst = 0;
    std::size_t last_left = 0;
    RunGuard::Verdict verdict = RunGuard::Verdict::go_on;
    for (unsigned round = 0; below() && verdict == RunGuard::Verdict::go_on; ++round) {
        const bool spent = static_cast<double>(mesh_.vertex_count()) > kVertexBudget * static_cast<double>(vertices_at_start) + kVertexAllowance;
        if (spent || round == kSplitRounds || (!last && !guard_.can_double())) break;
        if (!last) {
            last = mesh_;
            last_worst = worst_cosine();
            last_left = left_.size();
        }
        verdict = split_or_go_back(rung_cosine, *last);
        if (verdict == RunGuard::Verdict::go_on) verdict = settle(round < kRemovalRounds ? LastResort::remove_or_insert : LastResort::insert);
    }
    reached = !below();
    if (reached) return verdict;
    // Beside what an acute angle forces some tetrahedra stay for ever, which says nothing about the others.
    const bool by_number = refiner_.knows_forced();
    const bool no_better = by_number ? last_left <= left_.size() : last_worst <= worst_cosine();
    if (last && (no_better || guard_.has_too_many(mesh_.vertex_count()))) {
        mesh_ = std::move(*last);
        collect_bad();
    }
    if (by_number) {
        for (const Bad& b : left_)
            if (b.badness > rung_cosine) given_up_.insert(key_of(b.corners));
        reached = true;
    }
    return verdict;
}

RunGuard::Verdict ShapeImprover::perturb(double angle_deg) {
    RunGuard::Verdict verdict = RunGuard::Verdict::go_on;
    mover_.follow_gradients(true);
    // Then from below, as in [Tournois09]: where a rung can't be reached, no higher one is worth its time.
    for (double rung = std::min(kFirstRungDeg, angle_deg);; rung = std::min(rung + kRungDeg, angle_deg)) {
        goal_cosine_ = cosine_of_degrees(rung);
        judge_.set_goal(goal_cosine_, TetJudge::kNoAspect);
        stuck_.clear();
        tried_.assign(tried_.size(), {});
        collect_bad();
        verdict = settle(LastResort::none);
        if (verdict != RunGuard::Verdict::go_on || !left_.empty() || rung == angle_deg) break;
    }
    mover_.follow_gradients(false);
    return verdict;
}

/// What no rung mended beside an acute angle, with more of its surroundings moved, and then split.
RunGuard::Verdict ShapeImprover::try_afresh() {
    RunGuard::Verdict verdict = RunGuard::Verdict::go_on;
    mover_.move_beside_excused(true);
    given_up_.clear();
    for (unsigned r = 0; r < kLastTries && !left_.empty() && verdict == RunGuard::Verdict::go_on; ++r) {
        stuck_.clear();
        tried_.assign(tried_.size(), {});
        verdict = smooth_around_bad(2);
        if (verdict == RunGuard::Verdict::go_on) verdict = passes(kPatientMoveSamples << (r + 1), kPatientPasses, LastResort::remove_or_insert);
        if (verdict != RunGuard::Verdict::go_on || left_.empty() || !guard_.can_double()) continue;
        const ConformingMesh last = mesh_;
        const std::size_t before = left_.size();
        verdict = split_or_go_back(goal_cosine_, last);
        if (verdict == RunGuard::Verdict::go_on) verdict = settle(LastResort::insert);
        if (left_.size() < before && !guard_.has_too_many(mesh_.vertex_count())) continue;
        mesh_ = last;
        collect_bad();
        if (verdict == RunGuard::Verdict::go_on) verdict = grade_afresh();
    }
    mover_.move_beside_excused(false);
    return verdict;
}

/// All there is, straight at one angle.
RunGuard::Verdict ShapeImprover::aim_at(double angle_deg, std::size_t vertices_at_start) {
    goal_cosine_ = cosine_of_degrees(angle_deg);
    judge_.set_goal(goal_cosine_, angle_deg >= kAspectFromDeg ? kMaxAspect : TetJudge::kNoAspect);
    stuck_.clear();
    tried_.assign(tried_.size(), {});
    collect_bad();
    given_up_.clear();
    leaves_forced_ = false;
    mover_.excuses = {};
    RunGuard::Verdict verdict = settle(LastResort::remove_or_insert);
    leave_forced_alone();
    bool reached = true;
    for (double rung = kRungDeg; verdict == RunGuard::Verdict::go_on && reached && !left_.empty() && rung < angle_deg + kRungDeg; rung += kRungDeg)
        verdict = climb(cosine_of_degrees(std::min(rung, angle_deg)), vertices_at_start, reached);
    if (refiner_.knows_forced() && verdict == RunGuard::Verdict::go_on) verdict = try_afresh();
    if (!left_.empty() && verdict == RunGuard::Verdict::go_on) verdict = rescue();
    return verdict;
}

RunGuard::Verdict ShapeImprover::improve(double angle_deg) {
    const std::size_t vertices = mesh_.vertex_count(), slots = mesh_.vertex_slots();
    if (refiner_.knows_forced()) guard_.set_ceiling(kCascadeCeiling * vertices + kCascadeAllowance);
    RunGuard::Verdict verdict = aim_at(std::min(angle_deg, kStraightDeg), vertices);
    // Beyond, most tetrahedra are bad: aiming at all of them at once spends its time on the many and leaves the worst. What a rung has reached is
    // kept if the next one ends lower, out of reach or out of time.
    for (double rung = kStraightDeg; verdict == RunGuard::Verdict::go_on && left_.empty() && rung < angle_deg && guard_.can_double();) {
        rung = std::min(rung + kRungDeg, angle_deg);
        const ConformingMesh last = mesh_;
        const double last_worst = worst_cosine();
        verdict = aim_at(rung, vertices);
        if (worst_cosine() > last_worst) {
            mesh_ = last;
            collect_bad();
        }
    }
    if (verdict == RunGuard::Verdict::go_on && left_.empty()) verdict = thin_out(slots, vertices);
    return verdict;
}

}  // namespace wellmesh
