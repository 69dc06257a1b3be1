// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "ladder_check.hpp"
#include "oracle/rational_predicates.hpp"
#include "predicates/precise_inspheres.hpp"

namespace wellmesh::test {
namespace {

/// Extents of the smallest box of the five points, the tightest bound that anyone may ask for.
Vec3 extents(const Quintuple& q) {
    Vec3 low = q[0], high = q[0];
    for (const Vec3& p : q) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    return {high.x - low.x, high.y - low.y, high.z - low.z};
}

/// As insphere_lanes.hpp wants points; what is behind them must not matter, signalling NaNs least of all.
struct alignas(32) Padded {
    Vec3 point;
    double behind = std::numeric_limits<double>::signaling_NaN();
};

/// Where no filter's slack hides a wrong minor: grid points, for which all arithmetic is exact.
TEST(PredicateFilter, LanesComputeTheSamePolynomial) {
    if (!has_insphere_lanes()) GTEST_SKIP() << "no AVX2 on this machine";
    for (std::uint64_t i = 0; i < 20'000; ++i) {
        Random r(400, i);
        Padded p[5];
        for (Padded& q : p) q.point = r.point([&] { return std::floor(64 * r.unit()); });
        ASSERT_EQ(insphere_value_in_lanes(p[0].point, p[1].point, p[2].point, p[3].point, p[4].point),
                  PredicateFilter::insphere_value(p[0].point, p[1].point, p[2].point, p[3].point, p[4].point));
    }
}

/// The same for corners by number, and for any number of tetrahedra.
TEST(PredicateFilter, RecordsComputeTheSamePolynomial) {
    const PredicateFilter filter;
    for (std::uint64_t i = 0; i < 2'000; ++i) {
        Random r(401, i);
        std::array<Padded, 12> p;
        for (Padded& q : p) q.point = r.point([&] { return std::floor(64 * r.unit()); });
        std::vector<RecordNumbers> tets(1 + i % 9);
        for (RecordNumbers& t : tets)
            for (std::uint32_t& corner : t) corner = static_cast<std::uint32_t>(11 * r.unit());
        std::vector<double> values(tets.size() + 3);
        filter.insphere_values_of({&p[0].point}, tets, p[11].point, values.data());
        for (std::size_t k = 0; k < tets.size(); ++k) {
            const auto& [a, b, c, d] = tets[k];
            ASSERT_EQ(values[k], PredicateFilter::insphere_value(p[a].point, p[b].point, p[c].point, p[d].point, p[11].point));
        }
    }
}

TEST(PredicateFilter, NeverErrsWithTheTightestBox) {
    int cases = 0, orient3d_decided = 0, insphere_decided = 0, own_decided = 0;
    std::uint64_t stream = 200;
    for (const Family& family : kFamilies) {
        ++stream;
        const auto n = static_cast<std::uint64_t>(60'000 * family.share);
        for (std::uint64_t i = 0; i < n; ++i) {
            Random random(stream, i);
            const Quintuple q = family.generate(random);
            const auto& [a, b, c, d, e] = q;
            const PredicateFilter filter(extents(q));
            const Decision orientation = decide_orient3d(filter, a, b, c, d), side = decide_insphere(filter, a, b, c, d, e);
            ASSERT_EQ(orientation.sign, oracle::orient3d(a, b, c, d)) << describe(q, family.name, i);
            ASSERT_EQ(side.sign, oracle::insphere(a, b, c, d, e)) << describe(q, family.name, i);
            ASSERT_EQ(filter.orient3d(a, b, c, d), orientation.sign);
            ASSERT_EQ(filter.insphere(a, b, c, d, e), side.sign);
            ASSERT_EQ(filter.insphere_perturbed(a, b, c, d, e), insphere_perturbed(a, b, c, d, e));
            // The box of all points leaves it to that of these.
            const Sign own = PredicateFilter::insphere_within_own_box(a, b, c, d, e);
            ASSERT_TRUE(own == Sign::zero || own == side.sign) << describe(q, family.name, i);
            own_decided += own != Sign::zero;
            ASSERT_EQ(PredicateFilter().insphere(a, b, c, d, e), side.sign) << describe(q, family.name, i);
            ASSERT_EQ(PredicateFilter().insphere_perturbed(a, b, c, d, e), insphere_perturbed(a, b, c, d, e)) << describe(q, family.name, i);
            const Padded padded[4] = {{a}, {b}, {c}, {d}};
            double value[4];
            const std::array<RecordNumbers, 1> corners{{{0, 1, 2, 3}}};
            filter.insphere_values_of({&padded[0].point}, corners, e, value);
            ASSERT_EQ(filter.insphere_perturbed_of_value(value[0], {&a, &b, &c, &d}, e), insphere_perturbed(a, b, c, d, e)) << describe(q, family.name, i);
            ASSERT_EQ(filter.insphere_perturbed_padded(padded[0].point, padded[1].point, padded[2].point, padded[3].point, e), insphere_perturbed(a, b, c, d, e))
                << describe(q, family.name, i);
            ++cases;
            orient3d_decided += orientation.rung == Rung::static_filter;
            insphere_decided += side.rung == Rung::static_filter;
        }
    }
    EXPECT_GT(orient3d_decided, cases / 4);
    EXPECT_GT(insphere_decided, cases / 4);
    EXPECT_GT(own_decided, cases / 4);
}

/// Right or silent, whichever lane it is, and silent of few but ties. Lanes have different tetrahedra: any of a case's points and of the same with x and y exchanged.
TEST(PreciseInspheres, NeverErrAndDecideMost) {
    if (!has_insphere_lanes()) GTEST_SKIP() << "no such processor";
    std::size_t not_zero = 0, decided = 0;
    std::uint64_t stream = 500;
    for (const Family& family : kFamilies) {
        ++stream;
        const auto n = static_cast<std::uint64_t>(20'000 * family.share);
        for (std::uint64_t i = 0; i < n; ++i) {
            Random random(stream, i);
            const Quintuple q = family.generate(random);
            std::array<Padded, 8> p;
            for (std::size_t k = 0; k < 4; ++k) {
                p[k].point = q[k];
                p[k + 4].point = q[k];
                std::swap(p[k + 4].point.x, p[k + 4].point.y);
            }
            std::vector<RecordNumbers> tets(1 + i % 9);
            for (RecordNumbers& t : tets)
                for (std::size_t k = 0; k < 4; ++k)
                    do t[k] = static_cast<std::uint32_t>(random.integer(0, 7));
                    while (std::find(t.begin(), t.begin() + static_cast<std::ptrdiff_t>(k), t[k]) != t.begin() + static_cast<std::ptrdiff_t>(k));
            tets.back() = {0, 1, 2, 3};
            std::vector<double> signs(tets.size() + 3, -7);
            insphere_signs_of_records({&p[0].point}, tets, q[4], signs.data());
            for (std::size_t k = 0; k < tets.size(); ++k) {
                const auto& [a, b, c, d] = tets[k];
                const double sure = static_cast<double>(static_cast<int>(oracle::insphere(p[a].point, p[b].point, p[c].point, p[d].point, q[4])));
                ASSERT_TRUE(signs[k] == 0 || signs[k] == sure) << describe(q, family.name, i) << signs[k];
                not_zero += sure != 0;
                decided += signs[k] != 0;
            }
        }
    }
    EXPECT_GT(decided, not_zero * 3 / 4);  // families are full of ties that are a few ulps off
}

/// What the kernel sees: neighbouring points, as far apart as in a mesh of 100,000 points. (Random quintuples of them are far
/// worse shaped than Delaunay tetrahedra, so these rates are upper bounds; with a million points the box's bound is weaker.)
TEST(PredicateFilter, SeldomFailsOnRandomNeighbours) {
    const PredicateFilter filter(Vec3{1, 1, 1});
    int orient3d_failed = 0, insphere_failed = 0;
    constexpr int kCases = 100'000;
    for (std::uint64_t i = 0; i < kCases; ++i) {
        Random r(300, i);
        const Vec3 corner = r.point([&] { return 0.98 * r.unit(); });
        Quintuple q;
        for (Vec3& p : q) p = {corner.x + 0.02 * r.unit(), corner.y + 0.02 * r.unit(), corner.z + 0.02 * r.unit()};
        orient3d_failed += decide_orient3d(filter, q[0], q[1], q[2], q[3]).rung != Rung::static_filter;
        insphere_failed += decide_insphere(filter, q[0], q[1], q[2], q[3], q[4]).rung != Rung::static_filter;
    }
    EXPECT_LT(orient3d_failed, kCases / 1000);
    EXPECT_LT(insphere_failed, kCases / 50);
}

TEST(PredicateFilter, DefaultAndMeaninglessBoxesNeverDecide) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0}, d{0, 0, 1}, e{0.25, 0.25, 0.25};
    for (const PredicateFilter& filter : {PredicateFilter(), PredicateFilter({nan, 1, 1}), PredicateFilter({1, infinity, 1})}) {
        EXPECT_EQ(decide_orient3d(filter, a, b, c, d).rung, Rung::forward_bound);
        EXPECT_EQ(decide_insphere(filter, a, b, c, d, e).rung, Rung::forward_bound);
        EXPECT_EQ(filter.orient3d(a, b, c, d), Sign::positive);
        EXPECT_EQ(filter.insphere(a, b, c, d, e), Sign::positive);
    }
}

/// All points in one axis-parallel plane: zero without any expansion, with and without a box that knows.
TEST(PredicateFilter, FlatBoxIsDecidedCheaply) {
    const std::uint64_t before = exact_predicate_calls();
    for (const PredicateFilter& filter : {PredicateFilter(Vec3{1, 1, 0}), PredicateFilter(Vec3{1, 1, 1})})
        for (std::uint64_t i = 0; i < 1000; ++i) {
            Random r(310, i);
            Quintuple q = uniform(r);
            for (Vec3& p : q) p.z = 0.3;
            ASSERT_EQ(filter.orient3d(q[0], q[1], q[2], q[3]), Sign::zero);
            ASSERT_EQ(decide_orient3d(filter, q[0], q[1], q[2], q[3]).rung, Rung::forward_bound);
            ASSERT_EQ(decide_insphere(filter, q[0], q[1], q[2], q[3], q[4]).rung, Rung::forward_bound);
        }
    EXPECT_EQ(exact_predicate_calls(), before);
}

TEST(PredicateFilter, ForwardsTheSphereTests) {
    const PredicateFilter filter(Vec3{4, 4, 4});
    EXPECT_EQ(filter.side_of_diametral_sphere({0, 0, 0}, {2, 0, 0}, {1, 0.5, 0}), Sign::positive);
    EXPECT_EQ(filter.side_of_equatorial_sphere({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {1, 1, 1}), Sign::positive);
}

}  // namespace
}  // namespace wellmesh::test
