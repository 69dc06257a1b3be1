// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <atomic>

#include "delaunay/canonical_order.hpp"
#include "delaunay/triangulation.hpp"

namespace wellmesh {
namespace {

constexpr std::size_t kGrain = std::size_t{1} << 15;

/// Of a turn, two bits a corner: the turn back.
constexpr std::array<std::uint8_t, 256> kTurnBack = [] {
    std::array<std::uint8_t, 256> back{};
    for (unsigned turn = 0; turn < back.size(); ++turn)
        for (unsigned k = 0; k < 4; ++k) back[turn] = static_cast<std::uint8_t>(back[turn] | k << (2 * (turn >> (2 * k) & 3U)));
    return back;
}();

}  // namespace

Triangulation::Renumbering Triangulation::renumber(Workers& workers) {
    Renumbering out;
    std::vector<TetId> new_of(tets_.slots());
    out.turns.resize(tets_.slots());
    visit_in_canonical_order<true>(
        tets_, vertices_.size(), workers, [&](std::size_t n) { out.old_of.resize(n); },
        [&](std::size_t place, TetId t, const TetStore::Corners& c) {
            out.old_of[place] = t;
            new_of[t.index()] = TetId{place};
            std::uint8_t turn = 0;
            for (unsigned k = 0; k < 4; ++k) turn = static_cast<std::uint8_t>(turn | tets_.find_corner(t, c[k]) << (2 * k));
            out.turns[t.index()] = turn;
        });
    // Each where it is, by what is known of its neighbours' new places; then all of them move.
    workers.for_ranges(tets_.slots(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            const TetId t{i};
            if (!tets_.is_live(t)) continue;
            const TetStore::Corners c = tets_.corners(t);
            const std::array<TetFace, 4> across = tets_.across_all(t);
            TetStore::Corners corners;
            std::array<TetFace, 4> opposite;
            for (unsigned k = 0; k < 4; ++k) {
                const unsigned before = out.turns[i] >> (2 * k) & 3U;
                const TetFace beyond = across[before];
                const std::size_t n = beyond.tet().index();
                const unsigned back = kTurnBack[out.turns[n]];
                corners[k] = c[before];
                opposite[k] = TetFace{new_of[n], back >> (2 * beyond.face()) & 3U};
            }
            tets_.set(t, corners, opposite);
        }
    });
    tets_.reorder(out.old_of, new_of, workers);
    find_homes(workers);
    last_located_ = TetId{};
    return out;
}

/// Each vertex's tetrahedron: the first finite one of those that it made, or else the first of all.
void Triangulation::find_homes(Workers& workers) {
    std::vector<std::uint8_t> made_one(vertices_.size(), 0);
    workers.for_ranges(vertices_.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t v = begin; v < end; ++v) vertices_[v].tet = TetId{};
    });
    workers.for_ranges(tets_.slots(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            const TetId t{i};
            const VertexId v = tets_.corner(t, 0);
            if (tets_.is_ghost(t)) continue;
            bool first = true;
            for (std::size_t k = i; first && k-- > 0 && tets_.corner(TetId{k}, 0) == v;) first = tets_.is_ghost(TetId{k});
            if (!first) continue;
            vertices_[v.index()].tet = t;
            made_one[v.index()] = 1;
        }
    });
    workers.for_ranges(tets_.slots(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            if (tets_.is_ghost(TetId{i})) continue;
            for (unsigned k = 1; k < 4; ++k) {
                const std::size_t v = tets_.corner(TetId{i}, k).index();
                if (made_one[v] != 0) continue;
                std::atomic_ref<TetId> home(vertices_[v].tet);  // an invalid id is larger than all others
                for (TetId seen = home.load(std::memory_order_relaxed); TetId{i} < seen && !home.compare_exchange_weak(seen, TetId{i}, std::memory_order_relaxed);) {}
            }
        }
    });
}

}  // namespace wellmesh
