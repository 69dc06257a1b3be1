// SPDX-License-Identifier: Apache-2.0
// Weighted predicates: every rung against big integers, laws, and the unweighted predicates where the weights are equal.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "ladder_check.hpp"
#include "oracle/rational_predicates.hpp"

namespace wellmesh::test {
namespace {

using Weighted = std::array<WeightedPoint, 5>;

/// Weights of several kinds for the points of one case: none, equal, as large as squared distances, grid-like, and such that a point is
/// orthogonal to the origin's sphere or a few roundings off: |p|^2 minus the same constant lies on one hyperplane.
Weighted weigh(const Quintuple& q, std::uint64_t number) {
    Random r(77, number);
    const int kind = r.integer(0, 5);
    const double scale = [&] {
        double largest = 0;
        for (const Vec3& p : q)
            for (const Vec3& s : q) largest = std::max({largest, std::fabs(p.x - s.x), std::fabs(p.y - s.y), std::fabs(p.z - s.z)});
        return largest * largest;
    }();
    Weighted result;
    for (std::size_t i = 0; i < 5; ++i) {
        double w = 0;
        const Vec3& p = q[i];
        const double lift = p.x * p.x + p.y * p.y + p.z * p.z;
        switch (kind) {
            case 0: break;
            case 1: w = scale / 4; break;
            case 2: w = scale * r.unit(); break;
            case 3: w = std::ldexp(static_cast<double>(r.integer(-4, 4)), -2) * (scale > 1e-100 ? 1 : 0); break;
            case 4: w = r.bits() % 3 == 0 ? lift : r.bits() % 2 == 0 ? some_ulps_off(r, lift) : 0; break;
            default: w = lift - scale; break;
        }
        result[i] = {p, weight_in_exact_range(w) ? w : 0};
    }
    return result;
}

template <class Decide, class SingleRung, class Oracle>
std::map<std::string, RungCounts> check_weighted_ladder(std::uint64_t cases, Decide decide, SingleRung single_rung, Oracle oracle) {
    std::uint64_t key = 0;
    Weighted current{};
    return check_ladder(
        cases, [&](const Quintuple&) { return decide(current); }, [&](Rung rung, const Quintuple&) { return single_rung(rung, current); },
        [&](const Quintuple& q) {  // called first for each case
            current = weigh(q, ++key);
            return oracle(current);
        });
}

TEST(PowerTestLadder, EveryRungAgreesWithTheOracle) {
    const auto counts = check_weighted_ladder(
        100'000, [](const Weighted& q) { return decide_power_test(q[0], q[1], q[2], q[3], q[4]); },
        [](Rung rung, const Weighted& q) { return power_rung(rung, q[0], q[1], q[2], q[3], q[4]); }, [](const Weighted& q) { return oracle::power_test(q); });
    EXPECT_GT(share(counts.at("uniform"), Rung::forward_bound), 0.8) << table(counts);
    EXPECT_GT(share(counts.at("small_integers"), Rung::exact_doubles), 0.02) << table(counts);
    EXPECT_GT(counts.at("grid").zeros, 500U) << table(counts);
    EXPECT_GT(total(counts, Rung::double_double), 2000U) << table(counts);
    EXPECT_GT(total(counts, Rung::exact), 3000U) << table(counts);
}

TEST(DiametralPowerTestLadder, EveryRungAgreesWithTheOracle) {
    const auto counts = check_weighted_ladder(
        80'000, [](const Weighted& q) { return decide_diametral_power_test(q[0], q[1], q[2]); },
        [](Rung rung, const Weighted& q) { return diametral_power_rung(rung, q[0], q[1], q[2]); },
        [](const Weighted& q) { return oracle::diametral_power_test(q[0], q[1], q[2]); });
    EXPECT_GT(share(counts.at("small_integers"), Rung::exact_doubles), 0.02) << table(counts);
    EXPECT_GT(counts.at("grid").zeros, 300U) << table(counts);
    EXPECT_GT(total(counts, Rung::exact), 500U) << table(counts);
}

TEST(EquatorialPowerTestLadder, EveryRungAgreesWithTheOracle) {
    const auto counts = check_weighted_ladder(
        50'000, [](const Weighted& q) { return decide_equatorial_power_test(q[0], q[1], q[2], q[3]); },
        [](Rung rung, const Weighted& q) { return equatorial_power_rung(rung, q[0], q[1], q[2], q[3]); },
        [](const Weighted& q) { return oracle::equatorial_power_test(q[0], q[1], q[2], q[3]); });
    EXPECT_GT(share(counts.at("small_integers"), Rung::exact_doubles), 0.02) << table(counts);
    EXPECT_GT(counts.at("grid").zeros, 300U) << table(counts);
    EXPECT_GT(total(counts, Rung::exact), 500U) << table(counts);
}

TEST(PowerTest, ConventionsByHand) {
    const Vec3 o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, far{1, 1, 1};
    EXPECT_EQ(power_test({o}, {x}, {y}, {z}, {far}), Sign::zero);
    EXPECT_EQ(power_test({o}, {x}, {y}, {z}, {far, 1e-6}), Sign::positive);   // a heavier point reaches farther
    EXPECT_EQ(power_test({o}, {x}, {y}, {z}, {far, -1e-6}), Sign::negative);
    EXPECT_EQ(power_test({o, 0.1}, {x}, {y}, {z}, {far}), Sign::positive);    // its opposite corner's weight pulls the sphere towards it:
    EXPECT_EQ(power_test({o}, {x, 0.1}, {y}, {z}, {far}), Sign::negative);    // lifts of o and far stand against those of the other three
    EXPECT_EQ(power_test({x}, {o}, {y}, {z}, {far, 1e-6}), Sign::negative);   // of a negative tetrahedron
    EXPECT_EQ(diametral_power_test({o}, {{2, 0, 0}}, {{1, 1, 0}}), Sign::zero);
    EXPECT_EQ(diametral_power_test({o}, {{2, 0, 0}}, {{1, 1, 0}, 0.01}), Sign::positive);
    EXPECT_EQ(diametral_power_test({o, 1}, {{2, 0, 0}, 1}, {{1, 1, 0}, 0.99}), Sign::negative);  // only differences count
    EXPECT_EQ(equatorial_power_test({o}, {{2, 0, 0}}, {{0, 2, 0}}, {{2, 2, 0}}), Sign::zero);
    EXPECT_EQ(equatorial_power_test({o}, {{2, 0, 0}}, {{0, 2, 0}}, {{1, 1, 1.5}, 0.2}), Sign::negative);
    EXPECT_EQ(equatorial_power_test({o}, {{2, 0, 0}}, {{0, 2, 0}}, {{1, 1, 1.5}, 0.3}), Sign::positive);
}

TEST(PowerTest, EqualWeightsAreNoWeights) {
    std::uint64_t stream = 500;
    for (const Family& family : kFamilies) {
        ++stream;
        if (std::string(family.name).find("range") != std::string::npos) continue;  // 1 is beyond the weights' differences there
        for (std::uint64_t i = 0; i < 300; ++i) {
            Random random(stream, i);
            const Quintuple q = family.generate(random);
            const double w = i % 2 == 0 ? 0 : 1;
            ASSERT_EQ(power_test({q[0], w}, {q[1], w}, {q[2], w}, {q[3], w}, {q[4], w}), insphere(q[0], q[1], q[2], q[3], q[4]));
            ASSERT_EQ(equatorial_power_test({q[0], w}, {q[1], w}, {q[2], w}, {q[3], w}), side_of_equatorial_sphere(q[0], q[1], q[2], q[3]));
            if (q[0] != q[1]) {
                ASSERT_EQ(diametral_power_test({q[0], w}, {q[1], w}, {q[2], w}), side_of_diametral_sphere(q[0], q[1], q[2]));
            }
        }
    }
}

/// The static filter with the tightest box and weights, and the ends of the range.
TEST(PowerTest, FilterNeverErrs) {
    int cases = 0, decided = 0;
    std::uint64_t stream = 600, key = 1'000'000;
    for (const Family& family : kFamilies) {
        ++stream;
        const auto n = static_cast<std::uint64_t>(40'000 * family.share);
        for (std::uint64_t i = 0; i < n; ++i, ++cases) {
            Random random(stream, i);
            const Weighted q = weigh(family.generate(random), ++key);
            Vec3 low = q[0].point, high = low;
            double least = q[0].weight, most = least;
            for (const WeightedPoint& p : q) {
                low = {std::min(low.x, p.point.x), std::min(low.y, p.point.y), std::min(low.z, p.point.z)};
                high = {std::max(high.x, p.point.x), std::max(high.y, p.point.y), std::max(high.z, p.point.z)};
                least = std::min(least, p.weight);
                most = std::max(most, p.weight);
            }
            const PredicateFilter filter(Vec3{high.x - low.x, high.y - low.y, high.z - low.z}, most - least);
            const Decision decision = decide_power_test(filter, q[0], q[1], q[2], q[3], q[4]);
            ASSERT_EQ(decision.sign, oracle::power_test(q)) << family.name << " " << i;
            ASSERT_EQ(filter.power_test(q[0], q[1], q[2], q[3], q[4]), decision.sign);
            decided += decision.rung == Rung::static_filter;
        }
    }
    EXPECT_GT(decided, cases / 4);
}

/// The least weight counts against the largest coordinates, and the largest weight is no overflow.
TEST(PowerTest, WeightsAtBothEndsOfTheRange) {
    EXPECT_TRUE(weight_in_exact_range(0));
    EXPECT_TRUE(weight_in_exact_range(-kMinWeight));
    EXPECT_FALSE(weight_in_exact_range(kMinWeight / 2));
    EXPECT_FALSE(weight_in_exact_range(std::nan("")));
    for (const double scale : {kMinMagnitude, 1.0, kMaxMagnitude}) {
        const Vec3 o{0, 0, 0}, x{scale, 0, 0}, y{0, scale, 0}, z{0, 0, scale}, far{scale, scale, scale};
        for (const double w : {kMinWeight, -kMinWeight, kMaxWeight, -kMaxWeight}) {
            const Sign expected = w > 0 ? Sign::positive : Sign::negative;
            EXPECT_EQ(power_test({o}, {x}, {y}, {z}, {far, w}), expected) << scale << " " << w;
            EXPECT_EQ(*power_rung(Rung::exact, {o}, {x}, {y}, {z}, {far, w}), expected);
            EXPECT_EQ(*equatorial_power_rung(Rung::exact, {o}, {x}, {y}, {{scale, scale, 0}, w}), expected);
            EXPECT_EQ(*diametral_power_rung(Rung::exact, {o}, {{scale, scale, 0}}, {x, w}), expected);
        }
    }
}

}  // namespace
}  // namespace wellmesh::test
