// SPDX-License-Identifier: Apache-2.0
// Conventions by hand-made examples, and the algebra of the predicates: exchanges of arguments, scaling, and each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "ladder_check.hpp"

namespace wellmesh::test {
namespace {

TEST(Conventions, UnitTetrahedronIsPositive) {
    const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0}, d{0, 0, 1};
    EXPECT_EQ(orient3d(a, b, c, d), Sign::positive);
    EXPECT_EQ(orient3d(b, a, c, d), Sign::negative);
    EXPECT_EQ(orient3d(a, b, c, {0.3, 0.4, 0}), Sign::zero);
    EXPECT_EQ(insphere(a, b, c, d, {0.25, 0.25, 0.25}), Sign::positive);
    EXPECT_EQ(insphere(a, b, c, d, {1, 1, 1}), Sign::zero);
    EXPECT_EQ(insphere(a, b, c, d, {1, 1, 1.0000001}), Sign::negative);
    EXPECT_EQ(insphere(b, a, c, d, {0.25, 0.25, 0.25}), Sign::negative);  // of a negative tetrahedron
}

TEST(Conventions, SpheresArePositiveInside) {
    const Vec3 a{0, 0, 0}, b{2, 0, 0}, c{0, 2, 0};
    EXPECT_EQ(side_of_diametral_sphere(a, b, {1, 0.99, 0}), Sign::positive);
    EXPECT_EQ(side_of_diametral_sphere(a, b, {1, 1, 0}), Sign::zero);
    EXPECT_EQ(side_of_diametral_sphere(a, b, {1, 0, -1.01}), Sign::negative);
    EXPECT_EQ(side_of_diametral_sphere(a, b, b), Sign::zero);
    EXPECT_EQ(side_of_equatorial_sphere(a, b, c, {1, 1, 1.4}), Sign::positive);
    EXPECT_EQ(side_of_equatorial_sphere(a, b, c, {2, 2, 0}), Sign::zero);
    EXPECT_EQ(side_of_equatorial_sphere(a, b, c, {1, 1, -1.42}), Sign::negative);
    EXPECT_EQ(side_of_equatorial_sphere(a, b, c, c), Sign::zero);
    EXPECT_EQ(side_of_equatorial_sphere(a, b, {1, 0, 0}, {1, 1, 0}), Sign::zero);  // collinear: no sphere
}

/// Parity of the permutation of `order`.
template <std::size_t N>
bool is_even(const std::array<std::size_t, N>& order) {
    int inversions = 0;
    for (std::size_t s = 0; s < N; ++s)
        for (std::size_t t = s + 1; t < N; ++t) inversions += order[s] > order[t];
    return inversions % 2 == 0;
}

TEST(PredicateLaws, Permutations) {
    int cases = 0, zeros = 0;
    std::uint64_t stream = 400;
    for (const Family& family : kFamilies) {
        ++stream;
        for (std::uint64_t i = 0; i < 250; ++i, ++cases) {
            Random random(stream, i);
            const Quintuple q = family.generate(random);
            const Sign orientation = orient3d(q[0], q[1], q[2], q[3]), side = insphere(q[0], q[1], q[2], q[3], q[4]);
            zeros += orientation == Sign::zero || side == Sign::zero;
            std::array<std::size_t, 4> o{0, 1, 2, 3};
            do {
                ASSERT_EQ(orient3d(q[o[0]], q[o[1]], q[o[2]], q[o[3]]), is_even(o) ? orientation : -orientation) << describe(q, family.name, i);
                ASSERT_EQ(insphere(q[o[0]], q[o[1]], q[o[2]], q[o[3]], q[4]), is_even(o) ? side : -side) << describe(q, family.name, i);
            } while (std::next_permutation(o.begin(), o.end()));
            ASSERT_EQ(insphere(q[4], q[1], q[2], q[3], q[0]), -side) << describe(q, family.name, i);
            const Sign equatorial = side_of_equatorial_sphere(q[0], q[1], q[2], q[3]);
            std::array<std::size_t, 3> t{0, 1, 2};
            do {
                ASSERT_EQ(side_of_equatorial_sphere(q[t[0]], q[t[1]], q[t[2]], q[3]), equatorial) << describe(q, family.name, i);
            } while (std::next_permutation(t.begin(), t.end()));
            ASSERT_EQ(side_of_diametral_sphere(q[0], q[1], q[2]), side_of_diametral_sphere(q[1], q[0], q[2]));
        }
    }
    EXPECT_GT(zeros, cases / 10);
    EXPECT_LT(zeros, cases);
}

/// A right angle at c makes the equatorial sphere of abc the diametral sphere of ab.
TEST(PredicateLaws, EquatorialSphereOfARightTriangleIsDiametral) {
    int inside = 0, on = 0;
    for (std::uint64_t i = 0; i < 20'000; ++i) {
        Random r(450, i);
        const Vec3 c = r.point([&] { return static_cast<double>(r.integer(-1, 1)); });
        const Vec3 p = r.point([&] { return static_cast<double>(r.integer(-2, 4)); });
        const Vec3 a{c.x + r.integer(1, 6), c.y, c.z}, b{c.x, c.y + r.integer(1, 6), c.z};
        const Sign side = side_of_diametral_sphere(a, b, p);
        ASSERT_EQ(side_of_equatorial_sphere(a, b, c, p), side);
        inside += side == Sign::positive;
        on += side == Sign::zero;
    }
    EXPECT_GT(inside, 1000);
    EXPECT_GT(on, 500);
}

/// The equatorial sphere of abc through d, where d makes a positive tetrahedron: insphere of a point sees the same sphere only
/// in the plane of abc, where both are the circumcircle.
TEST(PredicateLaws, SpheresAgreeInTheTrianglesPlane) {
    int cases = 0;
    for (std::uint64_t i = 0; i < 20'000; ++i) {
        Random r(460, i);
        const auto in_plane = [&] { return Vec3{static_cast<double>(r.integer(-3, 3)), static_cast<double>(r.integer(-3, 3)), 0}; };
        const Vec3 a = in_plane(), b = in_plane(), c = in_plane(), p = in_plane(), d{0.5 * r.integer(-4, 4), 0.25, 1};
        if (orient3d(a, b, c, d) != Sign::positive) continue;
        ASSERT_EQ(side_of_equatorial_sphere(a, b, c, p), insphere(a, b, c, d, p));
        ++cases;
    }
    EXPECT_GT(cases, 5000);
}

TEST(PredicateLaws, PowersOfTwoScaleFreely) {
    for (std::uint64_t i = 0; i < 2'000; ++i) {
        Random r(470, i);
        const Quintuple q = i % 2 == 0 ? grid_some_ulps_off(r) : slanted_plane(r);
        for (const double scale : {0x1p-100, 0x1p60}) {
            Quintuple s;
            for (std::size_t j = 0; j < 5; ++j) s[j] = {scale * q[j].x, scale * q[j].y, scale * q[j].z};
            ASSERT_EQ(orient3d(s[0], s[1], s[2], s[3]), orient3d(q[0], q[1], q[2], q[3]));
            ASSERT_EQ(insphere(s[0], s[1], s[2], s[3], s[4]), insphere(q[0], q[1], q[2], q[3], q[4]));
            ASSERT_EQ(side_of_equatorial_sphere(s[0], s[1], s[2], s[3]), side_of_equatorial_sphere(q[0], q[1], q[2], q[3]));
        }
    }
}

}  // namespace
}  // namespace wellmesh::test
