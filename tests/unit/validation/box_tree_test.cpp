// SPDX-License-Identifier: Apache-2.0
#include "validation/box_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/rng.hpp"

namespace wellmesh::testing {
namespace {

double draw(std::uint64_t seed, std::uint64_t i, std::uint64_t k) { return unit_double(mix64(mix64(seed, i), k)); }

/// Of all sizes; many of them around the same few places, or at the same one.
std::vector<Box> random_boxes(std::size_t n, std::uint64_t seed, bool in_one_place) {
    std::vector<Box> boxes(n);
    for (std::size_t i = 0; i < n; ++i) {
        const auto place = [&](std::uint64_t k) { return in_one_place ? 0.5 : i % 3 == 0 ? std::round(4 * draw(seed, i, k)) / 4 : draw(seed, i, k); };
        const Vec3 centre{place(0), place(1), place(2)};
        const double half = in_one_place ? 0.25 : 0.1 * std::pow(draw(seed, i, 3), 4);
        boxes[i] = Box{centre, centre}.grown(half);
    }
    return boxes;
}

TEST(Box, MeetsWhatItTouchesAndNothingApart) {
    const Box box{{0, 0, 0}, {1, 2, 3}};
    for (const auto& [low, high] : {std::array{Vec3{1, 2, 3}, Vec3{2, 3, 4}}, {Vec3{-1, -1, -1}, Vec3{0, 0, 0}}, {Vec3{0.2, 0.3, 0.4}, Vec3{0.3, 0.4, 0.5}}, {Vec3{-9, 1, 1}, Vec3{9, 1, 1}}}) {
        EXPECT_TRUE(box.meets({low, high}));
        EXPECT_TRUE((Box{low, high}.meets(box)));
    }
    for (const Vec3& away : {Vec3{1.01, 0, 0}, Vec3{-1.01, 0, 0}, Vec3{0, 2.01, 0}, Vec3{0, -2.01, 0}, Vec3{0, 0, 3.01}, Vec3{0, 0, -3.01}}) {
        const Box moved{box.low + away, box.high + away};
        EXPECT_FALSE(box.meets(moved));
        EXPECT_FALSE(moved.meets(box));
    }
    EXPECT_EQ(box.squared_distance_to({0.5, 2, 1}), 0);
    EXPECT_EQ(box.squared_distance_to({-2, 1, 1}), 4);
    EXPECT_EQ(box.squared_distance_to({3, 1, 1}), 4);
    EXPECT_EQ(box.squared_distance_to({2, 4, 5}), 1 + 4 + 4);
    EXPECT_EQ(box.squared_distance_to({-1, -1, -1}), 3);
}

TEST(BoxTree, FindsWhatMeetsABoxWhoeverMadeIt) {
    for (const std::size_t n : {0U, 1U, 2U, 3U, 4U, 5U, 6U, 7U, 8U, 9U, 10U, 11U, 17U, 100U, 4095U, 4096U, 5001U})
        for (const bool in_one_place : {false, true}) {
            const std::vector<Box> boxes = random_boxes(n, n, in_one_place);
            std::vector<std::vector<std::uint32_t>> first;
            for (const unsigned threads : {1U, 2U, 3U}) {
                Workers workers(threads);
                const BoxTree tree(boxes, workers);
                std::vector<std::vector<std::uint32_t>> all;
                for (std::uint64_t q = 0; q < 40; ++q) {
                    const Vec3 p{draw(7, q, 0), draw(7, q, 1), draw(7, q, 2)};
                    const Box wanted = Box{p, p}.grown(0.3 * draw(7, q, 3));
                    std::vector<std::uint32_t> found, expected;
                    tree.query([&](const Box& b) { return b.meets(wanted); }, [&](std::uint32_t i) { found.push_back(i); });
                    all.push_back(found);
                    for (std::uint32_t i = 0; i < n; ++i)
                        if (boxes[i].meets(wanted)) expected.push_back(i);
                    std::sort(found.begin(), found.end());
                    ASSERT_EQ(found, expected) << n << " boxes, " << threads << " threads";
                }
                if (threads == 1) first = all;
                EXPECT_EQ(all, first);  // in the same order, too
                Box bounds;
                for (const Box& b : boxes) bounds.add(b);
                EXPECT_EQ(tree.bounds().low, bounds.low);
                EXPECT_EQ(tree.bounds().high, bounds.high);
            }
        }
}

}  // namespace
}  // namespace wellmesh::testing
