// SPDX-License-Identifier: Apache-2.0
#include "core/corner_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "core/rng.hpp"

namespace wellmesh {
namespace {

/// Random faces or edges against a map. Between few vertices many share one.
template <std::size_t kCorners>
void finds_what_a_map_finds(unsigned threads, std::size_t vertices, std::size_t count) {
    using Corners = std::array<VertexId, kCorners>;
    const auto random = [vertices](std::uint64_t k) {
        Corners c;
        for (std::size_t i = 0; i < kCorners; ++i) c[i] = VertexId{static_cast<std::uint32_t>(mix64(k, i) % vertices)};
        return c;
    };
    const auto sorted = [](Corners c) {
        std::sort(c.begin(), c.end());
        return c;
    };
    std::vector<Corners> listed;
    std::map<Corners, std::uint32_t> expected;
    for (std::uint64_t k = 0; listed.size() < count; ++k)
        if (const Corners c = random(k); expected.emplace(sorted(c), static_cast<std::uint32_t>(listed.size())).second) listed.push_back(c);
    Workers workers(threads);
    const CornerTable<kCorners> table(workers, vertices, count, [&](std::size_t i) { return listed[i]; });
    for (std::uint64_t k = 0; k < 40'000; ++k) {
        const Corners c = random(k);  // beyond those that were listed, too
        const auto at = expected.find(sorted(c));
        ASSERT_EQ(table.find(c), at == expected.end() ? table.kNone : at->second);
    }
}

TEST(CornerTable, FindsWhatAMapFinds) {
    for (const unsigned threads : {1U, 3U, 8U}) {
        for (const std::size_t vertices : {97U, 9'000U}) {
            for (const std::size_t count : {0U, 1U, 4000U}) finds_what_a_map_finds<2>(threads, vertices, count);
            for (const std::size_t count : {0U, 1U, 30'000U}) finds_what_a_map_finds<3>(threads, vertices, count);
        }
    }
}

}  // namespace
}  // namespace wellmesh
