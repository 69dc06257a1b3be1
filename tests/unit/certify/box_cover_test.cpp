// SPDX-License-Identifier: Apache-2.0
#include "certify/box_cover.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh::certifying {
namespace {

Box3 random_box(std::uint64_t seed, std::uint64_t key, double size, const Vec3& stretch) {
    const auto draw = [&](std::uint64_t i) { return unit_double(mix64(seed, 16 * key + i)); };
    const Vec3 low{stretch.x * draw(0), stretch.y * draw(1), stretch.z * draw(2)};
    return {low, low + Vec3{size * stretch.x * draw(3), size * stretch.y * draw(4), size * stretch.z * draw(5)}};
}

TEST(BoxCover, NeverMissesAMeeting) {
    for (const Vec3& stretch : {Vec3{1, 1, 1}, Vec3{1, 1e-3, 1e3}, Vec3{1, 0, 1}, Vec3{0, 0, 0}, Vec3{1e-60, 1e-60, 1e-60}}) {
        for (const std::size_t n : {1U, 7U, 400U}) {
            std::vector<Box3> boxes;
            for (std::size_t i = 0; i < n; ++i) boxes.push_back(random_box(n, i, 0.05, stretch));
            const BoxCover cover(boxes);
            for (std::size_t i = 0; i < 300; ++i) {
                const Box3 box = random_box(n + 1, i, 0.1, stretch);
                const bool meets = std::any_of(boxes.begin(), boxes.end(), [&](const Box3& b) { return b.meets(box); });
                EXPECT_TRUE(!meets || cover.may_meet(box)) << n << ' ' << i;
            }
            for (const Box3& b : boxes) EXPECT_TRUE(cover.may_meet(b) && cover.may_meet({b.high, b.high}));
        }
    }
}

TEST(BoxCover, TellsTheInsideOfASurfaceFromTheSurface) {
    std::vector<Box3> boxes;  // 40 x 40 tiles on each of two opposite sides of a cube
    for (int i = 0; i < 40; ++i)
        for (int j = 0; j < 40; ++j)
            for (const double z : {0.0, 1.0}) boxes.push_back({{i / 40.0, j / 40.0, z}, {(i + 1) / 40.0, (j + 1) / 40.0, z}});
    const BoxCover cover(boxes);
    EXPECT_FALSE(cover.may_meet({{0.1, 0.1, 0.1}, {0.9, 0.9, 0.9}}));
    EXPECT_TRUE(cover.may_meet({{0.5, 0.5, 0.5}, {0.5, 0.5, 1}}));
    EXPECT_TRUE(cover.may_meet({{-5, -5, -5}, {5, 5, 5}}));
    EXPECT_FALSE(BoxCover({}).may_meet({{0, 0, 0}, {1, 1, 1}}));
}

}  // namespace
}  // namespace wellmesh::certifying
