// SPDX-License-Identifier: Apache-2.0
#include "shape/mending.hpp"

#include <algorithm>
#include <unordered_set>

#include "quality/shape_lanes.hpp"
#include "shape/corners.hpp"

namespace wellmesh {
namespace {

constexpr unsigned kTriesUntouched = 3;  // failures after which a tetrahedron rests until its neighbourhood changes
constexpr std::uint32_t kLastTime = 1U << 31;  // of the clock at the begin of a pass
constexpr std::uint64_t kFailures = 200, kFailuresPerMended = 20;  // after which only one in so many is tried of what is mostly stuck:
constexpr std::uint64_t kSample = 16;                               // elsewhere it may fare better
/// To find one by its corners takes as long as a look at so many slots.
constexpr std::size_t kSlotsADoubtful = 16;
constexpr unsigned kTriesInAll = 4;      // smoothings around a tetrahedron, and last resorts, that failed: it waits for a split then

}  // namespace

bool Mending::Patience::allows() { return failed_ < kFailures / sharing_ + kFailuresPerMended * mended_ || ++refused_ % kSample == 0; }

Mending Mending::for_zone(ConformingMesh& view, const TetJudge& judge, VertexMover& mover) {
    fit_arrays();
    Mending out(view, judge, mover);
    out.blocks_ = blocks_;
    out.clock_ = clock_;
    out.pass_ = pass_;
    out.touched_ = touched_.view();
    out.tried_ = tried_.view();
    out.known_ = &stuck_;
    out.most_doubtful_ = most_doubtful_;
    out.goes_beyond_shape = goes_beyond_shape;
    return out;
}

void Mending::join(Mending& zone) {
    clock_ = std::max(clock_, zone.clock_);
    for (const auto& [key, what] : zone.stuck_) stuck_[key] = what;
    for (std::vector<Bad>* const some : {&zone.left_, &zone.heap_, &zone.outside_})
        for (Bad& b : *some) b.is_mostly_stuck = false;  // the whole asks
    left_.insert(left_.end(), zone.left_.begin(), zone.left_.end());
    heap_.insert(heap_.end(), zone.heap_.begin(), zone.heap_.end());
    heap_.insert(heap_.end(), zone.outside_.begin(), zone.outside_.end());
    if (doubtful_.size() <= most_doubtful_) doubtful_.insert(doubtful_.end(), zone.doubtful_.begin(), zone.doubtful_.end());
}

void Mending::fit_arrays() {
    if (touched_.size() >= mesh_.vertex_slots()) return;
    touched_.resize(mesh_.vertex_slots() + 64, 0);
    tried_.resize(touched_.size(), Tried{});
}

/// Null: there has been no failure.
Mending::Stuck* Mending::find_stuck(std::uint64_t key) {
    if (const auto mine = stuck_.find(key); mine != stuck_.end()) return &mine->second;
    if (!known_) return nullptr;
    const auto known = known_->find(key);
    return known != known_->end() ? &stuck_.emplace(key, known->second).first->second : nullptr;
}

bool Mending::may_smooth(const Bad& bad) { return stuck_[key_of(bad.corners)].smoothings++ < kTriesInAll; }

void Mending::begin_anew() {
    stuck_.clear();
    tried_.assign(tried_.size(), Tried{});
}

void Mending::forget_tries() {
    stuck_ = {};
    tried_.release();
    touched_.release();
}

/// Not certainly good: that is found faster than the badness, and says so of most. Only what is doubtful has an excuse, which may end.
bool Mending::is_doubtful(TetId t) const {
    return judge_.counts(t) && !(judge_.is_surely_good(t) && (!goes_beyond_shape || judge_.keeps_radius_edge(t)));
}

bool Mending::is_bad(TetId t, double& how) const {
    if (!is_doubtful(t)) return false;
    how = badness(t);
    return how > judge_.goal();
}

void Mending::note_doubtful(TetId t) {
    if (doubtful_.size() <= most_doubtful_) doubtful_.push_back({mesh_.tets().corners(t), t});
}

Bad Mending::listed(TetId t, double how) const {
    const TetStore::Corners& corners = mesh_.tets().corners(t);
    return {how, corners, t, blocks_.of(mesh_.point(corners[0]))};
}

void Mending::collect(Workers& workers) {
    constexpr std::size_t kGrain = std::size_t{1} << 14;
    const std::size_t slots = mesh_.tets().slots();
    blocks_ = Blocks(mesh_.triangulation().low(), mesh_.triangulation().high(), mesh_.tets().live());
    heap_.clear();
    left_.clear();
    // What goes beyond shape searches the mesh: not for several threads at once. It matters to few.
    std::vector<std::vector<TetId>> suspects((slots + kGrain - 1) / kGrain);
    workers.for_ranges(slots, kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        ShapeBatch<TetId> batch;
        const auto look = [&](TetId t, const SquaredShapes& shapes, std::size_t lane) {
            if (!judge_.is_surely_good(shapes, lane, goes_beyond_shape) && is_doubtful(t)) suspects[piece].push_back(t);
        };
        for (std::size_t i = begin; i < end; ++i) {
            const TetId t{i};
            if (!judge_.counts(t)) continue;
            const TetStore::Corners& c = mesh_.tets().corners(t);
            batch.add(t, mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]), look);
        }
        batch.finish(look);
    });
    ++collections_;
    doubtful_.clear();
    most_doubtful_ = slots / kSlotsADoubtful;
    for (const std::vector<TetId>& piece : suspects)
        for (const TetId t : piece) {
            note_doubtful(t);
            if (const double how = badness(t); how > judge_.goal()) left_.push_back(listed(t, how));
        }
}

void Mending::collect_again(Workers& workers) {
    if (doubtful_.size() > most_doubtful_) return collect(workers);
    heap_.clear();
    left_.clear();
    // Who went back to a savepoint took numbers of vertices away.
    const auto is_vertex = [&](VertexId v) { return v.index() < mesh_.vertex_slots(); };
    std::erase_if(doubtful_, [&](const Doubtful& d) { return !std::all_of(d.corners.begin(), d.corners.end(), is_vertex); });
    double how = 0;
    for (const Doubtful& d : doubtful_)
        if (const TetId t = find_tet(mesh_, d.corners, d.last); t.valid() && is_bad(t, how)) left_.push_back(listed(t, how));
    std::sort(left_.begin(), left_.end(), [](const Bad& a, const Bad& b) { return a.last < b.last; });
    left_.erase(std::unique(left_.begin(), left_.end(), [](const Bad& a, const Bad& b) { return a.last == b.last; }), left_.end());
}

void Mending::note(const std::vector<TetId>& tets) {
    for (const TetId t : tets)
        if (mesh_.tets().is_live(t) && is_doubtful(t)) note_doubtful(t);
}

void Mending::collect_touched() {
    left_.insert(left_.end(), heap_.begin(), heap_.end());
    heap_.clear();
    end_pass();
}

void Mending::touch(const std::vector<TetId>& tets) {
    fit_arrays();
    ++clock_;
    double how = 0;
    for (const TetId t : tets) {
        if (!mesh_.tets().is_live(t)) continue;
        for (const VertexId v : mesh_.tets().corners(t))
            if (v != kInfiniteVertex) touched_[v.index()] = clock_;
        if (!is_doubtful(t)) continue;
        note_doubtful(t);
        if (how = badness(t); how <= judge_.goal()) continue;
        heap_.push_back(listed(t, how));
        std::push_heap(heap_.begin(), heap_.end(), IsLater{});
    }
}

void Mending::begin_pass() {
    ++pass_;
    if (clock_ > kLastTime) {
        forget_tries();
        clock_ = 0;
    }
    fit_arrays();
    heap_.insert(heap_.end(), left_.begin(), left_.end());
    left_.clear();
}

bool Mending::pass(unsigned samples, const MayGoOn& may_go_on) {
    Patience patience(sharing);
    std::make_heap(heap_.begin(), heap_.end(), IsLater{});
    while (!heap_.empty()) {
        std::pop_heap(heap_.begin(), heap_.end(), IsLater{});
        Bad bad = heap_.back();
        heap_.pop_back();
        mesh_.triangulation().forget_leaving();
        const TetId t = find_tet(mesh_, bad.corners, bad.last);
        if (mesh_.triangulation().left_zone() || (t.valid() && must_wait && must_wait(t))) {
            outside_.push_back(bad);
            continue;
        }
        if (!t.valid()) continue;
        bad.badness = badness(t);  // its corners may have moved since
        if (bad.badness <= judge_.goal()) continue;
        if (!may_go_on(heap_.size() + 1)) {
            heap_.push_back(bad);
            return false;
        }
        const bool is_stuck = is_mostly_stuck ? is_mostly_stuck(t) : bad.is_mostly_stuck;
        if (is_stuck && !patience.allows()) {
            left_.push_back(bad);
            continue;
        }
        const Outcome outcome = mend(bad, samples);
        if (is_stuck && outcome != Outcome::not_now) patience.note(outcome == Outcome::done);
        if (outcome == Outcome::failed) left_.push_back(bad);
        if (outcome == Outcome::left_zone) outside_.push_back(bad);
    }
    return true;
}

void Mending::end_pass() {
    std::unordered_set<std::uint64_t> listed;  // by corners
    std::erase_if(left_, [&](Bad& b) {
        const TetId t = find_tet(mesh_, b.corners, b.last);
        if (!t.valid() || !listed.insert(key_of(b.corners)).second) return true;
        b.badness = badness(t);
        return b.badness <= judge_.goal();
    });
}

/// Done: the tetrahedron is gone.
Mending::Outcome Mending::mend(const Bad& bad, unsigned samples) {
    std::uint32_t last_change = 0;
    for (const VertexId v : bad.corners) last_change = std::max(last_change, touched_[v.index()]);
    const std::uint64_t key = key_of(bad.corners);
    if (Stuck* const before = find_stuck(key)) {
        if (before->pass == pass_) return Outcome::not_now;  // listed already; changes around it are for the next pass
        if (before->when < last_change) before->failures = 0;
        if (before->failures >= kTriesUntouched) {
            before->pass = pass_;
            return Outcome::failed;
        }
    }
    const TetStore::Corners order = freest_first(mesh_, bad.corners);
    for (const VertexId v : order) {
        if (mesh_.info(v).carrier == CarrierKind::input_vertex) continue;
        Tried& tried = tried_[v.index()];
        if (tried.when < touched_[v.index()]) tried = {};
        if (tried.failures >= kTriesUntouched || (tried.failures > 0 && tried.pass == pass_)) continue;
        const TetId t = find_tet(mesh_, bad.corners, bad.last);
        if (t.valid() && mover_.move(v, t, judge_.goal(), samples)) {
            touch(mover_.changed());
            return Outcome::done;
        }
        if (mesh_.triangulation().left_zone()) return Outcome::left_zone;
        if (!t.valid()) return Outcome::done;
        tried = {clock_, pass_, tried.failures + 1};
    }
    Stuck& stuck = stuck_[key];
    if (last_resort && stuck.last_resorts < kTriesInAll) {
        if (last_resort(bad, order)) return Outcome::done;
        if (mesh_.triangulation().left_zone()) return Outcome::left_zone;
        ++stuck.last_resorts;
    }
    stuck.when = clock_;
    stuck.pass = pass_;
    ++stuck.failures;
    return Outcome::failed;
}

bool Mending::smooth(const std::vector<VertexId>& vertices, double floor, std::vector<VertexId>& waiting, const MayGoOn& may_go_on) {
    for (const VertexId v : vertices) {
        if (!may_go_on(left_.size())) return false;
        mesh_.triangulation().forget_leaving();
        if (mover_.smooth(v, floor)) touch(mover_.changed());
        else if (mesh_.triangulation().left_zone()) waiting.push_back(v);
    }
    return true;
}

}  // namespace wellmesh
