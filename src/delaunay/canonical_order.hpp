// SPDX-License-Identifier: Apache-2.0
// A numbering of tetrahedra that depends on the triangulation alone, not on how it came about. Tetrahedra go by their last vertex: with vertices numbered as
// they were inserted it made them, so that little moves.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/shared_array.hpp"
#include "core/workers.hpp"
#include "delaunay/tet_store.hpp"

namespace wellmesh {

/// The even permutation of the corners with the largest one first and the smallest of the others second; of a ghost's, whose corner 3 is at infinity, with the
/// largest first.
inline TetStore::Corners canonical_corners(const TetStore::Corners& c) {
    // Rows are even permutations: one that brings corner i to the front.
    constexpr std::array<std::array<std::uint8_t, 4>, 4> kToFront{{{0, 1, 2, 3}, {1, 2, 0, 3}, {2, 0, 1, 3}, {3, 2, 1, 0}}};
    const auto end = c[3] == kInfiniteVertex ? c.begin() + 3 : c.end();
    const auto& row = kToFront[static_cast<std::size_t>(std::max_element(c.begin(), end) - c.begin())];
    const VertexId first = c[row[0]], x = c[row[1]], y = c[row[2]], z = c[row[3]];
    if (c[3] == kInfiniteVertex) return {first, x, y, z};
    // Which one is the smallest can't be foreseen: no branch.
    const VertexId least = std::min(x, std::min(y, z));
    const std::array<VertexId, 5> round{x, y, z, x, y};
    const std::size_t at = (y == least ? 1U : 0U) + (z == least ? 2U : 0U);
    return {first, round[at], round[at + 1], round[at + 2]};
}

/// Calls visit(place, tetrahedron, canonical corners) for all live tetrahedra, or all finite ones: place 0, 1, ... in the order of their canonical corners.
/// Calls for different places come from several threads. @param prepare  called before that with their number  @param dealt  memory for one number for each of them
template <bool kGhosts, class Prepare, class Visit>
void visit_in_canonical_order(const TetStore& tets, std::size_t vertices, Workers& workers, Prepare&& prepare, Visit&& visit,
                              SharedArray<std::uint32_t> dealt = {}) {
    constexpr std::size_t kGrain = std::size_t{1} << 15;
    const bool alone = workers.threads() == 1;
    const auto add_one = [alone](std::uint32_t& counter) { return alone ? counter++ : std::atomic_ref(counter).fetch_add(1, std::memory_order_relaxed); };
    const auto largest = [](const TetStore::Corners& c) {
        const VertexId front = std::max(std::max(c[0], c[1]), c[2]);
        return (c[3] == kInfiniteVertex ? front : std::max(front, c[3])).index();
    };
    const auto for_all = [&](auto&& use) {
        workers.for_ranges(tets.slots(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t i = begin; i < end; ++i)
                if (kGhosts ? tets.is_live(TetId{i}) : tets.is_finite(TetId{i})) use(TetId{i});
        });
    };
    // Tetrahedra are dealt to their last vertices by counting; then each vertex sorts its few.
    SharedArray<std::uint32_t> start;
    start.resize(vertices, 0);
    for_all([&](TetId t) { add_one(start[largest(tets.corners(t))]); });
    std::uint32_t total = 0;
    for (std::uint32_t& s : start) total += std::exchange(s, total);
    prepare(std::size_t{total});
    dealt.resize_as_is(total);
    for_all([&](TetId t) { dealt[add_one(start[largest(tets.corners(t))])] = t.value(); });
    // Each start has moved on to the next one's. Of a last vertex's tetrahedra no two agree in second and third corner: they would overlap.
    struct Entry {
        std::uint64_t key;
        VertexId fourth;
        TetId tet;
    };
    workers.for_ranges(vertices, kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        constexpr std::size_t kFew = 24;
        std::vector<Entry> mine;
        std::array<std::uint32_t, kFew> place{};
        for (std::size_t v = begin; v < end; ++v) {
            const std::uint32_t first = v == 0 ? 0 : start[v - 1], count = start[v] - first;
            mine.resize(std::max<std::size_t>(mine.size(), count));
            for (std::uint32_t i = 0; i < count; ++i) {
                constexpr std::uint32_t kAhead = 24;
                const TetId t{dealt[first + i]};
                if (first + i + kAhead < total) tets.prefetch(TetId{dealt[first + i + kAhead]});
                const TetStore::Corners c = canonical_corners(tets.corners(t));
                mine[i] = {std::uint64_t{c[1].value()} << 32 | c[2].value(), c[3], t};
            }
            const bool few = count <= kFew;
            if (few) {  // all pairs are compared, without branches
                for (std::uint32_t i = 0; i < count; ++i) {
                    std::uint32_t before = 0;
                    for (std::uint32_t k = 0; k < i; ++k) {
                        const std::uint32_t less = mine[k].key < mine[i].key ? 1 : 0;
                        before += less;
                        place[k] += 1 - less;
                    }
                    place[i] = before;
                }
            } else {
                std::sort(mine.begin(), mine.begin() + count, [](const Entry& p, const Entry& q) { return p.key < q.key; });
            }
            for (std::uint32_t i = 0; i < count; ++i) {
                const Entry& e = mine[i];
                visit(std::size_t{first} + (few ? place[i] : i), e.tet,
                      TetStore::Corners{VertexId{v}, VertexId{static_cast<std::uint32_t>(e.key >> 32)}, VertexId{static_cast<std::uint32_t>(e.key)}, e.fourth});
            }
        }
    });
}

}  // namespace wellmesh
