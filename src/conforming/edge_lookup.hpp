// SPDX-License-Identifier: Apache-2.0
// Edges by their ends, for what one operation does to the surface: mostly a dozen, but thousands where a segment or facet is far finer than what is beside it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/edge_key.hpp"

namespace wellmesh {

/// So many are looked through faster than they are sorted.
inline constexpr std::size_t kFewEdges = 32;

/// Numbers filed under edges.
class EdgeLookup {
public:
    void clear() { entries_.clear(); }
    void add(std::uint64_t key, std::size_t number) { entries_.emplace_back(key, static_cast<std::uint32_t>(number)); }
    /// To be called after the last add(), and again after more of them.
    void finish() {
        if (entries_.size() > kFewEdges) std::sort(entries_.begin(), entries_.end());
    }
    /// Calls f(number) for all that is filed under the edge, in the order of the numbers if they were added in that order.
    template <class F>
    void for_each(std::uint64_t key, F&& f) const {
        const bool few = entries_.size() <= kFewEdges;
        for (auto e = few ? entries_.begin() : std::lower_bound(entries_.begin(), entries_.end(), std::pair{key, std::uint32_t{0}}); e != entries_.end(); ++e) {
            if (e->first == key) f(e->second);
            else if (!few) break;
        }
    }
    [[nodiscard]] bool contains(std::uint64_t key) const {
        bool found = false;
        for_each(key, [&](std::uint32_t) { found = true; });
        return found;
    }

private:
    std::vector<std::pair<std::uint64_t, std::uint32_t>> entries_;
};

/// Lists each edge once, in the order in which they come.
template <class Item>
class DistinctEdges {
public:
    explicit DistinctEdges(std::vector<Item>& items) : items_(items) { items_.clear(); }
    /// Is it surely listed already? Not to be trusted where it says no: finish() drops what was listed twice.
    [[nodiscard]] bool is_listed(std::uint64_t key) const {
        const std::size_t first = items_.size() - std::min(items_.size(), kFewEdges);
        return std::any_of(items_.begin() + static_cast<std::ptrdiff_t>(first), items_.end(), [&](const Item& s) { return edge_key(s.a, s.b) == key; });
    }
    void add(const Item& item) { items_.push_back(item); }
    void finish() {
        if (items_.size() <= kFewEdges) return;
        std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
        for (const Item& s : items_) order.emplace_back(edge_key(s.a, s.b), static_cast<std::uint32_t>(order.size()));
        std::sort(order.begin(), order.end());
        std::vector<char> is_repeated(items_.size(), 0);
        for (std::size_t i = 1; i < order.size(); ++i) is_repeated[order[i].second] = order[i].first == order[i - 1].first;
        std::size_t at = 0;
        std::erase_if(items_, [&](const Item&) { return is_repeated[at++] != 0; });
    }

private:
    std::vector<Item>& items_;
};

}  // namespace wellmesh
