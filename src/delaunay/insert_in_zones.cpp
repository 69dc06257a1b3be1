// SPDX-License-Identifier: Apache-2.0
// Bulk insertion on several threads. Space is split into zones; a tetrahedron belongs to a zone if all of its vertices do. Each zone has a worker
// with a view of the triangulation, which may touch what belongs to its zone and nothing else: a point whose search meets anything else is left for
// later. What is left then lies along the limits of the zones, and is shared out once more with limits of its own; the few that are left again go in
// one by one.
//
// The tetrahedra are a function of the points alone (triangulation.hpp), so who inserted what can't be seen in them; only their ids tell.
#include <algorithm>
#include <array>
#include <bit>
#include <unordered_map>
#include <utility>

#include "delaunay/triangulation.hpp"
#include "delaunay/zones.hpp"

namespace wellmesh {
namespace {

/// Fewer points than these a zone are not worth the trouble: most would lie near its limits.
constexpr std::size_t kLeastPointsAZone = 256;
/// To cut costs some ten nanoseconds a tetrahedron and vertex, to insert a few microseconds a point.
constexpr std::size_t kTetsAPoint = 256;
/// Points grow by this factor from one share-out to the next: a zone's limits get thinner as its points get denser.
constexpr std::size_t kGrowth = 8;
constexpr std::size_t kBetweenQuestions = 512;  // insertions, of microseconds mostly

}  // namespace

Triangulation Triangulation::view_of_zone(std::uint8_t zone, std::uint8_t* zone_of_tet, std::vector<TetId> slots) {
    Triangulation out;
    out.tets_ = tets_.view(std::move(slots));
    out.filter_ = filter_;
    out.low_ = low_;
    out.high_ = high_;
    out.vertices_ = vertices_.view();
    out.mark_ = mark_.view();
    out.epoch_ = epoch_;
    out.stamp_ = stamp_;
    out.zone_of_tet_ = zone_of_tet;
    out.zone_ = zone;
    return out;
}

/// In a view. @param left  gets what must wait: its cavity is not all of this zone, or there is no room.
void Triangulation::insert_in_zone(std::span<const std::uint32_t> order, TetId seed, BulkObserver* observer, std::vector<std::uint32_t>& left,
                                   std::vector<std::uint32_t>& refused) {
    if (!seed.valid()) {
        left.assign(order.begin(), order.end());
        return;
    }
    Cavity cavity;
    last_located_ = seed;
    for (std::size_t k = 0; k < order.size(); ++k) {
        const std::uint32_t i = order[k];
        if (observer && k % kBetweenQuestions == 0 && !observer->may_go_on()) {
            left.insert(left.end(), order.begin() + static_cast<std::ptrdiff_t>(k), order.end());
            return;
        }
        const VertexId v{i};
        const Vec3 p = point(v);
        const TetId at = walk<true>(p, last_located_);
        if (!at.valid() || (tets_.is_ghost(at) && !is_mine(tets_.across(at, 3).tet()))) {
            left.push_back(i);
            continue;
        }
        const TetStore::Corners& c = tets_.corners(at);
        const auto same = std::find_if(c.begin(), c.end(), [&](VertexId w) { return w != kInfiniteVertex && point(w) == p; });
        if (same != c.end()) {
            duplicates_.push_back({v, *same});
            continue;
        }
        if (observer && !observer->welcomes(p, at)) {
            refused.push_back(i);
            continue;
        }
        if (!grow_in_waves<true>(p, at, cavity) || tets_.room() + cavity.tets.size() < cavity.boundary.size()) {
            left.push_back(i);
            continue;
        }
        const auto answer = observer ? observer->prepare(v, cavity) : BulkObserver::Answer::yes;
        if (answer != BulkObserver::Answer::yes) {
            (answer == BulkObserver::Answer::never ? refused : left).push_back(i);
            continue;
        }
        insert_vertex(v, cavity);
        if (observer) observer->made(v, new_tets_);
    }
}

/// The same with the whole triangulation for a zone. @return what was refused for whatever reason, and what was not begun
std::vector<std::uint32_t> Triangulation::insert_one_by_one(std::span<const std::uint32_t> order, BulkObserver* observer) {
    std::vector<std::uint32_t> left;
    Cavity cavity;
    TetId near = last_located_;
    renew_stamps(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
        if (observer && k % kBetweenQuestions == 0 && !observer->may_go_on()) {
            left.insert(left.end(), order.begin() + static_cast<std::ptrdiff_t>(k), order.end());
            break;
        }
        const VertexId v{order[k]};
        if (is_inserted(v)) continue;
        if (observer) {
            near = locate(point(v), near);
            if (!observer->welcomes(point(v), near)) {
                left.push_back(order[k]);
                continue;
            }
        }
        if (!find_conflict_cavity(point(v), near, cavity)) {
            duplicates_.push_back({v, cavity.duplicate});
            continue;
        }
        if (observer && observer->prepare(v, cavity) != BulkObserver::Answer::yes) {
            left.push_back(order[k]);
            continue;
        }
        insert_vertex(v, cavity);
        if (observer) {
            observer->make_room(tets_.slots());
            observer->made(v, new_tets_);
        }
        near = last_located_;
    }
    return left;
}

/// @return what is left
std::vector<std::uint32_t> Triangulation::insert_in_zones(Workers& workers, std::span<const std::uint32_t> order, unsigned turn,
                                                          BulkObserver* observer, std::vector<std::uint32_t>& refused) {
    const std::size_t zones =
        std::min({std::bit_floor(order.size() / kLeastPointsAZone), std::bit_ceil(std::size_t{workers.threads()}), Zones::kMost});
    if (zones < 2 || order.size() < std::max(tets_.live(), vertices_.size()) / kTetsAPoint) return {order.begin(), order.end()};
    constexpr std::size_t kSampleAZone = 1024;
    std::vector<Vec3> sample;
    const std::size_t step = std::max<std::size_t>(1, order.size() / (kSampleAZone * zones));
    for (std::size_t k = 0; k < order.size(); k += step) sample.push_back(point(VertexId{order[k]}));
    const Zones tree(std::move(sample), zones, turn);

    struct Zone {
        std::vector<std::uint32_t> order, left, refused;
        TetStore::Slots slots;
        TetId seed{};
        std::uint32_t epoch = 0, stamp = 0;
        std::vector<Duplicate> duplicates;
        TetStore store;
    };
    std::vector<Zone> team(zones);
    SharedArray<std::uint8_t> zone_of_vertex, zone_of_tet;
    zone_of_vertex.resize_as_is(vertices_.size());
    constexpr std::size_t kGrain = std::size_t{1} << 14;
    workers.for_ranges(vertices_.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i)
            if (is_inserted(VertexId{i})) zone_of_vertex[i] = tree.zone_of(vertices_[i].point);
    });
    workers.for_ranges(order.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t k = begin; k < end; ++k) zone_of_vertex[order[k]] = tree.zone_of(vertices_[order[k]].point);
    });
    for (Zone& z : team) z.order.reserve(order.size() / zones + order.size() / (8 * zones));
    for (const std::uint32_t i : order) team[zone_of_vertex[i]].order.push_back(i);

    const std::size_t old_slots = tets_.slots();
    for (Zone& z : team) {
        // An insertion makes 6.77 tetrahedra more in random points.
        z.slots = tets_.take_slots(7 * z.order.size() + 1000);
    }
    if (epoch_ > kLastEpoch / 2) {
        std::fill(mark_.begin(), mark_.end(), 0U);
        epoch_ = 0;
    }
    if (const std::size_t marked = mark_.size(); marked < tets_.slots()) {
        mark_.resize_as_is(tets_.slots());
        workers.for_ranges(tets_.slots() - marked, kGrain,
                           [&](std::size_t begin, std::size_t end, std::size_t) { std::fill(&mark_[marked] + begin, &mark_[marked] + end, 0U); });
    }
    renew_stamps(order.size());
    if (observer) {
        observer->make_room(tets_.slots());
        observer->split(zones);
    }

    zone_of_tet.resize_as_is(tets_.slots());
    std::vector<std::array<TetId, Zones::kMost>> first((old_slots + kGrain - 1) / kGrain);
    workers.for_ranges(old_slots, kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        for (std::size_t i = begin; i < end; ++i) {
            const TetStore::Corners& c = tets_.corners(TetId{i});
            zone_of_tet[i] = ZoneViews::kNone;
            if (!c[0].valid()) continue;
            const std::uint8_t zone = zone_of_vertex[c[0].index()];
            if (zone_of_vertex[c[1].index()] != zone || zone_of_vertex[c[2].index()] != zone) continue;
            if (c[3] != kInfiniteVertex && zone_of_vertex[c[3].index()] != zone) continue;
            zone_of_tet[i] = zone;
            if (TetId& t = first[piece][zone]; !t.valid()) t = TetId{i};
        }
    });
    for (std::size_t z = 0; z < zones; ++z) {
        for (const auto& piece : first)
            if (!team[z].seed.valid()) team[z].seed = piece[z];
    }

    workers.for_each(zones, [&](std::size_t z) {
        tets_.touch(team[z].slots);
        std::vector<TetId> slots = std::move(team[z].slots).list();
        for (const TetId t : slots) {
            zone_of_tet[t.index()] = static_cast<std::uint8_t>(z);
            tets_.empty(t);
        }
        Triangulation view = view_of_zone(static_cast<std::uint8_t>(z), zone_of_tet.data(), std::move(slots));
        view.insert_in_zone(team[z].order, team[z].seed, observer ? &observer->for_zone(z) : nullptr, team[z].left, team[z].refused);
        team[z].epoch = view.epoch_;
        team[z].stamp = view.stamp_;
        team[z].duplicates = std::move(view.duplicates_);
        team[z].store = std::move(view.tets_);
    });

    if (observer) observer->join();

    std::vector<std::uint32_t> left;
    for (const Zone& z : team) {
        left.insert(left.end(), z.left.begin(), z.left.end());
        refused.insert(refused.end(), z.refused.begin(), z.refused.end());
        epoch_ = std::max(epoch_, z.epoch);
        stamp_ = std::max(stamp_, z.stamp);
        duplicates_.insert(duplicates_.end(), z.duplicates.begin(), z.duplicates.end());
        tets_.take_back(z.store);
    }
    const auto inserted = std::find_if(order.begin(), order.end(), [&](std::uint32_t i) { return is_inserted(VertexId{i}); });
    last_located_ = inserted != order.end() ? tet_of(VertexId{*inserted}) : TetId{};
    return left;
}

/// Of points at one place the first in number is to be the vertex, whichever came first.
void Triangulation::prefer_first_duplicates(std::size_t from) {
    std::unordered_map<VertexId, VertexId> took_over;  // from vertices that have had to go: always straight to the one that is there now
    std::vector<TetId> star;
    for (std::size_t i = from; i < duplicates_.size(); ++i) {
        Duplicate& d = duplicates_[i];
        const VertexId was = d.inserted;
        if (const auto it = took_over.find(was); it != took_over.end()) d.inserted = it->second;
        if (d.inserted < d.vertex) continue;
        find_star(d.inserted, star);
        for (const TetId t : star) {
            TetStore::Corners c = tets_.corners(t);
            std::replace(c.begin(), c.end(), d.inserted, d.vertex);
            tets_.set_corners(t, c);
        }
        vertices_[d.vertex.index()].tet = std::exchange(vertices_[d.inserted.index()].tet, TetId{});
        took_over[was] = took_over[d.inserted] = d.vertex;
        std::swap(d.vertex, d.inserted);
    }
}

std::vector<std::uint32_t> Triangulation::insert_on(Workers& workers, std::span<const std::uint32_t> order, BulkObserver* observer) {
    const std::size_t known = duplicates_.size();
    // Shares as the rounds of a biased order [Amenta03], each kGrowth times the one before, so that a zone's limits are thin beside what goes into
    // it.
    std::size_t share = order.size();
    if (workers.threads() > 1)
        while (share > 2 * kLeastPointsAZone * workers.threads()) share /= kGrowth;
    std::vector<std::uint32_t> refused = insert_one_by_one(order.first(share), observer);
    for (std::size_t done = share; done < order.size();) {
        const auto part = order.subspan(done, std::min(done * kGrowth + kGrowth, order.size()) - done);
        done += part.size();
        std::vector<std::uint32_t> left(part.begin(), part.end());
        constexpr unsigned kTurns = 4;
        for (unsigned turn = 0; turn < kTurns && !left.empty(); ++turn) left = insert_in_zones(workers, left, turn, observer, refused);
        left = insert_one_by_one(left, observer);
        refused.insert(refused.end(), left.begin(), left.end());
    }
    prefer_first_duplicates(known);
    std::sort(refused.begin(), refused.end());
    return refused;
}

}  // namespace wellmesh
