// SPDX-License-Identifier: Apache-2.0
// The last of the shape stage: chains of changes for the few tetrahedra that nothing else mended, and superfluous vertices taken out.
#include <algorithm>
#include <unordered_map>
#include <utility>

#include "core/resident_memory.hpp"
#include "shape/corners.hpp"
#include "shape/improve.hpp"

namespace wellmesh {
namespace {

constexpr std::size_t kMostRescued = 200;  // chains of changes about one tetrahedron cost as much as moves about a hundred
constexpr unsigned kShoves = 8;
constexpr unsigned kGradings = 4;

}  // namespace

/// Chains of changes about the corners of each of the few that are left.
RunGuard::Verdict ShapeImprover::rescue() {
    std::unordered_map<std::uint64_t, double> known;  // may stay as bad as they are
    for (const Bad& b : left()) known[key_of(b.corners)] = b.badness;
    std::uint64_t target = 0;
    chains_.tolerates = [&](TetId t) {
        if (mover_.excuses && mover_.excuses(t)) return true;
        const std::uint64_t key = key_of(mesh_.tets().corners(t));
        const auto old = known.find(key);
        return key != target && old != known.end() && badness_of(t) <= old->second;
    };
    mover_.move_beside_excused(true);
    RunGuard::Verdict verdict = RunGuard::Verdict::go_on;
    std::sort(left().begin(), left().end());
    for (std::size_t i = 0; i < std::min(left().size(), kMostRescued) && verdict == RunGuard::Verdict::go_on; ++i) {
        target = key_of(left()[i].corners);
        for (const VertexId v : freest_first(mesh_, left()[i].corners)) {
            verdict = guard_.poll(mesh_.vertex_count(), mesh_.tets().live(), left().size() - i);
            if (verdict != RunGuard::Verdict::go_on || !find_tet(mesh_, left()[i].corners, left()[i].last).valid()) break;
            if (mesh_.info(v).carrier != CarrierKind::input_vertex && (chains_.shove(v, kShoves) || chains_.dissolve(v))) break;
        }
    }
    mover_.move_beside_excused(false);
    chains_.tolerates = {};
    mending_.collect(workers_);
    return verdict;
}

/// Around the balls about acute vertices that are in the way of splits; then around those that are in the way of what is left.
RunGuard::Verdict ShapeImprover::grade_afresh() {
    if (!guard_.can_double()) return RunGuard::Verdict::go_on;
    Savepoint last(mesh_);
    const std::vector<double> balls = refiner_.balls();
    const std::size_t before = left().size();
    RunGuard::Verdict verdict = RunGuard::Verdict::go_on;
    for (unsigned r = 0; r < kGradings && !left().empty() && verdict == RunGuard::Verdict::go_on; ++r) {
        std::vector<TetId> stuck;
        for (const Bad& b : left())
            if (const TetId t = find_tet(mesh_, b.corners, b.last); t.valid()) stuck.push_back(t);
        Savepoint previous(mesh_);
        try {
            verdict = refiner_.grade_afresh(stuck);
        } catch (const MeshError& e) {
            if (e.code() != ErrorCode::budget_exhausted) throw;
            verdict = RunGuard::Verdict::out_of_vertices;
        }
        if (verdict == RunGuard::Verdict::out_of_vertices && !guard_.user_limit_spent()) {
            previous.go_back();
            refiner_.forget_waiting();
            mending_.collect(workers_);
            verdict = RunGuard::Verdict::go_on;
            break;
        }
        mending_.collect(workers_);
        if (verdict == RunGuard::Verdict::go_on) verdict = settle(LastResort::insert);
        if (left().empty() || verdict != RunGuard::Verdict::go_on) break;
        Retreat settled(mesh_, mending_);
        verdict = split_or_go_back(judge_.goal(), settled);
        if (verdict == RunGuard::Verdict::go_on) verdict = settle(LastResort::insert);
    }
    if (verdict == RunGuard::Verdict::go_on && left().size() < before && !guard_.has_too_many(mesh_.vertex_count())) return verdict;
    last.go_back();
    refiner_.set_balls(balls);
    mending_.collect(workers_);
    return verdict;
}

/// Takes superfluous vertices out. What excuses a tetrahedron beside an acute angle may have been one of them.
RunGuard::Verdict ShapeImprover::thin_out(std::size_t first_new, std::size_t enough) {
    if (thinning_.is_pointless(enough)) return RunGuard::Verdict::go_on;
    // Memory is short: a savepoint keeps what changes from here on.
    mending_.forget_tries();
    std::vector<std::uint32_t>().swap(marked_);
    return_freed_memory();
    if (!refiner_.may_excuse()) return thinning_.run(first_new, enough);
    if (!guard_.can_double()) return RunGuard::Verdict::go_on;
    Savepoint last(mesh_);
    RunGuard::Verdict verdict = thinning_.run(first_new, enough);
    mending_.collect(workers_);
    if (!left().empty() && verdict == RunGuard::Verdict::go_on) verdict = rescue();
    if (left().empty()) return verdict;
    last.go_back();
    mending_.collect(workers_);
    return verdict;
}

}  // namespace wellmesh
