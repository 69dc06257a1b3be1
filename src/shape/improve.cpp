// SPDX-License-Identifier: Apache-2.0
#include "shape/improve.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "shape/corners.hpp"

namespace wellmesh {
namespace {
constexpr unsigned kMoveSamples = 30, kPatientMoveSamples = 60;
constexpr unsigned kPatientPasses = 2;    // smoothing and splitting come after: they take longer for each that they mend
constexpr unsigned kSmoothingRounds = 2;
constexpr double kFewLeft = 0.05;         // part of the bad tetrahedra: if no more are left, smoothing goes for those, too, that acute angles force
constexpr double kWorthRepeating = 0.85;  // part of the bad tetrahedra that may be left for another pass or smoothing to be tried
constexpr unsigned kSplitRounds = 16;     // on one rung,
constexpr unsigned kRemovalRounds = 3;    // of which later ones take nothing out again, else removals and splits may undo each other for ever
constexpr double kVertexBudget = 1.5;     // splits may not add more than half the vertices again,
constexpr std::size_t kVertexAllowance = 100;  // and so many on small meshes
constexpr std::uint64_t kCascadeCeiling = 2, kCascadeAllowance = 10000;  // beyond the budget; more is a cascade beside an acute angle
constexpr std::size_t kManyTets = 200000; // of a mesh that is not looked at as a whole after each round of splits
constexpr unsigned kMostCascades = 16;    // that are undone, one tetrahedron each given up, before a round of splits is
constexpr unsigned kLastTries = 5;
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

/// Repairs of facets may give tetrahedra that are as they were another cell.
class NotingRepairs {
public:
    NotingRepairs(BoundaryRefiner& boundary, Mending& mending) : hook_(boundary.on_repair), before_(hook_) {
        hook_ = [this, &mending](const std::vector<TetId>& tets) {
            mending.note(tets);
            if (before_) before_(tets);
        };
    }
    ~NotingRepairs() { hook_ = std::move(before_); }
    NotingRepairs(const NotingRepairs&) = delete;
    NotingRepairs& operator=(const NotingRepairs&) = delete;

private:
    std::function<void(const std::vector<TetId>&)>& hook_;
    std::function<void(const std::vector<TetId>&)> before_;
};

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
    if (!refiner_.may_excuse() || judge_.keeps_radius_edge(t) || refiner_.excuses(t)) return shape;
    return kNoAngleCosine;
}

/// For marks that no vertex has yet.
std::uint32_t ShapeImprover::new_stamp() {
    if (++stamp_ == 0) {
        marked_.clear();
        stamp_ = 1;
    }
    marked_.resize(std::max(marked_.size(), mesh_.vertex_slots()), 0);
    return stamp_;
}

/// What an acute angle of the input forces is given its chance to move, but no splits: they would not end. What is in a gap has none.
bool ShapeImprover::is_left_alone(TetId t) const { return leaves_forced_ ? refiner_.excuses(t) : refiner_.is_in_gap(t); }

void ShapeImprover::leave_forced_alone() {
    leaves_forced_ = true;
    if (refiner_.may_excuse()) mover_.excuses = [this](TetId t) { return judge_.keeps_size(t) && is_left_alone(t); };
    std::erase_if(left(), [&](const Bad& b) {
        const TetId t = find_tet(mesh_, b.corners, b.last);
        return !t.valid() || is_left_alone(t);
    });
}

/// Tries to mend every bad tetrahedron once, and those that this makes.
RunGuard::Verdict ShapeImprover::pass(unsigned samples, LastResort last_resort) {
    RunGuard::Verdict verdict = RunGuard::Verdict::go_on;
    mending_.begin_pass();
    mending_.last_resort = {};
    mending_.is_mostly_stuck = {};
    if (!leaves_forced_ && refiner_.may_excuse()) mending_.is_mostly_stuck = [this](TetId t) { return refiner_.excuses(t); };
    // What an acute angle forces is for the whole mesh.
    if (!leaves_forced_ && !refiner_.gaps().any()) verdict = zones_.mend(samples, last_resort);
    if (verdict != RunGuard::Verdict::go_on) return verdict;
    if (last_resort != LastResort::none)
        mending_.last_resort = [this, last_resort](const Bad& bad, const Corners& order) {
            return try_last_resort(last_resort, mesh_, mover_, insertion_, mending_, judge_, bad, order);
        };
    const auto may_go_on = [&](std::size_t waiting) {
        verdict = guard_.poll(mesh_.vertex_count(), mesh_.tets().live(), waiting);
        return verdict == RunGuard::Verdict::go_on;
    };
    if (mending_.pass(samples, may_go_on)) mending_.end_pass();
    return verdict;
}

/// Passes until nothing is bad or fewer do not get.
RunGuard::Verdict ShapeImprover::passes(unsigned samples, unsigned most, LastResort last_resort) {
    std::size_t before = mending_.count();
    for (unsigned p = 0; p < most && before > 0; ++p) {
        const RunGuard::Verdict verdict = pass(samples, last_resort);
        if (verdict != RunGuard::Verdict::go_on) return verdict;
        if (!worth_it(before, left().size())) break;
        before = left().size();
    }
    return RunGuard::Verdict::go_on;
}

/// Moves the vertices near bad tetrahedra to their optimal-Delaunay points, once each.
RunGuard::Verdict ShapeImprover::smooth_around_bad(unsigned rings) {
    std::vector<VertexId> around;
    const std::uint32_t stamp = new_stamp();
    const auto take = [&](VertexId v) {
        if (v == kInfiniteVertex || marked_[v.index()] == stamp) return;
        marked_[v.index()] = stamp;
        around.push_back(v);
    };
    for (const Bad& b : left())
        if (mending_.may_smooth(b))
            for (const VertexId v : b.corners) take(v);
    std::size_t done = 0;
    for (unsigned r = 0; r < rings; ++r)
        for (const std::size_t end = around.size(); done < end; ++done) {
            mesh_.triangulation().find_star(around[done], star_);
            for (const TetId t : star_)
                if (judge_.counts(t))
                    for (const VertexId w : mesh_.tets().corners(t)) take(w);
        }
    const double floor = std::cos(kSmoothingFloor * std::acos(judge_.goal()));
    RunGuard::Verdict verdict = leaves_forced_ || refiner_.gaps().any() ? RunGuard::Verdict::go_on : zones_.smooth(around, floor);
    if (verdict != RunGuard::Verdict::go_on) return verdict;
    std::vector<VertexId> none;
    (void)mending_.smooth(around, floor, none, [&](std::size_t waiting) {
        verdict = guard_.poll(mesh_.vertex_count(), mesh_.tets().live(), waiting);
        return verdict == RunGuard::Verdict::go_on;
    });
    return verdict;
}

/// Moves, then more of them, and single removals and insertions where they fail.
RunGuard::Verdict ShapeImprover::try_each(LastResort last_resort) {
    const RunGuard::Verdict verdict = passes(kMoveSamples, 1, LastResort::none);
    return verdict == RunGuard::Verdict::go_on ? passes(kPatientMoveSamples, kPatientPasses, last_resort) : verdict;
}

/// The same, and again around what is left, smoothed.
RunGuard::Verdict ShapeImprover::settle(LastResort last_resort) {
    RunGuard::Verdict verdict = try_each(last_resort);
    for (unsigned r = 0; r < kSmoothingRounds && !left().empty() && verdict == RunGuard::Verdict::go_on; ++r) {
        const std::size_t before = left().size();
        verdict = smooth_around_bad(1);
        if (verdict == RunGuard::Verdict::go_on) verdict = passes(kPatientMoveSamples, kPatientPasses, last_resort);
        if (!worth_it(before, left().size())) break;
    }
    return verdict;
}

/// Splits what is worse than this: of neighbours only the worst, as moves may mend the others then.
RunGuard::Verdict ShapeImprover::split_worse_than(double cosine) {
    const NotingRepairs noting(boundary_, mending_);
    std::sort(left().begin(), left().end(), [](const Bad& a, const Bad& b) { return b < a; });
    const std::uint32_t stamp = new_stamp();
    const std::size_t first_new = mesh_.vertex_slots();
    for (const Bad& b : left()) {
        if (b.badness <= cosine) break;
        if (given_up_.contains(key_of(b.corners))) continue;
        if (std::any_of(b.corners.begin(), b.corners.end(), [&](VertexId v) { return marked_[v.index()] == stamp; })) continue;
        const TetId t = find_tet(mesh_, b.corners, b.last);
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
        mending_.touch(star_);
    }
    // A round splits few: on a large mesh looking at all of it would take longer than everything else. An excuse may end nearby without
    // a touch: the rung's end sees that.
    if (mesh_.tets().live() > kManyTets) mending_.collect_touched();
    else mending_.collect(workers_);
    return RunGuard::Verdict::go_on;
}

/// The same, but a split that sets off a cascade at acute input, which ends at the algorithm's ceiling or where segments can't be split any further, is
/// undone with all others since `last`; they are tried again, but for that one.
RunGuard::Verdict ShapeImprover::split_or_go_back(double cosine, Retreat& last) {
    for (unsigned cascades = 0; cascades < kMostCascades; ++cascades) {
        RunGuard::Verdict verdict = RunGuard::Verdict::out_of_vertices;
        try {
            verdict = split_worse_than(cosine);
        } catch (const MeshError& e) {
            if (e.code() != ErrorCode::budget_exhausted) throw;
        }
        if (verdict != RunGuard::Verdict::out_of_vertices || guard_.user_limit_spent()) return verdict;
        given_up_.insert(splitting_);
        last.go_back();
        refiner_.forget_waiting();
        last.collect(workers_);
    }
    return RunGuard::Verdict::go_on;
}

/// Splits and moves until nothing is worse than this rung of the ladder.
RunGuard::Verdict ShapeImprover::climb(double rung_cosine, std::size_t vertices_at_start, bool& reached) {
    const auto is_below = [&](const Bad& b) { return b.badness > rung_cosine && !given_up_.contains(key_of(b.corners)); };
    const auto below = [&] { return std::any_of(left().begin(), left().end(), is_below); };
    // Beside what an acute angle forces some tetrahedra stay for ever, which says nothing about the others.
    const bool by_number = refiner_.may_excuse();
    std::optional<Retreat> last;
    double last_worst = 0;
    std::size_t last_left = 0;
    RunGuard::Verdict verdict = RunGuard::Verdict::go_on;
    for (unsigned round = 0; below() && verdict == RunGuard::Verdict::go_on; ++round) {
        const bool spent = static_cast<double>(mesh_.vertex_count()) > kVertexBudget * static_cast<double>(vertices_at_start) + kVertexAllowance;
        if (spent || round == kSplitRounds || (!last && !guard_.can_double())) break;
        if (!last) {
            last.emplace(mesh_, mending_);
            if (!by_number) last_worst = worst_cosine();
            last_left = left().size();
        }
        verdict = split_or_go_back(rung_cosine, *last);
        if (verdict == RunGuard::Verdict::go_on) verdict = settle(round < kRemovalRounds ? LastResort::remove_or_insert : LastResort::insert);
    }
    // A split that the guard stopped is told to nobody.
    if (last && verdict != RunGuard::Verdict::go_on) mending_.collect(workers_);
    else if (last && mesh_.tets().live() > kManyTets) mending_.collect_again(workers_);
    reached = !below();
    if (reached) return verdict;
    const bool no_better = by_number ? last_left <= left().size() : last_worst <= worst_cosine();
    if (last && (no_better || guard_.has_too_many(mesh_.vertex_count()))) {
        last->go_back();
        last->collect(workers_);
    }
    if (by_number) {
        for (const Bad& b : left())
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
        judge_.set_goal(cosine_of_degrees(rung), TetJudge::kNoAspect);
        mending_.begin_anew();
        mending_.collect(workers_);
        verdict = settle(LastResort::none);
        if (verdict != RunGuard::Verdict::go_on || !left().empty() || rung == angle_deg) break;
    }
    mover_.follow_gradients(false);
    return verdict;
}

/// What no rung mended beside an acute angle, with more of its surroundings moved, and then split.
RunGuard::Verdict ShapeImprover::try_afresh() {
    RunGuard::Verdict verdict = RunGuard::Verdict::go_on;
    mover_.move_beside_excused(true);
    given_up_.clear();
    for (unsigned r = 0; r < kLastTries && !left().empty() && verdict == RunGuard::Verdict::go_on; ++r) {
        mending_.begin_anew();
        verdict = smooth_around_bad(2);
        if (verdict == RunGuard::Verdict::go_on) verdict = passes(kPatientMoveSamples << (r + 1), kPatientPasses, LastResort::remove_or_insert);
        if (verdict != RunGuard::Verdict::go_on || left().empty() || !guard_.can_double()) continue;
        Retreat last(mesh_, mending_);
        const std::size_t before = left().size();
        verdict = split_or_go_back(judge_.goal(), last);
        if (verdict == RunGuard::Verdict::go_on) verdict = settle(LastResort::insert);
        // A few less now and then is luck, and leaves what only another grading can do to the next try.
        if (worth_it(before, left().size()) && !guard_.has_too_many(mesh_.vertex_count())) continue;
        last.go_back();
        last.collect(workers_);
        if (verdict == RunGuard::Verdict::go_on) verdict = grade_afresh();
    }
    mover_.move_beside_excused(false);
    return verdict;
}

/// All there is, straight at one angle.
RunGuard::Verdict ShapeImprover::aim_at(double angle_deg, std::size_t vertices_at_start) {
    judge_.set_goal(cosine_of_degrees(angle_deg), angle_deg >= kAspectFromDeg ? kMaxAspect : TetJudge::kNoAspect);
    mending_.begin_anew();
    mending_.collect(workers_);
    given_up_.clear();
    leaves_forced_ = false;
    mover_.excuses = {};
    RunGuard::Verdict verdict = RunGuard::Verdict::go_on;
    if (refiner_.may_excuse()) {
        const std::size_t at_first = left().size();
        verdict = try_each(LastResort::remove_or_insert);  // what an acute angle forces, too: mostly little of it is to be mended
        if (static_cast<double>(left().size()) > kFewLeft * static_cast<double>(at_first)) leave_forced_alone();
    }
    if (verdict == RunGuard::Verdict::go_on) verdict = settle(LastResort::remove_or_insert);
    leave_forced_alone();
    bool reached = true;
    for (double rung = kRungDeg; verdict == RunGuard::Verdict::go_on && reached && !left().empty() && rung < angle_deg + kRungDeg; rung += kRungDeg)
        verdict = climb(cosine_of_degrees(std::min(rung, angle_deg)), vertices_at_start, reached);
    if (refiner_.may_excuse() && verdict == RunGuard::Verdict::go_on) verdict = try_afresh();
    if (!left().empty() && verdict == RunGuard::Verdict::go_on) verdict = rescue();
    return verdict;
}

RunGuard::Verdict ShapeImprover::improve(double angle_deg) {
    const std::size_t vertices = mesh_.vertex_count(), slots = mesh_.vertex_slots();
    mesh_.forget_spare_vertices();  // thinning tells by their ids which vertices are new
    if (refiner_.may_excuse()) guard_.set_ceiling(kCascadeCeiling * vertices + kCascadeAllowance);
    RunGuard::Verdict verdict = aim_at(std::min(angle_deg, kStraightDeg), vertices);
    // Beyond, most tetrahedra are bad: aiming at all of them at once spends its time on the many and leaves the worst. What a rung has reached is
    // kept if the next one ends lower, out of reach or out of time.
    for (double rung = kStraightDeg; verdict == RunGuard::Verdict::go_on && left().empty() && rung < angle_deg && guard_.can_double();) {
        rung = std::min(rung + kRungDeg, angle_deg);
        Savepoint last(mesh_);
        const double last_worst = worst_cosine();
        verdict = aim_at(rung, vertices);
        if (worst_cosine() > last_worst) {
            last.go_back();
            mending_.collect(workers_);
        }
    }
    if (verdict == RunGuard::Verdict::go_on && left().empty()) verdict = thin_out(slots, vertices);
    return verdict;
}

}  // namespace wellmesh
