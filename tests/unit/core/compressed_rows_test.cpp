// SPDX-License-Identifier: Apache-2.0
#include "core/compressed_rows.hpp"

#include <array>
#include <utility>

#include <gtest/gtest.h>

#include "core/rng.hpp"

namespace wellmesh {
namespace {

TEST(CompressedRows, AreListsInTheOrderOfTheEntries) {
    constexpr std::uint32_t kRows = 50;
    std::vector<std::pair<std::uint32_t, int>> entries;
    std::vector<std::vector<int>> lists(kRows);
    for (int i = 0; i < 1000; ++i) {
        const auto row = static_cast<std::uint32_t>(mix64(1, static_cast<std::uint64_t>(i)) % (kRows / 2) * 2);  // odd ones stay empty, the last one among them
        entries.emplace_back(row, i);
        lists[row].push_back(i);
    }
    const CompressedRows<int> rows(kRows, entries);
    for (std::uint32_t r = 0; r < kRows; ++r) EXPECT_EQ(std::vector<int>(rows[r].begin(), rows[r].end()), lists[r]) << r;
}

TEST(CompressedRows, MayBeEmpty) {
    const CompressedRows<std::uint32_t> rows(2, std::vector<std::array<std::uint32_t, 2>>{});
    EXPECT_TRUE(rows[0].empty());
    EXPECT_TRUE(rows[1].empty());
}

}  // namespace
}  // namespace wellmesh
