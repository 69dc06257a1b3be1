// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>

#include "delaunay/canonical_order.hpp"
#include "delaunay/triangulation.hpp"

namespace wellmesh {
namespace {

constexpr std::size_t kGrain = std::size_t{1} << 15;

}  // namespace

std::vector<TetId> Triangulation::renumber(Workers& workers) {
    std::vector<TetId> old_of;
    std::vector<TetId> new_of(tets_.slots());
    TetStore renumbered;
    visit_in_canonical_order<true>(
        tets_, vertices_.size(), workers,
        [&](std::size_t n) {
            old_of.resize(n);
            (void)renumbered.take_slots(n);
        },
        [&](std::size_t place, TetId t, const TetStore::Corners& c) {
            old_of[place] = t;
            new_of[t.index()] = TetId{place};
            renumbered.set_corners(TetId{place}, c);
        });
    workers.for_ranges(old_of.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            const TetId t{i}, before = old_of[i];
            for (unsigned k = 0; k < 4; ++k) {
                const TetFace beyond = tets_.across(before, tets_.find_corner(before, renumbered.corner(t, k)));
                const TetId n = new_of[beyond.tet().index()];
                renumbered.set_across(TetFace{t, k}, TetFace{n, renumbered.find_corner(n, tets_.corner(beyond.tet(), beyond.face()))});
            }
        }
    });
    tets_ = std::move(renumbered);
    find_homes(workers);
    last_located_ = TetId{};
    return old_of;
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
