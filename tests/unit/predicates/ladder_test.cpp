// SPDX-License-Identifier: Apache-2.0
// Every rung of every predicate against big integers, and which rung decides what.
#include "ladder_check.hpp"
#include "oracle/rational_predicates.hpp"

namespace wellmesh::test {
namespace {

TEST(Orient3dLadder, EveryRungAgreesWithTheOracle) {
    const auto counts = check_ladder(
        400'000, [](const Quintuple& q) { return decide_orient3d(q[0], q[1], q[2], q[3]); },
        [](Rung rung, const Quintuple& q) { return orient3d_rung(rung, q[0], q[1], q[2], q[3]); },
        [](const Quintuple& q) { return oracle::orient3d(q[0], q[1], q[2], q[3]); });
    EXPECT_GT(share(counts.at("uniform"), Rung::forward_bound), 0.9999) << table(counts);
    EXPECT_EQ(share(counts.at("flat"), Rung::forward_bound), 1) << table(counts);  // zero by its permanent
    EXPECT_EQ(counts.at("flat").zeros, counts.at("flat").cases);
    EXPECT_GT(share(counts.at("small_integers"), Rung::exact_doubles), 0.02) << table(counts);
    EXPECT_GT(share(counts.at("integers_and_specks"), Rung::exact), 0.02) << table(counts);
    EXPECT_GT(share(counts.at("slanted_plane"), Rung::double_double), 0.4) << table(counts);
    EXPECT_GT(share(counts.at("coplanar_lattice"), Rung::exact), 0.9) << table(counts);
    EXPECT_GT(total(counts, Rung::exact), 10'000U) << table(counts);
}

TEST(InsphereLadder, EveryRungAgreesWithTheOracle) {
    const auto counts = check_ladder(
        300'000, [](const Quintuple& q) { return decide_insphere(q[0], q[1], q[2], q[3], q[4]); },
        [](Rung rung, const Quintuple& q) { return insphere_rung(rung, q[0], q[1], q[2], q[3], q[4]); },
        [](const Quintuple& q) { return oracle::insphere(q[0], q[1], q[2], q[3], q[4]); });
    EXPECT_GT(share(counts.at("uniform"), Rung::forward_bound), 0.9999) << table(counts);
    EXPECT_EQ(share(counts.at("flat"), Rung::forward_bound), 1) << table(counts);
    EXPECT_GT(share(counts.at("small_integers"), Rung::exact_doubles), 0.02) << table(counts);
    EXPECT_GT(share(counts.at("sphere"), Rung::double_double), 0.9) << table(counts);
    EXPECT_GT(share(counts.at("grid"), Rung::exact), 0.1) << table(counts);
    EXPECT_GT(counts.at("grid").zeros, 1000U) << table(counts);
    EXPECT_GT(total(counts, Rung::exact), 10'000U) << table(counts);
}

TEST(DiametralSphereLadder, EveryRungAgreesWithTheOracle) {
    const auto counts = check_ladder(
        250'000, [](const Quintuple& q) { return decide_side_of_diametral_sphere(q[0], q[1], q[2]); },
        [](Rung rung, const Quintuple& q) { return diametral_rung(rung, q[0], q[1], q[2]); },
        [](const Quintuple& q) { return oracle::side_of_diametral_sphere(q[0], q[1], q[2]); });
    EXPECT_GT(share(counts.at("uniform"), Rung::forward_bound), 0.9999) << table(counts);
    EXPECT_GT(share(counts.at("small_integers"), Rung::exact_doubles), 0.02) << table(counts);
    EXPECT_GT(counts.at("grid").zeros, 1000U) << table(counts);
    EXPECT_GT(total(counts, Rung::double_double), 1000U) << table(counts);
    EXPECT_GT(total(counts, Rung::exact), 1000U) << table(counts);
}

TEST(EquatorialSphereLadder, EveryRungAgreesWithTheOracle) {
    const auto counts = check_ladder(
        150'000, [](const Quintuple& q) { return decide_side_of_equatorial_sphere(q[0], q[1], q[2], q[3]); },
        [](Rung rung, const Quintuple& q) { return equatorial_rung(rung, q[0], q[1], q[2], q[3]); },
        [](const Quintuple& q) { return oracle::side_of_equatorial_sphere(q[0], q[1], q[2], q[3]); });
    EXPECT_GT(share(counts.at("uniform"), Rung::forward_bound), 0.999) << table(counts);
    EXPECT_GT(share(counts.at("small_integers"), Rung::exact_doubles), 0.02) << table(counts);
    EXPECT_GT(counts.at("grid").zeros, 1000U) << table(counts);
    EXPECT_GT(total(counts, Rung::double_double), 1000U) << table(counts);
    EXPECT_GT(total(counts, Rung::exact), 1000U) << table(counts);
}

/// The oracle's integers against real fractions, so that its conversion is not its own witness.
TEST(Oracle, IntegersAgreeWithFractions) {
    using oracle::Rational;
    int zeros = 0;
    for (std::uint64_t i = 0; i < 500; ++i) {
        Random random(99, i);
        const Quintuple q = i % 2 == 0 ? grid(random) : log_uniform_offsets(random);
        std::array<std::array<Rational, 3>, 4> row;
        std::array<Rational, 4> lift;
        for (std::size_t j = 0; j < 4; ++j) {
            row[j] = {Rational(q[j].x) - Rational(q[4].x), Rational(q[j].y) - Rational(q[4].y), Rational(q[j].z) - Rational(q[4].z)};
            lift[j] = row[j][0] * row[j][0] + row[j][1] * row[j][1] + row[j][2] * row[j][2];
        }
        const auto det = [&](std::size_t s, std::size_t t, std::size_t u) -> Rational {
            return row[s][0] * (row[t][1] * row[u][2] - row[t][2] * row[u][1]) - row[s][1] * (row[t][0] * row[u][2] - row[t][2] * row[u][0]) +
                   row[s][2] * (row[t][0] * row[u][1] - row[t][1] * row[u][0]);
        };
        const Rational value = lift[0] * det(1, 2, 3) - lift[1] * det(0, 2, 3) + lift[2] * det(0, 1, 3) - lift[3] * det(0, 1, 2);
        ASSERT_EQ(static_cast<Sign>(value.sign()), oracle::insphere(q[0], q[1], q[2], q[3], q[4])) << describe(q, "oracle", i);
        if (value.is_zero()) ++zeros;
    }
    EXPECT_GT(zeros, 20);
}

TEST(ExactCallCounter, CountsExpansionsOnly) {
    const std::uint64_t before = exact_predicate_calls();
    EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), Sign::positive);
    EXPECT_EQ(orient3d({0, 0, 0}, {1, 2, 3}, {4, 5, 6}, {5, 7, 9}), Sign::zero);
    EXPECT_EQ(exact_predicate_calls(), before);
    const double t = 0.1, u = 0.3;
    EXPECT_EQ(orient3d({t, t, 0}, {u, u, 0}, {t, t, u}, {u, u, t}), Sign::zero);
    EXPECT_EQ(exact_predicate_calls(), before + 1);
}

}  // namespace
}  // namespace wellmesh::test
