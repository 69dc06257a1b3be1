// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "core/ids.hpp"

namespace wellmesh {

/// An undirected edge as a key: the smaller vertex in the high half.
using EdgeKey = std::uint64_t;
[[nodiscard]] constexpr EdgeKey edge_key(VertexId a, VertexId b) {
    const std::uint64_t u = a.value(), v = b.value();
    return u < v ? (u << 32) | v : (v << 32) | u;
}
[[nodiscard]] constexpr std::array<VertexId, 2> edge_ends(EdgeKey key) {
    return {VertexId{static_cast<std::uint32_t>(key >> 32)}, VertexId{static_cast<std::uint32_t>(key)}};
}

}  // namespace wellmesh
