// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/ids.hpp"
#include "core/rng.hpp"
#include "core/workers.hpp"

namespace wellmesh {

/// Finds the number of an edge or a face by its corners, in any order. Built once, on all workers; searched from any thread.
template <std::size_t kCorners>
class CornerTable {
public:
    static_assert(kCorners == 2 || kCorners == 3);
    using Corners = std::array<VertexId, kCorners>;
    static constexpr std::uint32_t kNone = 0xffffffffU;

    /// @param corners_of  number -> corners, each edge or face once; from any thread
    template <class CornersOf>
    CornerTable(Workers& workers, std::size_t count, const CornersOf& corners_of) : corners_(count), slots_(std::bit_ceil(2 * count + 2), kNone) {
        constexpr std::size_t kGrain = std::size_t{1} << 13;
        workers.for_ranges(count, kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t i = begin; i < end; ++i) {
                corners_[i] = corners_of(i);
                std::sort(corners_[i].begin(), corners_[i].end());
                // Who comes first gets the slot: it makes no difference to who searches.
                for (std::size_t s = slot_of(corners_[i]);; s = next(s)) {
                    std::uint32_t empty = kNone;
                    if (std::atomic_ref(slots_[s]).compare_exchange_strong(empty, static_cast<std::uint32_t>(i), std::memory_order_relaxed)) break;
                }
            }
        });
    }
    /// kNone: there is none.
    [[nodiscard]] std::uint32_t find(Corners corners) const {
        std::sort(corners.begin(), corners.end());
        std::size_t s = slot_of(corners);
        while (slots_[s] != kNone && corners_[slots_[s]] != corners) s = next(s);
        return slots_[s];
    }

private:
    [[nodiscard]] std::size_t slot_of(const Corners& c) const {
        std::uint64_t h = std::uint64_t{c[0].value()} << 32 | c[1].value();
        if constexpr (kCorners == 3) h = mix64(h, c[2].value());
        else h = mix64(h, 0);
        return h & (slots_.size() - 1);
    }
    [[nodiscard]] std::size_t next(std::size_t slot) const { return (slot + 1) & (slots_.size() - 1); }

    std::vector<Corners> corners_;  // ascending
    std::vector<std::uint32_t> slots_;
};

}  // namespace wellmesh
