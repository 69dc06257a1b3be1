// SPDX-License-Identifier: Apache-2.0
// Splits of the boundary in views of zones.
#include <algorithm>
#include <initializer_list>

#include "conforming/boundary_refiner.hpp"
#include "delaunay/zones.hpp"

namespace wellmesh {

BoundaryRefiner::BoundaryRefiner(ConformingMesh& view, BoundaryRefiner& whole, const ZoneViews& parts, std::uint8_t zone)
    : candidates(whole.candidates),
      rules(whole.rules),
      reference_edge(whole.reference_edge),
      mesh_(view),
      guard_(whole.guard_),
      seed_(whole.seed_),
      acute_(whole.acute_),
      shortest_for_conformity_(whole.shortest_for_conformity_) {
    const auto is_mine = [&](VertexId v) { return parts.zone_of_vertex[v.index()] == zone; };
    const auto take = [](auto& from, auto& to, const auto& is_inside) {
        std::erase_if(from, [&](const auto& w) {
            if (!is_inside(w.s)) return false;
            to.push_back(w);
            return true;
        });
    };
    take(whole.segments_, segments_, [&](const Subsegment& s) { return is_mine(s.a) && is_mine(s.b); });
    take(whole.faces_, faces_, [&](const Subface& s) { return std::all_of(s.corners.begin(), s.corners.end(), is_mine); });
}

/// A zone that was told to stop has some that still wait there.
void BoundaryRefiner::join(const BoundaryRefiner& zone) {
    const auto take_over = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    take_over(segments_, zone.left_segments_);
    take_over(segments_, zone.segments_);
    take_over(faces_, zone.left_faces_);
    take_over(faces_, zone.faces_);
    shortest_for_conformity_ = std::min(shortest_for_conformity_, zone.shortest_for_conformity_);
    refused_ += zone.refused_;
}

void BoundaryRefiner::conform_in_zone(const std::function<bool(std::size_t)>& may_go_on) {
    Triangulation& tri = mesh_.triangulation();
    while (waiting() > 0) {
        const bool goes_on = may_go_on(waiting());
        tri.forget_leaving();
        if (!segments_.empty()) {
            const WaitingSegment w = segments_.front();
            segments_.pop_front();
            // What is missing may appear anywhere about its ends.
            const bool may_try = goes_on && w.encroacher.valid();
            if (may_try && mesh_.find_subsegment(w.s).valid()) (void)split(w.s, {InsertionReason::encroachment, w.encroacher});
            if (!may_try || tri.left_zone()) left_segments_.push_back(w);
            continue;
        }
        const WaitingFace w = faces_.front();
        faces_.pop_front();
        if (!goes_on || !mesh_.find_subface(w.s).valid()) {
            if (!goes_on || tri.left_zone()) left_faces_.push_back(w);
            continue;
        }
        const std::size_t before = mesh_.vertex_count();
        const SplitOutcome outcome = split(w.s, {InsertionReason::encroachment, w.encroacher});
        // Where nothing comes of it the whole finds out why.
        if (outcome == SplitOutcome::inserted) continue;
        if (outcome == SplitOutcome::deferred && mesh_.vertex_count() != before) faces_.push_back(w);
        else left_faces_.push_back(w);
    }
}

}  // namespace wellmesh
