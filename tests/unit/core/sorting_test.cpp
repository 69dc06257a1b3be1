// SPDX-License-Identifier: Apache-2.0
#include "core/sorting.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/rng.hpp"

namespace wellmesh {
namespace {

TEST(SortOn, SortsForAnySizeAndNumberOfThreads) {
    for (const unsigned threads : {1U, 2U, 3U, 5U, 8U}) {
        Workers workers(threads);
        for (const std::size_t n : {0U, 1U, 8191U, 8192U, 8193U, 50'000U}) {
            std::vector<std::uint64_t> values(n);
            for (std::size_t i = 0; i < n; ++i) values[i] = mix64(n, i) % 1000;
            std::vector<std::uint64_t> expected = values;
            std::sort(expected.begin(), expected.end(), std::greater<>());
            sort_on(workers, std::span(values), std::greater<>());
            EXPECT_EQ(values, expected) << n << " on " << threads;
        }
    }
}

}  // namespace
}  // namespace wellmesh
