// SPDX-License-Identifier: Apache-2.0
#include "sizing/size_octree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/infinity.hpp"
#include "core/vec3_math.hpp"
#include "random_points.hpp"

namespace wellmesh::testing {
namespace {

SizeSampling unit_cube(std::function<double(const Vec3&)> f) {
    SizeSampling sampling;
    sampling.edge_length = std::move(f);
    return sampling;
}

TEST(SizeOctree, FollowsSmoothFieldsClosely) {
    const auto linear = [](const Vec3& p) { return 0.02 + 0.1 * p.x + 0.05 * p.z; };
    const auto cone = [](const Vec3& p) { return 0.001 + 0.3 * norm(p - Vec3{0.3, 0.4, 0.5}); };
    RandomPoints random(1);
    for (const auto& [f, median, worst] : {std::tuple{std::function<double(const Vec3&)>(linear), 1e-12, 1e-12}, std::tuple{std::function<double(const Vec3&)>(cone), 0.03, 0.5}}) {
        SizeSampling sampling = unit_cube(f);
        const std::vector<Vec3> probes{{0.3, 0.4, 0.5}};
        sampling.probes = probes;
        const SizeOctree tree(sampling);
        std::vector<double> errors;
        for (int i = 0; i < 3000; ++i) {
            const Vec3 p = i % 2 == 0 ? random.point() : Vec3{0.3, 0.4, 0.5} + std::exp2(-12 * random.number()) * 0.3 * (random.point() - Vec3{0.5, 0.5, 0.5});
            errors.push_back(std::abs(tree(p) / f(p) - 1));
        }
        std::sort(errors.begin(), errors.end());
        EXPECT_LE(errors[errors.size() / 2], median);
        EXPECT_LE(errors.back(), worst);
    }
}

TEST(SizeOctree, LeavesAreAsSmallAsTheSizesInThem) {
    std::size_t leaves = 0, probes = 0;
    SizeSampling sampling = unit_cube([](const Vec3& p) { return norm(p - Vec3{0.71, 0.72, 0.73}) < 1e-3 ? 1e-3 : 1.0; });
    const std::vector<Vec3> points{{0.71, 0.72, 0.73}};
    sampling.probes = points;
    const SizeOctree tree(sampling, [&](const SizeOctree::Leaf& leaf) {
        ++leaves;
        probes += leaf.probes.size();
        if (!leaf.probes.empty()) {
            EXPECT_LE(leaf.side, SizeOctree::kLeafPerLength * 1e-3);
        }
        for (const double h : leaf.at_corner) EXPECT_LE(leaf.side, SizeOctree::kLeafPerLength * h);
    });
    EXPECT_EQ(leaves, tree.leaves());
    EXPECT_EQ(probes, 1U);
    EXPECT_LT(leaves, 3000U);
    EXPECT_EQ(tree({0.1, 0.1, 0.1}), 1.0);
    EXPECT_LT(tree({0.71, 0.72, 0.73}), 0.1);
}

/// More samples than are remembered: they are asked for again where the tree comes back to a place, which is seldom.
TEST(SizeOctree, SamplesAreTakenAboutOnce) {
    std::size_t calls = 0;
    std::set<std::array<double, 3>> places;
    const auto asked = [](const Vec3& p) { return 0.015 + 0.03 * p.x; };
    const SizeOctree tree(unit_cube([&](const Vec3& p) {
        ++calls;
        places.insert({p.x, p.y, p.z});
        return asked(p);
    }));
    EXPECT_GT(places.size(), 100'000U);
    EXPECT_LT(static_cast<double>(calls), 1.5 * static_cast<double>(places.size()));
    RandomPoints random(2);
    for (int i = 0; i < 3000; ++i) {
        const Vec3 p = random.point();
        ASSERT_NEAR(tree(p), asked(p), 1e-12);
    }
}

TEST(SizeOctree, NothingAskedIsInfiniteAndPointsOutsideAreClamped) {
    const SizeOctree none(unit_cube([](const Vec3&) { return kInfinity; }));
    EXPECT_EQ(none({0.3, 0.3, 0.3}), kInfinity);
    const SizeOctree half(unit_cube([](const Vec3& p) { return p.x < 0.5 ? 0.1 : kInfinity; }));
    EXPECT_EQ(half({0.2, 0.3, 0.3}), 0.1);
    EXPECT_EQ(half({0.8, 0.3, 0.3}), kInfinity);
    EXPECT_EQ(half({-3, 0.3, 0.3}), 0.1);
}

TEST(SizeOctree, OutsideOfTheDomainItStaysCoarse) {
    // The domain: a ball of 0.1; what bounds it: the boxes of a cube about it.
    const auto inside = [](const Vec3& p) { return norm(p - Vec3{0.5, 0.5, 0.5}) < 0.1; };
    SizeSampling sampling = unit_cube([](const Vec3&) { return 0.02; });
    const std::size_t everywhere = SizeOctree(sampling).leaves();
    sampling.inside = inside;
    const std::vector<Box> surface{{{0.4, 0.4, 0.4}, {0.6, 0.6, 0.4}}, {{0.4, 0.4, 0.6}, {0.6, 0.6, 0.6}}, {{0.4, 0.4, 0.4}, {0.4, 0.6, 0.6}},
                                   {{0.6, 0.4, 0.4}, {0.6, 0.6, 0.6}}, {{0.4, 0.4, 0.4}, {0.6, 0.4, 0.6}}, {{0.4, 0.6, 0.4}, {0.6, 0.6, 0.6}}};
    sampling.surface = surface;
    EXPECT_LT(SizeOctree(sampling).leaves(), everywhere / 10);
}

TEST(SizeOctree, StopsWhenToldTo) {
    SizeSampling sampling = unit_cube([](const Vec3&) { return 1e-5; });
    sampling.may_go_on = [](std::size_t leaves) { return leaves < 1000; };
    EXPECT_LT(SizeOctree(sampling).leaves(), 1200U);
}

}  // namespace
}  // namespace wellmesh::testing
