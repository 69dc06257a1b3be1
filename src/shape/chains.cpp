// SPDX-License-Identifier: Apache-2.0
#include "shape/chains.hpp"

#include <algorithm>
#include <cmath>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "shape/corners.hpp"

namespace wellmesh {
namespace {

constexpr double kRoughFloor = 0.3;           // of the goal: the least angle that the first steps of a chain may leave for moves to mend,
constexpr unsigned kMovesInChain = 12;        // so many of them,
constexpr std::size_t kMostBadInChain = 64;   // if they don't make too many bad tetrahedra themselves
constexpr unsigned kSamplesInChain = 30;
constexpr std::size_t kNearest = 3;           // neighbours that may close up
constexpr double kShove = 0.6;                // of the mean distance of the neighbours

double rough(const TetJudge& judge) { return std::cos(kRoughFloor * std::acos(judge.goal())); }

}  // namespace

/// The vertices of one segment or facet next to v, or of one cell, nearest first.
void Chains::find_neighbours(VertexId v) {
    neighbours_.clear();
    mesh_.triangulation().find_star(v, star_);
    const VertexInfo& mine = mesh_.info(v);
    for (const TetId t : star_) {
        if (!judge_.counts(t)) continue;
        for (const VertexId w : mesh_.tets().corners(t))
            if (w != v && mesh_.info(w).carrier == mine.carrier && mesh_.info(w).carrier_id == mine.carrier_id) neighbours_.push_back(w);
    }
    const Vec3 home = mesh_.point(v);
    const auto distance = [&](VertexId w) { return squared_distance(mesh_.point(w), home); };
    std::sort(neighbours_.begin(), neighbours_.end(), [&](VertexId a, VertexId b) { return distance(a) != distance(b) ? distance(a) < distance(b) : a < b; });
    neighbours_.erase(std::unique(neighbours_.begin(), neighbours_.end()), neighbours_.end());
    if (neighbours_.size() > kNearest) neighbours_.resize(kNearest);
}

bool Chains::misses(TetId t) const { return judge_.counts(t) && judge_.badness(t) > judge_.goal() && !(tolerates && tolerates(t)); }

void Chains::take_note() {
    for (const TetId t : mover_.changed()) {
        if (!mesh_.tets().is_live(t)) continue;
        for (const VertexId v : mesh_.tets().corners(t))
            if (v != kInfiniteVertex) touched_.push_back(v);
        if (misses(t)) bad_.push_back(mesh_.tets().corners(t));
    }
}

/// Are the stars of all touched vertices as good as the goal, and is nothing encroached there?
bool Chains::all_is_well() {
    std::sort(touched_.begin(), touched_.end());
    touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
    for (const VertexId v : touched_) {
        if (!mesh_.triangulation().is_inserted(v)) continue;
        mesh_.triangulation().find_star(v, star_);
        for (const TetId t : star_)
            if (boundary_.has_encroached(t) || misses(t)) return false;
    }
    return true;
}

/// Moves corners of the tetrahedra that the chain has made until none is bad, or not soon enough.
bool Chains::mend() {
    unsigned moves = 0;
    for (std::size_t done = 0; done < bad_.size(); ++done) {  // bad_ grows meanwhile
        const TetStore::Corners corners = bad_[done];
        TetId t = find_tet(mesh_, corners);
        if (!t.valid() || judge_.shape_badness(t) <= judge_.goal()) continue;
        if (++moves > kMovesInChain || bad_.size() > kMostBadInChain) return false;
        bool moved = false;
        for (const VertexId v : freest_first(mesh_, corners)) {
            if (moved || mesh_.info(v).carrier == CarrierKind::input_vertex) break;
            t = find_tet(mesh_, corners);
            moved = mover_.move(v, t, judge_.goal(), kSamplesInChain);
        }
        if (!moved) return false;
        take_note();
    }
    return all_is_well();
}

template <class Chain>
bool Chains::attempt(Chain&& chain) {
    ChangeLog& log = mover_.log();
    bad_.clear();
    touched_.clear();
    log.begin();
    if (chain()) {
        log.keep();
        return true;
    }
    log.undo(mesh_);
    return false;
}

/// Draws a neighbour towards the gap, where nothing may get worse than `limit` before moves mend it.
bool Chains::close_up(VertexId into, const Vec3& home, double limit) {
    if (!mover_.pull(into, home, limit)) return false;
    take_note();
    return mend();
}

bool Chains::dissolve(VertexId v) {
    const double limit = rough(judge_);
    const Vec3 home = mesh_.point(v);
    find_neighbours(v);
    return attempt([&] {
        if (!mover_.drop(v)) return false;
        const bool fits = mover_.fits_without(limit);
        take_note();
        // Most of the time goes into taking v out: once for all that may follow.
        ChangeLog& log = mover_.log();
        const std::size_t steps = log.size();
        bad_before_ = bad_;
        touched_before_ = touched_;
        if (fits && mend()) return true;
        return std::any_of(neighbours_.begin(), neighbours_.end(), [&](VertexId w) {
            log.undo_after(mesh_, steps);
            bad_ = bad_before_;
            touched_ = touched_before_;
            return close_up(w, home, limit);
        });
    });
}

bool Chains::shove(VertexId v, unsigned trials) {
    const double limit = rough(judge_);
    const Vec3 home = mesh_.point(v);
    double length = 0;
    std::size_t edges = 0;
    mesh_.triangulation().find_star(v, star_);
    for (const TetId t : star_)
        if (judge_.counts(t))
            for (const VertexId w : mesh_.tets().corners(t)) {
                length += distance(mesh_.point(w), home);
                ++edges;
            }
    if (edges == 0) return false;
    const double reach = kShove * length / (0.75 * static_cast<double>(edges));  // v is a quarter of the corners
    for (unsigned k = 1; k <= trials; ++k) {
        const Vec3 target = home + reach * picking_point(3, mix64(seed_, v.value()), k);
        if (attempt([&] { return mover_.pull(v, target, limit) && (take_note(), mend()); })) return true;
    }
    return false;
}

}  // namespace wellmesh
