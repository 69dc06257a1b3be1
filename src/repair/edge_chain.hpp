// SPDX-License-Identifier: Apache-2.0
// Edges that have been split, as chains of what became of them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "validation/working_complex.hpp"

namespace wellmesh {

/// EdgeKey of two numbers.
[[nodiscard]] constexpr EdgeKey piece_edge(std::uint32_t a, std::uint32_t b) { return edge_key(VertexId{a}, VertexId{b}); }

/// A vertex inside an edge that has been replaced by two.
using EdgeSplits = std::unordered_map<EdgeKey, std::uint32_t>;

/// Appends `from` and all vertices after it but the last: a way through `stops` (the last of them first), with splits, splits of splits and so on.
/// No vertex comes twice, whatever the splits say.
inline void append_split_chain(const EdgeSplits& splits, std::uint32_t from, std::vector<std::uint32_t> stops, std::vector<std::uint32_t>& chain) {
    const auto start = static_cast<std::ptrdiff_t>(chain.size());
    while (!stops.empty()) {
        const auto split = splits.find(piece_edge(from, stops.back()));
        if (split != splits.end() && std::find(stops.begin(), stops.end(), split->second) == stops.end() &&
            std::find(chain.begin() + start, chain.end(), split->second) == chain.end()) {
            stops.push_back(split->second);
            continue;
        }
        chain.push_back(from);
        from = stops.back();
        stops.pop_back();
    }
}

}  // namespace wellmesh
