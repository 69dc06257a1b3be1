// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/ids.hpp"
#include "core/workers.hpp"

namespace wellmesh {

/// Finds the number of an edge or a face by its corners, in any order. Each is listed with its last corner, which has few, so that what lies together in space lies together in
/// memory where numbers of vertices do. Built once, on all workers; searched from any thread.
template <std::size_t kCorners>
class CornerTable {
public:
    static_assert(kCorners == 2 || kCorners == 3);
    using Corners = std::array<VertexId, kCorners>;
    static constexpr std::uint32_t kNone = 0xffffffffU;

    /// @param vertices  all corners are below, those that are searched for, too
    /// @param corners_of  number -> corners, each edge or face once; asked twice, from any thread
    template <class CornersOf>
    CornerTable(Workers& workers, std::size_t vertices, std::size_t count, const CornersOf& corners_of) : first_(vertices + 1, 0), entries_(count) {
        constexpr std::size_t kGrain = std::size_t{1} << 13;
        const auto for_all = [&](auto&& use) {
            workers.for_ranges(count, kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
                for (std::size_t i = begin; i < end; ++i) use(i, split(corners_of(i)));
            });
        };
        // Counted one place ahead, so that first_[v] is where those of v begin, and moves on to where the next one's do.
        const auto add_one = [](std::uint32_t& counter) { return std::atomic_ref(counter).fetch_add(1, std::memory_order_relaxed); };
        for_all([&](std::size_t, const Split& s) { add_one(first_[s.last + 1]); });
        for (std::size_t v = 0; v < vertices; ++v) first_[v + 1] += first_[v];
        for_all([&](std::size_t i, const Split& s) { entries_[add_one(first_[s.last])] = {s.others, static_cast<std::uint32_t>(i)}; });
        // Who comes first is listed first: it makes no difference to who searches.
        workers.for_ranges(vertices, kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t v = begin; v < end; ++v)
                if (const auto [from, to] = row(v); to - from > kFew) std::sort(from, to, [](const Entry& a, const Entry& b) { return a.others < b.others; });
        });
    }
    /// kNone: there is none.
    [[nodiscard]] std::uint32_t find(const Corners& corners) const {
        const Split s = split(corners);
        auto [at, end] = row(s.last);
        if (end - at > kFew) at = std::lower_bound(at, end, s.others, [](const Entry& e, std::uint64_t others) { return e.others < others; });
        else while (at != end && at->others != s.others) ++at;
        return at != end && at->others == s.others ? at->number : kNone;
    }

private:
    static constexpr std::ptrdiff_t kFew = 16;  // all looked at in turn
    struct Entry {
        std::uint64_t others = 0;
        std::uint32_t number = 0;
    };
    struct Split {
        std::size_t last = 0;
        std::uint64_t others = 0;  // the lower one in front
    };
    static Split split(const Corners& c) {
        if constexpr (kCorners == 2) {
            return {std::max(c[0], c[1]).index(), std::min(c[0], c[1]).value()};
        } else {
            const VertexId low = std::min(c[0], c[1]), high = std::max(c[0], c[1]), last = std::max(high, c[2]), middle = std::min(high, c[2]);
            return {last.index(), std::uint64_t{std::min(low, middle).value()} << 32 | std::max(low, middle).value()};
        }
    }
    /// Once all are listed: each begin has moved on to the next one's.
    [[nodiscard]] std::pair<const Entry*, const Entry*> row(std::size_t v) const { return {entries_.data() + (v == 0 ? 0 : first_[v - 1]), entries_.data() + first_[v]}; }
    [[nodiscard]] std::pair<Entry*, Entry*> row(std::size_t v) { return {entries_.data() + (v == 0 ? 0 : first_[v - 1]), entries_.data() + first_[v]}; }

    std::vector<std::uint32_t> first_;
    std::vector<Entry> entries_;
};

}  // namespace wellmesh
