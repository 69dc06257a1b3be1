// SPDX-License-Identifier: Apache-2.0
// Every inequality of the paper's sections 4 and 5 at its limit and on both sides of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "theory/constants.hpp"

namespace wellmesh::testing {
namespace {

bool names(const std::vector<std::string>& problems, const std::string& part) {
    return std::any_of(problems.begin(), problems.end(), [&](const std::string& p) { return p.find(part) != std::string::npos; });
}

const TheoryConstants kGood{0.05, 4.5, 20, 0.01};

TEST(Constants, TheDefaultsSatisfyEverything) {
    EXPECT_EQ(check(kGood), std::vector<std::string>{});
    const DensityBounds d = density_bounds(kGood);
    EXPECT_EQ(unsatisfied(d, kGood), std::vector<std::string>{});
    EXPECT_NEAR(d.d1, 131, 1);  // worked out by hand for the design
}

TEST(Constants, NonsenseIsNamedWithItsRange) {
    const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {0.0, -0.1, 1.0, 1.5, nan, infinity, -infinity}) EXPECT_TRUE(names(check({bad, 4.5, 20, 0.01}), "delta must be above 0 and below 1")) << bad;
    for (const double bad : {0.0, -1.0, nan, infinity}) {
        EXPECT_TRUE(names(check({0.05, bad, 20, 0.01}), "b must be a finite number above 0")) << bad;
        EXPECT_TRUE(names(check({0.05, 4.5, bad, 0.01}), "must be a finite number above 0")) << bad;
        EXPECT_TRUE(names(check({0.05, 4.5, 20, bad}), "sigma0 must be above 0")) << bad;
    }
    EXPECT_TRUE(names(check({0.05, 4.5, 20, 0.118}), "sigma0"));
    EXPECT_TRUE(check({0.05, 4.5, 20, kLargestSigma}).empty());
    EXPECT_EQ(check({nan, nan, nan, nan}).size(), 4U);
}

/// delta = 1/2 makes all limits exact in doubles.
TEST(Constants, EachInequalityAtItsLimit) {
    const double up = 1 + 0x1p-40, down = 1 - 0x1p-40;
    const auto with = [](double b, double rho0) { return check({0.5, b, rho0, 0.01}); };
    EXPECT_TRUE(names(with(60, 4 * down), "(Lemma 4.3)"));
    EXPECT_FALSE(names(with(60, 4), "(Lemma 4.3)"));
    EXPECT_FALSE(names(with(60, 4 * up), "(Lemma 4.3)"));
    EXPECT_TRUE(names(with(60, 32 * down), "(1 - delta)^2 rho0 >= 8 (Theorem 4.2)"));
    EXPECT_FALSE(names(with(60, 32), "(1 - delta)^2 rho0 >= 8"));
    EXPECT_FALSE(names(with(60, 32 * up), "(1 - delta)^2 rho0 >= 8"));
    EXPECT_TRUE(names(with(8 * down, 6000), "(1 - delta) b >= 4 (Theorem 4.2)"));
    EXPECT_FALSE(names(with(8, 6000), "(1 - delta) b >= 4"));
    EXPECT_FALSE(names(with(8 * up, 6000), "(1 - delta) b >= 4"));
    // alpha = 3: the grading inequalities are strict.
    EXPECT_TRUE(names(with(60, 5832 * down), "rho0 > 8"));
    EXPECT_TRUE(names(with(60, 5832), "rho0 > 8"));
    EXPECT_TRUE(with(60, 5832 * up).empty());
    EXPECT_TRUE(names(with(54 * down, 6000), "b > 2"));
    EXPECT_TRUE(names(with(54, 6000), "b > 2"));
    EXPECT_TRUE(with(54 * up, 6000).empty());
}

TEST(Constants, TheMessageSaysTheNumbersAndWhatWouldDo) {
    const auto problems = check({0.05, 4.5, 8, 0.01});
    EXPECT_TRUE(names(problems, "7.22 with delta = 0.05, b = 4.5, rho0 = 8; rho0 must be at least 8.8643")) << problems[0];
    // The delta that a message offers works.
    const auto offered = check({0.2, 4.5, 20, 0.01});
    ASSERT_FALSE(offered.empty());
    double least = 1;
    for (const std::string& p : offered)
        if (const auto at = p.find("delta at most "); at != std::string::npos) least = std::min(least, std::stod(p.substr(at + 14)));
    EXPECT_TRUE(check({least, 4.5, 20, 0.01}).empty()) << least;
}

/// The closed form is a solution of (5.1)-(5.8), and the least: iterating the inequalities from below comes to it.
TEST(Constants, DensityBoundsAreTheLeastFixedPoint) {
    for (const TheoryConstants& c : {kGood, TheoryConstants{0.1, 5, 60, 0.01}, TheoryConstants{0.2, 8, 200, 0.01}, TheoryConstants{0.05, 4.3, 15, 0.01}, TheoryConstants{0.3, 14, 400, 0.01}}) {
        const DensityBounds d = density_bounds(c);
        EXPECT_TRUE(unsatisfied(d, c).empty());
        const double a = c.alpha(), a2 = a * a, a3 = a2 * a, a4 = a3 * a, root2 = std::sqrt(2.0);
        double d1 = 1, d2 = 1, d3 = 1;
        for (unsigned i = 0; i < 20000; ++i) {
            const double most = std::max({d1, d2, d3});
            d3 = std::max({1.0, a + most / ((1 - c.delta) * c.rho0), a + std::sqrt(3.0) / (1 - c.delta), a + a * d3 / c.b, a + 2 * a2 + 2 * a2 * most / c.rho0,
                           a + a * std::max(d1, d2) / c.b, a + 2 * a2 + 2 * root2 * a3 + 4 * a4 + 4 * a4 * most / c.rho0});
            d2 = a + root2 * a * d3;
            d1 = a + root2 * a * std::max(d2, d3);
        }
        EXPECT_NEAR(d.d3, d3, 1e-6 * d3);
        EXPECT_NEAR(d.d2, d2, 1e-6 * d2);
        EXPECT_NEAR(d.d1, d1, 1e-6 * d1);
    }
    EXPECT_TRUE(std::isinf(density_bounds({0.3, 14, 2, 0.01}).largest()));
    DensityBounds less = density_bounds(kGood);
    less.d3 *= 0.999;
    EXPECT_FALSE(unsatisfied(less, kGood).empty());
}

/// The existence theorem's sigma0 is some 10^-65000 at rho0 = 2 and 10^-10000 at rho0 = 1.
TEST(Constants, ExistenceSigmaIsBeyondDoubles) {
    EXPECT_NEAR(log10_existence_sigma({0.3, 5.7, 2, 0.01}), -65000, 1000);
    EXPECT_NEAR(log10_existence_sigma({0.3, 5.7, 1, 0.01}), -10000, 2000);
    const double at_default = log10_existence_sigma(kGood);
    EXPECT_TRUE(std::isfinite(at_default));
    EXPECT_LT(at_default, -1e6);
    EXPECT_LT(log10_existence_sigma({0.05, 4.5, 21, 0.01}), at_default);
}

TEST(Constants, FactorsOfLemma51) {
    EXPECT_DOUBLE_EQ(insertion_factor(1, kGood), 19);
    EXPECT_DOUBLE_EQ(insertion_factor(2, kGood), 0.95 / std::sqrt(3.0));
    EXPECT_DOUBLE_EQ(insertion_factor(3, kGood), 0.95 / 1.05 * 4.5);
    EXPECT_DOUBLE_EQ(insertion_factor(5, kGood), insertion_factor(3, kGood));
    EXPECT_DOUBLE_EQ(insertion_factor(4, kGood), 0.475);
    EXPECT_DOUBLE_EQ(insertion_factor(6, kGood), 0.475);
    EXPECT_DOUBLE_EQ(insertion_factor(7, kGood), 0.95 / 1.05 / std::sqrt(2.0));
}

}  // namespace
}  // namespace wellmesh::testing
