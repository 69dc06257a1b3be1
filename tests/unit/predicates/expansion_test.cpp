// SPDX-License-Identifier: Apache-2.0
#include "predicates/expansion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "oracle/rational_predicates.hpp"
#include "point_families.hpp"

namespace wellmesh::test {
namespace {

using oracle::Rational;

Rational value_of(const TwoTerms& t) { return Rational(t.high) + Rational(t.low); }

Rational value_of(const double* components, std::size_t n) {
    Rational sum = 0;
    for (std::size_t i = 0; i < n; ++i) sum += Rational(components[i]);
    return sum;
}

/// Exponents of the highest and of the lowest set bit.
int highest_bit(double value) { return std::ilogb(value); }
int lowest_bit_of(double value) {
    int exponent = std::ilogb(value);
    while (std::ldexp(value, -exponent) != std::trunc(std::ldexp(value, -exponent))) --exponent;
    return exponent;
}

/// Non-zero, increasing, with at least one zero bit between neighbours; the last one is the value up to an ulp.
void expect_compressed(const double* components, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) ASSERT_NE(components[i], 0.0);
    for (std::size_t i = 1; i < n; ++i) ASSERT_GE(lowest_bit_of(components[i]), highest_bit(components[i - 1]) + 2);
    if (n > 1) {
        const Rational rest = value_of(components, n - 1);
        ASSERT_LE(abs(rest), Rational(std::ldexp(1.0, highest_bit(components[n - 1]) - 52)));
    }
}

double any_double(Random& r) { return r.sign() * (1 + r.unit()) * std::ldexp(1.0, r.integer(-60, 60)); }

TEST(ErrorFreeTransformations, AreErrorFree) {
    int inexact_sums = 0, inexact_products = 0;
    for (std::uint64_t i = 0; i < 20'000; ++i) {
        Random r(7, i);
        const double a = any_double(r), b = r.bits() % 8 == 0 ? a : any_double(r);
        const TwoTerms sum = two_sum(a, b), difference = two_difference(a, b), product = two_product(a, b), halves = split_in_halves(a);
        ASSERT_EQ(sum.high, a + b);
        ASSERT_EQ(value_of(sum), Rational(a) + Rational(b));
        ASSERT_EQ(value_of(difference), Rational(a) - Rational(b));
        ASSERT_EQ(product.high, a * b);
        ASSERT_EQ(value_of(product), Rational(a) * Rational(b));
        ASSERT_EQ(halves.high + halves.low, a);
        const TwoTerms fast = std::fabs(a) >= std::fabs(b) ? fast_two_sum(a, b) : fast_two_sum(b, a);
        ASSERT_EQ(fast.low, sum.low);
        inexact_sums += sum.low != 0;
        inexact_products += product.low != 0;
    }
    EXPECT_GT(inexact_sums, 10'000);
    EXPECT_GT(inexact_products, 19'000);
}

TEST(Expansions, SumsAndProductsAreExactAndCompressed) {
    std::size_t longest = 0;
    int zeros = 0;
    for (std::uint64_t i = 0; i < 4'000; ++i) {
        Random r(8, i);
        const auto make = [&] {
            Expansion<8> sum;  // 1 to 8 summands
            for (int n = r.integer(1, 8); n > 0; --n) sum = Expansion<8>::sum(sum, Expansion<1>(any_double(r)), 1);
            return sum;
        };
        const Expansion<8> e = make(), f = r.bits() % 16 == 0 ? e : make();
        const Rational e_value = value_of(e.data(), e.size()), f_value = value_of(f.data(), f.size());
        const auto sum = e + f;
        const auto difference = e - f;
        const auto product = e * f;
        const auto square_of_sum = sum * sum;
        ASSERT_EQ(value_of(sum.data(), sum.size()), e_value + f_value);
        ASSERT_EQ(value_of(difference.data(), difference.size()), e_value - f_value);
        ASSERT_EQ(value_of(product.data(), product.size()), e_value * f_value);
        ASSERT_EQ(value_of(square_of_sum.data(), square_of_sum.size()), (e_value + f_value) * (e_value + f_value));
        ASSERT_EQ(static_cast<int>(difference.sign()), Rational(e_value - f_value).sign());
        expect_compressed(sum.data(), sum.size());
        expect_compressed(difference.data(), difference.size());
        expect_compressed(product.data(), product.size());
        expect_compressed(square_of_sum.data(), square_of_sum.size());
        longest = std::max(longest, square_of_sum.size());
        zeros += difference.size() == 0;
    }
    EXPECT_GT(longest, 5U);  // nearly 500 bits
    EXPECT_GT(zeros, 100);
}

TEST(Expansions, ZeroIsEmpty) {
    const Expansion<1> zero(0.0), one(1.0);
    EXPECT_EQ(zero.size(), 0U);
    EXPECT_EQ((zero * one).size(), 0U);
    EXPECT_EQ((one * zero).size(), 0U);
    EXPECT_EQ((zero + zero).sign(), Sign::zero);
    EXPECT_EQ((zero - one).sign(), Sign::negative);
    EXPECT_EQ(Expansion<2>(TwoTerms{1.0, 0x1p-60}).size(), 2U);
}

}  // namespace
}  // namespace wellmesh::test
