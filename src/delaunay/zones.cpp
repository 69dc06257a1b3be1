// SPDX-License-Identifier: Apache-2.0
// A triangulation split into views of zones, and put together again.
#include "delaunay/zones.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "delaunay/local_numbers.hpp"

namespace wellmesh {

void Triangulation::split(Workers& workers, const Zones& zones, std::size_t spare, ZoneViews& out) {
    constexpr std::size_t kGrain = std::size_t{1} << 14;
    const std::size_t slots = tets_.slots();
    out.zone_of_vertex.resize_as_is(vertices_.size());
    workers.for_ranges(vertices_.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) out.zone_of_vertex[i] = zones.zone_of(vertices_[i].point);
    });
    out.zone_of_tet.assign(slots + zones.count() * spare, ZoneViews::kNone);
    std::vector<std::array<std::size_t, Zones::kMost>> counts((slots + kGrain - 1) / kGrain);
    workers.for_ranges(slots, kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        for (std::size_t i = begin; i < end; ++i) {
            const TetStore::Corners& c = tets_.corners(TetId{i});
            if (!c[0].valid()) continue;
            const std::uint8_t zone = out.zone_of_vertex[c[0].index()];
            if (out.zone_of_vertex[c[1].index()] != zone || out.zone_of_vertex[c[2].index()] != zone) continue;
            if (c[3] != kInfiniteVertex && out.zone_of_vertex[c[3].index()] != zone) continue;
            out.zone_of_tet[i] = zone;
            ++counts[piece][zone];
        }
    });
    out.tets.assign(zones.count(), 0);
    for (const auto& piece : counts)
        for (std::size_t z = 0; z < zones.count(); ++z) out.tets[z] += piece[z];

    std::vector<TetStore::Slots> taken(zones.count());
    for (TetStore::Slots& share : taken) share = tets_.take_slots(spare);
    std::vector<std::vector<TetId>> free(zones.count());
    workers.for_each(zones.count(), [&](std::size_t z) {
        tets_.touch(taken[z]);
        free[z] = std::move(taken[z]).list();
        for (const TetId t : free[z]) {
            out.zone_of_tet[t.index()] = static_cast<std::uint8_t>(z);
            tets_.empty(t);
        }
    });
    renew_stamps(StampedNumbers::kLastStamp / 2);  // for the views: as many insertions each before numbers are found more slowly
    if (epoch_ > kLastEpoch / 2) {
        std::fill(mark_.begin(), mark_.end(), 0U);
        epoch_ = 0;
    }
    mark_.resize(std::max(mark_.size(), tets_.slots()), 0);
    out.views.clear();
    for (std::size_t z = 0; z < zones.count(); ++z) out.views.push_back(view_of_zone(static_cast<std::uint8_t>(z), out.zone_of_tet.data(), std::move(free[z])));
}

void Triangulation::join(const Triangulation& view) {
    epoch_ = std::max(epoch_, view.epoch_);
    stamp_ = std::max(stamp_, view.stamp_);
    tets_.take_back(view.tets_);
}

}  // namespace wellmesh
