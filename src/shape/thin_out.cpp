// SPDX-License-Identifier: Apache-2.0
#include "shape/thin_out.hpp"

#include <algorithm>
#include <cmath>

#include "core/vec3_math.hpp"
#include "shape/corners.hpp"

namespace wellmesh {
namespace {

constexpr double kRoughFloor = 0.3;           // of the goal: the least angle that the first steps of a chain may leave for moves to mend,
constexpr unsigned kMovesInChain = 12;        // so many of them,
constexpr std::size_t kMostBadInChain = 64;   // if they don't make too many bad tetrahedra themselves
constexpr unsigned kMoveSamples = 30;
constexpr std::size_t kNearest = 3;           // neighbours that may close up
constexpr std::size_t kTrialsPerExcess = 30;  // of old vertices, for each vertex that is too many: on large meshes not all can be tried
constexpr double kWorthRepeating = 0.02;      // of the vertices must go in a sweep for another to be tried

}  // namespace

/// The vertices of one segment or facet next to v, or of one cell, nearest first.
void Thinning::find_neighbours(VertexId v) {
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

void Thinning::take_note() {
    for (const TetId t : mover_.changed()) {
        if (!mesh_.tets().is_live(t)) continue;
        for (const VertexId v : mesh_.tets().corners(t))
            if (v != kInfiniteVertex) touched_.push_back(v);
        if (judge_.counts(t) && judge_.badness(t) > judge_.goal()) bad_.push_back(mesh_.tets().corners(t));
    }
}

/// Are the stars of all touched vertices as good as the goal, and is nothing encroached there?
bool Thinning::all_is_well() {
    std::sort(touched_.begin(), touched_.end());
    touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
    for (const VertexId v : touched_) {
        if (!mesh_.triangulation().is_inserted(v)) continue;
        mesh_.triangulation().find_star(v, star_);
        for (const TetId t : star_)
            if (boundary_.has_encroached(t) || (judge_.counts(t) && judge_.badness(t) > judge_.goal())) return false;
    }
    return true;
}

/// Moves corners of the tetrahedra that the chain has made until none is bad, or not soon enough.
bool Thinning::mend() {
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
            moved = mover_.move(v, t, judge_.goal(), kMoveSamples);
        }
        if (!moved) return false;
        take_note();
    }
    return all_is_well();
}

/// Takes v out and draws a neighbour towards the gap, where nothing may get worse than `limit` before moves mend it.
bool Thinning::merge(VertexId v, VertexId into, const Vec3& home, double limit) {
    if (!mover_.drop(v)) return false;
    take_note();
    if (!mover_.pull(into, home, limit)) return false;
    take_note();
    return mend();
}

bool Thinning::dissolve(VertexId v) {
    ChangeLog& log = mover_.log();
    const auto attempt = [&](const auto& chain) {
        bad_.clear();
        touched_.clear();
        log.begin();
        if (chain()) {
            log.keep();
            return true;
        }
        log.undo(mesh_);
        return false;
    };
    const double rough = std::cos(kRoughFloor * std::acos(judge_.goal()));
    if (attempt([&] { return mover_.remove(v, rough) && (take_note(), mend()); })) return true;
    find_neighbours(v);
    const Vec3 home = mesh_.point(v);
    return std::any_of(neighbours_.begin(), neighbours_.end(), [&](VertexId w) { return attempt([&] { return merge(v, w, home, rough); }); });
}

RunGuard::Verdict Thinning::sweep(std::size_t first, std::size_t enough, std::size_t trials) {
    for (std::size_t v = mesh_.vertex_slots(); v-- > first && mesh_.vertex_count() > enough && trials > 0;) {
        if (!mesh_.triangulation().is_inserted(VertexId{v})) continue;
        const RunGuard::Verdict verdict = guard_.poll(mesh_.vertex_count(), mesh_.tets().live(), mesh_.vertex_count() - enough);
        if (verdict != RunGuard::Verdict::go_on) return verdict;
        dissolve(VertexId{v});
        --trials;
    }
    return RunGuard::Verdict::go_on;
}

RunGuard::Verdict Thinning::run(std::size_t first_new, std::size_t enough) {
    RunGuard::Verdict verdict = RunGuard::Verdict::go_on;
    std::size_t before = 0;
    do {
        before = mesh_.vertex_count();
        verdict = sweep(first_new, 0, mesh_.vertex_slots());
        if (verdict == RunGuard::Verdict::go_on && mesh_.vertex_count() > enough)
            verdict = sweep(mesh_.plc().vertices.size(), enough, kTrialsPerExcess * (mesh_.vertex_count() - enough));
    } while (verdict == RunGuard::Verdict::go_on && mesh_.vertex_count() > enough &&
             static_cast<double>(before - mesh_.vertex_count()) > kWorthRepeating * static_cast<double>(before));
    return verdict;
}

}  // namespace wellmesh
