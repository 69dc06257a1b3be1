// SPDX-License-Identifier: Apache-2.0
// Fails if the compiler fused multiplications and additions, in the library or in the headers that tests compile themselves.
#include "predicates/fp_environment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/rng.hpp"
#include "predicates/expansion.hpp"

namespace wellmesh {
namespace {

// (1 + 2^-30)^2 = 1 + 2^-29 + 2^-60: the last bit does not fit into 53, so rounding drops it and only a fused operation sees it.
constexpr double kFactor = 1 + 0x1p-30;
constexpr double kRoundedSquare = 1 + 0x1p-29;

TEST(FloatingPointEnvironment, LibraryDoesNotFuse) {
    EXPECT_EQ(multiply_then_subtract(kFactor, kFactor, kRoundedSquare), 0.0);
}

TEST(FloatingPointEnvironment, HeadersDoNotFuse) {
    volatile double factor = kFactor, rounded_square = kRoundedSquare;  // keeps the compiler from evaluating at compile time
    const double x = factor, z = rounded_square;
    EXPECT_EQ(x * x - z, 0.0);
}

/// The consequence: error terms of Dekker's product in both places, recomputed with integers. With 53-bit integers x and y the
/// error of the rounded product is an integer below 2^53, so it is known from its value modulo 2^64.
TEST(FloatingPointEnvironment, ProductErrorTermsAreExact) {
    int inexact = 0;
    for (std::uint64_t i = 0; i < 10'000; ++i) {
        const std::uint64_t x = mix64(i) >> 11 | 1, y = mix64(i, 1) >> 11 | 1;
        const double left = static_cast<double>(x), right = static_cast<double>(y), rounded = left * right;
        int exponent = 0;
        const auto digits = static_cast<std::uint64_t>(std::ldexp(std::frexp(rounded, &exponent), 53));
        const std::uint64_t rounded_modulo = exponent >= 53 ? digits << (exponent - 53) : digits >> (53 - exponent);
        const auto error = static_cast<double>(static_cast<std::int64_t>(x * y - rounded_modulo));

        const TwoTerms product = two_product(left, right);
        ASSERT_EQ(product.high, rounded);
        ASSERT_EQ(product.low, error);
        double components[2] = {};
        const std::size_t size = multiply_expansions(&left, 1, &right, 1, components);
        ASSERT_EQ(components[size - 1], rounded);
        ASSERT_EQ(size == 2 ? components[0] : 0.0, error);
        inexact += error != 0;
    }
    EXPECT_GT(inexact, 9'000);
}

/// Rounding is to nearest, ties to even, also at run time.
TEST(FloatingPointEnvironment, RoundsToNearestEven) {
    volatile double one = 1;
    EXPECT_EQ(one + 0x1p-53, 1.0);
    EXPECT_EQ((one + 0x1p-52) + 0x1p-53, 1 + 0x1p-51);
    EXPECT_EQ(-one - 0x1p-53, -1.0);
}

}  // namespace
}  // namespace wellmesh
