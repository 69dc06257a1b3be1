// SPDX-License-Identifier: Apache-2.0
#include "repair/piercing_point.hpp"

#include <gtest/gtest.h>

#include "core/vec3_math.hpp"
#include "repair/vertex_pool.hpp"

namespace wellmesh {
namespace {

TEST(PiercingPoint, IsExactForDyadicInput) {
    const Vec3 p = piercing_point({Vec3{0.25, 0.5, -1}, Vec3{0.25, 0.5, 3}}, {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}});
    EXPECT_EQ(p, (Vec3{0.25, 0.5, 0}));
}

TEST(PiercingPoint, StaysPreciseAtGrazingAngles) {
    // A segment of slope 1e-12 through a large triangle far from the origin: the heights of its ends cancel to a few digits in doubles.
    const double x0 = 1e3, h = 0x1p-40;
    const std::array<Vec3, 3> triangle{Vec3{x0, x0, 1}, Vec3{x0 + 8, x0, 1}, Vec3{x0, x0 + 8, 1}};
    for (const double place : {0.125, 0.25, 0.75}) {
        const std::array<Vec3, 2> segment{Vec3{x0 + 1, x0 + 1, 1 - place * h}, Vec3{x0 + 2, x0 + 1, 1 + (1 - place) * h}};
        EXPECT_NEAR(piercing_point(segment, triangle).x, x0 + 1 + place, 1e-12);
    }
}

TEST(VertexPool, MergesWithinReachAndNeverMoves) {
    VertexPool pool(0.1);
    EXPECT_EQ(pool.find_or_add({0, 0, 0}), 0U);
    EXPECT_EQ(pool.find_or_add({0.09, 0, 0}), 0U);
    EXPECT_EQ(pool.find_or_add({0.18, 0, 0}), 1U);  // near the merged point, not near the vertex: no chain
    EXPECT_EQ(pool.find_or_add({0.1, 0, 0}), 1U);   // the nearer of two
    EXPECT_EQ(pool.find_or_add({-0.05, -0.05, -0.05}), 0U);
    EXPECT_EQ(pool[1], (Vec3{0.18, 0, 0}));
}

}  // namespace
}  // namespace wellmesh
