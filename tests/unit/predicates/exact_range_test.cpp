// SPDX-License-Identifier: Apache-2.0
// The ends of the admitted range: what exact_range.hpp derives, met by configurations that need the last bit.
#include "predicates/exact_range.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "oracle/rational_predicates.hpp"
#include "point_families.hpp"
#include "predicates/predicates_internal.hpp"

namespace wellmesh::test {
namespace {

TEST(ExactRange, Membership) {
    for (const double inside : {0.0, -0.0, 1.0, -1e-50, kMinMagnitude, -kMaxMagnitude}) EXPECT_TRUE(in_exact_range(inside)) << inside;
    for (const double outside : {std::nextafter(kMinMagnitude, 0), -std::nextafter(kMaxMagnitude, 1e300), 1e-300, 5e-324,
                                 std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
        EXPECT_FALSE(in_exact_range(outside)) << outside;
    EXPECT_TRUE(in_exact_range(Vec3{0, 1, -2}));
    EXPECT_FALSE(in_exact_range(Vec3{0, 1e-100, -2}));
    EXPECT_EQ(flush_to_exact_range(Vec3{1e-100, -1e-100, -2}), (Vec3{0, 0, -2}));
}

/// The last bits of the smallest coordinates decide against the largest coordinates: all of the range in one determinant.
TEST(ExactRange, LastBitCountsAtBothEndsAtOnce) {
    const double big = kMaxMagnitude, small = kMinMagnitude, next = std::nextafter(small, 1);
    // three corners of a huge square at height `small`; the fourth is on their plane or off it by the last bit
    const Vec3 a{-big, -big, small}, b{big, -big, small}, c{0, big, small};
    EXPECT_EQ(orient3d(a, b, c, {big, big, next}), Sign::positive);
    EXPECT_EQ(orient3d(a, b, c, {big, big, small}), Sign::zero);
    EXPECT_EQ(orient3d(a, b, c, {big, big, std::nextafter(small, 0)}), Sign::negative);  // half a bit: outside of the range, still right
    EXPECT_EQ(orient3d(a, b, c, {big, big, -small}), Sign::negative);
}

/// Spheres through corners of a box of sides 2 big x 2 big x 2 small: the eighth corner moves by the last bit.
TEST(ExactRange, SpheresAtBothEndsAtOnce) {
    for (const double big : {kMaxMagnitude, 1.0, 2 * kMinMagnitude}) {
        const double small = 3 * kMinMagnitude, out = std::nextafter(small, 1), in = std::nextafter(small, 0);
        const Vec3 a{-big, -big, -small}, b{big, -big, -small}, c{-big, big, -small}, d{-big, -big, small};
        ASSERT_EQ(orient3d(a, b, c, d), Sign::positive);
        for (const double z : {in, small, out, -small}) {
            const Vec3 e{big, big, z};
            EXPECT_EQ(insphere(a, b, c, d, e), oracle::insphere(a, b, c, d, e)) << big << " " << z;
            EXPECT_EQ(*insphere_rung(Rung::exact, a, b, c, d, e), oracle::insphere(a, b, c, d, e));
            EXPECT_EQ(side_of_diametral_sphere(a, e, {-big, big, small}), oracle::side_of_diametral_sphere(a, e, {-big, big, small}));
            EXPECT_EQ(side_of_equatorial_sphere(a, b, {-big, big, -z}, {big, big, -z}),
                      oracle::side_of_equatorial_sphere(a, b, {-big, big, -z}, {big, big, -z}));
            EXPECT_EQ(*equatorial_rung(Rung::exact, a, b, c, {big, big, -z}), oracle::side_of_equatorial_sphere(a, b, c, {big, big, -z}));
        }
        EXPECT_EQ(insphere(a, b, c, d, {big, big, in}), Sign::positive);
        EXPECT_EQ(insphere(a, b, c, d, {big, big, small}), Sign::zero);
        EXPECT_EQ(insphere(a, b, c, d, {big, big, out}), Sign::negative);
        EXPECT_EQ(side_of_equatorial_sphere(a, b, c, {big, big, -small}), Sign::zero);
        EXPECT_EQ(side_of_equatorial_sphere(a, b, c, {big, big, -in}), Sign::negative);  // off the plane, hence outside
    }
}

/// Small against small: everything near the lower end, all bits in use.
TEST(ExactRange, LowerEndIsExactEverywhere) {
    int slow = 0, cases = 0;
    for (std::uint64_t i = 0; i < 3'000; ++i) {
        Random r(21, i);
        const Quintuple base = i % 2 == 0 ? sphere(r) : grid_some_ulps_off(r);
        Quintuple q;
        for (std::size_t j = 0; j < 5; ++j) {  // coordinates of 2 to 5 times the least magnitude
            q[j] = {(base[j].x + 3) * kMinMagnitude, (base[j].y + 3) * kMinMagnitude, (base[j].z + 3) * kMinMagnitude};
            ASSERT_TRUE(in_exact_range(q[j]));
        }
        const Decision insphere_decision = decide_insphere(q[0], q[1], q[2], q[3], q[4]);
        const Decision equatorial_decision = decide_side_of_equatorial_sphere(q[0], q[1], q[2], q[3]);
        ASSERT_EQ(insphere_decision.sign, oracle::insphere(q[0], q[1], q[2], q[3], q[4])) << i;
        ASSERT_EQ(equatorial_decision.sign, oracle::side_of_equatorial_sphere(q[0], q[1], q[2], q[3])) << i;
        ASSERT_EQ(*insphere_rung(Rung::exact, q[0], q[1], q[2], q[3], q[4]), insphere_decision.sign);
        ASSERT_EQ(*equatorial_rung(Rung::exact, q[0], q[1], q[2], q[3]), equatorial_decision.sign);
        slow += insphere_decision.rung == Rung::double_double || insphere_decision.rung == Rung::exact;
        ++cases;
    }
    EXPECT_GT(slow, cases / 4);
}

}  // namespace
}  // namespace wellmesh::test
