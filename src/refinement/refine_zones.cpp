// SPDX-License-Identifier: Apache-2.0
// Refinement on several threads: where much waits, space is cut into zones, and each zone's part is worked off in a view, in the order that it would have there.
// What would leave its zone waits for other cuts, or in the end for the whole mesh. Zones depend on what waits and on the mesh's size alone.
#include <algorithm>
#include <deque>
#include <memory>
#include <utility>

#include "core/shared_guard.hpp"
#include "delaunay/zones.hpp"
#include "refinement/refine.hpp"

namespace wellmesh {

Refiner::Refiner(ConformingMesh& view, BoundaryRefiner& boundary, Refiner& whole)
    : mesh_(view),
      boundary_(boundary),
      guard_(whole.guard_),
      workers_(alone_),
      exemptions_(view, boundary.acute()),
      shared_sizes_(whole.shared_sizes_),
      sizes_(*shared_sizes_),
      max_radius_edge_(whole.max_radius_edge_),
      frugal_from_(whole.frugal_from_),
      relieved_(whole.relieved_),
      rounding_(whole.rounding_),
      sliver_cosine_(whole.sliver_cosine_),
      squared_size_slack_(whole.squared_size_slack_),
      candidates_(whole.candidates_) {
    boundary_.judge = [this](const Cavity& cavity, const Placement& where, double radius) { return !judging_ || accepts(cavity, where, radius); };
    listen();
}

void Refiner::join(const Refiner& zone) {
    statistics_.insertions += zone.statistics_.insertions;
    statistics_.candidates += zone.statistics_.candidates;
    statistics_.fallbacks += zone.statistics_.fallbacks;
    statistics_.guarded += zone.statistics_.guarded;
    const auto take = [](BadTetQueue from, BadTetQueue& to) {
        from.deal([&](const BadTetQueue::Entry& e, int level) {
            to.push(e, level);
            return true;
        });
    };
    take(zone.by_size_, by_size_);  // it was not to go on
    take(zone.by_radius_edge_, by_radius_edge_);
    take(zone.left_by_size_, by_size_);
    take(zone.left_by_radius_edge_, by_radius_edge_);
}

/// As drain(), without what only the whole can do.
void Refiner::drain_zone(const std::function<bool(std::size_t)>& may_go_on) {
    Triangulation& tri = mesh_.triangulation();
    while (true) {
        judging_ = false;
        boundary_.conform_in_zone(may_go_on);
        const std::size_t waiting = by_size_.size() + by_radius_edge_.size();
        if (waiting == 0 || !may_go_on(waiting)) return;
        const bool for_size = !by_size_.empty();
        BadTetQueue& queue = for_size ? by_size_ : by_radius_edge_;
        const int level = queue.level();
        const BadTetQueue::Entry e = queue.pop();
        const auto is_there = [&] { return mesh_.tets().is_finite(e.tet) && BadTetQueue::fingerprint(mesh_.tets().corners(e.tet)) == e.fingerprint && mesh_.in_domain(e.tet); };
        if (!is_there()) continue;
        double badness = 0;
        const Fault fault = classify(e.tet, badness);
        if (fault == Fault::none || is_forced(e.tet, fault)) continue;
        const std::size_t before = mesh_.vertex_count();
        tri.forget_leaving();
        if (fault == Fault::flat) tri.leave_zone();
        else process(e.tet, fault == Fault::size ? InsertionReason::size : InsertionReason::radius_edge);
        if (tri.left_zone()) (for_size ? left_by_size_ : left_by_radius_edge_).push(e, level);
        else if (mesh_.vertex_count() != before && is_there()) queue.push(e.tet, mesh_.tets().corners(e.tet), badness);
    }
}

void Refiner::drain_in_zones() {
    constexpr std::size_t kLeastAZone = 256, kSampleAZone = 512;
    // Of ten that wait, nine are gone once one of them is split beside a lattice; without one, where six for a vertex left zones without room, five do. A vertex takes
    // seven tetrahedra, or less; who finds no room waits for the next turn. What is put aside in vain stays in memory.
    // One in four of them may have labels.
    constexpr std::size_t kWaitingPerVertex = 5, kTetsPerVertex = 8, kRecordsPerVertex = 2, kMoreVertices = 64, kMoreRecords = 512;
    for (unsigned turn = 0; turn < Zones::kTurns && may_work_in_zones(); ++turn) {
        const auto is_there = [&](const BadTetQueue::Entry& e) { return mesh_.tets().is_finite(e.tet) && BadTetQueue::fingerprint(mesh_.tets().corners(e.tet)) == e.fingerprint; };
        std::vector<Vec3> sample;
        for (BadTetQueue* queue : {&by_size_, &by_radius_edge_})
            queue->deal([&](const BadTetQueue::Entry& e, int) {
                if (!is_there(e)) return true;
                sample.push_back(mesh_.point(mesh_.tets().corner(e.tet, 0)));
                return false;
            });
        const std::size_t work = sample.size(), count = Zones::worth(mesh_.tets().live(), work, kLeastAZone, turn);
        if (count < 2) break;
        const std::size_t step = std::max<std::size_t>(1, work / (kSampleAZone * count));
        for (std::size_t k = 0; k * step < work; ++k) sample[k] = sample[k * step];
        sample.resize((work + step - 1) / step);
        const std::size_t vertices = work / (kWaitingPerVertex * count) + kMoreVertices;
        const ConformingMesh::ZoneRoom room{.tets = kTetsPerVertex * vertices, .vertices = vertices, .records = kRecordsPerVertex * vertices + kMoreRecords};
        ZoneViews parts;
        std::vector<ConformingMesh> views = mesh_.split(workers_, Zones(std::move(sample), count, turn), room, parts);
        std::deque<BoundaryRefiner> boundaries;
        std::vector<std::unique_ptr<Refiner>> zones;
        for (std::size_t z = 0; z < count; ++z) {
            boundaries.emplace_back(views[z], boundary_, parts, static_cast<std::uint8_t>(z));
            zones.push_back(std::unique_ptr<Refiner>(new Refiner(views[z], boundaries[z], *this)));
        }
        const auto share_out = [&](BadTetQueue Refiner::*queue) {
            (this->*queue).deal([&](const BadTetQueue::Entry& e, int level) {
                const std::uint8_t zone = parts.zone_of_tet[e.tet.index()];
                if (zone != ZoneViews::kNone) (zones[zone].get()->*queue).push(e, level);
                return zone != ZoneViews::kNone;
            });
        };
        share_out(&Refiner::by_size_);
        share_out(&Refiner::by_radius_edge_);
        SharedGuard guard(guard_, mesh_.vertex_count(), mesh_.tets().live());
        workers_.for_each(count, [&](std::size_t z) { guard.watch([&] { zones[z]->drain_zone([&](std::size_t left) { return guard.may_go_on(left); }); }); });
        mesh_.join(views);
        for (std::size_t z = 0; z < count; ++z) {
            boundary_.join(boundaries[z]);
            join(*zones[z]);
        }
        if (guard.verdict() != RunGuard::Verdict::go_on) break;
    }
}

}  // namespace wellmesh
