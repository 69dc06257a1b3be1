// SPDX-License-Identifier: Apache-2.0
#include "core/rng.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstdint>

namespace wellmesh {
namespace {

/// First outputs of SplitMix64 with seed 1234567: the published reference sequence (state advances by the golden gamma).
TEST(Rng, IsSplitMix64) {
    const std::uint64_t gamma = 0x9e3779b97f4a7c15ULL;
    const std::array<std::uint64_t, 5> expected{6457827717110365317ULL, 3203168211198807973ULL, 9817491932198370423ULL,
                                                4593380528125082431ULL, 16408922859458223821ULL};
    for (std::uint64_t i = 0; i < expected.size(); ++i) EXPECT_EQ(mix64(1234567 + i * gamma), expected[i]) << i;
}

TEST(Rng, KeysMatterInOrder) {
    EXPECT_NE(mix64(1, 2), mix64(2, 1));
    EXPECT_EQ(mix64(1, 2), mix64(1, 2));
}

TEST(Rng, UnitDoublesFillTheInterval) {
    EXPECT_EQ(unit_double(0), 0.0);
    EXPECT_EQ(unit_double(~std::uint64_t{0}), 1 - 0x1p-53);
    double sum = 0;
    std::array<int, 10> bins{};
    constexpr int kDraws = 100'000;
    for (std::uint64_t i = 0; i < kDraws; ++i) {
        const double u = unit_double(mix64(42, i));
        sum += u;
        ++bins[static_cast<std::size_t>(10 * u)];
    }
    EXPECT_NEAR(sum / kDraws, 0.5, 0.005);                                   // 5 standard deviations: 5 sqrt(1/12) / sqrt(n) = 0.0046
    for (const int count : bins) EXPECT_NEAR(count, kDraws / 10, 500);       // 5 sqrt(0.1 * 0.9 n) = 474
}

/// One changed key bit changes about half of the output.
TEST(Rng, Avalanche) {
    int changed = 0, cases = 0;
    for (std::uint64_t i = 0; i < 1000; ++i)
        for (int bit = 0; bit < 64; bit += 7, ++cases) changed += std::popcount(mix64(i) ^ mix64(i ^ (std::uint64_t{1} << bit)));
    EXPECT_NEAR(static_cast<double>(changed) / cases, 32, 0.5);
}

}  // namespace
}  // namespace wellmesh
