// SPDX-License-Identifier: Apache-2.0
#include "core/vec3_math.hpp"

#include <gtest/gtest.h>

namespace wellmesh {
namespace {

constexpr Vec3 kX{1, 0, 0}, kY{0, 1, 0}, kZ{0, 0, 1};

TEST(Vec3Math, CrossProductIsRightHanded) {
    EXPECT_EQ(cross(kX, kY), kZ);
    EXPECT_EQ(cross(kY, kZ), kX);
    EXPECT_EQ(cross(kZ, kX), kY);
    EXPECT_EQ(determinant(kX, kY, kZ), 1.0);
    EXPECT_EQ(determinant(kY, kX, kZ), -1.0);
}

TEST(Vec3Math, Arithmetic) {
    const Vec3 p{1, 2, 3}, q{4, -5, 6};
    EXPECT_EQ(p + q, (Vec3{5, -3, 9}));
    EXPECT_EQ(p - q, (Vec3{-3, 7, -3}));
    EXPECT_EQ(-p, (Vec3{-1, -2, -3}));
    EXPECT_EQ(2 * p, (Vec3{2, 4, 6}));
    EXPECT_EQ(dot(p, q), 12.0);
    EXPECT_EQ(norm(Vec3{2, 3, 6}), 7.0);
    EXPECT_EQ(distance(p, p), 0.0);
    EXPECT_EQ(squared_distance(p, q), 9.0 + 49 + 9);
}

TEST(Vec3Math, LexicographicOrderIsStrictAndTotal) {
    const Vec3 sorted[] = {{-1, 5, 5}, {0, -1, 9}, {0, 0, 0}, {0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
    for (const Vec3& p : sorted)
        for (const Vec3& q : sorted) EXPECT_EQ(lexicographically_less(p, q), &p < &q);
    EXPECT_FALSE(lexicographically_less({0.0, 0, 0}, {-0.0, 0, 0}));
    EXPECT_FALSE(lexicographically_less({-0.0, 0, 0}, {0.0, 0, 0}));
}

}  // namespace
}  // namespace wellmesh
