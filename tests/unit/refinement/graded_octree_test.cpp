// SPDX-License-Identifier: Apache-2.0
#include "refinement/graded_octree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh::testing {
namespace {

void split_all(GradedOctree& tree, unsigned levels) {
    for (unsigned l = 0; l < levels; ++l)
        for (std::uint32_t i = 0, n = static_cast<std::uint32_t>(tree.size()); i < n; ++i)
            if (tree.is_leaf(i)) tree.split(i);
}

std::vector<LatticePoint> lattice_of(const GradedOctree& tree) {
    Workers workers;
    LatticeLeaves leaves;
    return tree.lattice(workers, leaves);
}

std::vector<std::uint32_t> leaves(const GradedOctree& tree) {
    std::vector<std::uint32_t> out;
    for (std::uint32_t i = 0; i < tree.size(); ++i)
        if (tree.is_leaf(i)) out.push_back(i);
    return out;
}

TEST(GradedOctree, EqualLeavesMakeTheBodyCentredCubicLattice) {
    GradedOctree tree({-1, 2, 5}, 4);
    split_all(tree, 3);
    for (const std::uint32_t i : leaves(tree)) tree.use(i);
    Workers workers(2);
    tree.balance(workers);
    const std::vector<LatticePoint> lattice = lattice_of(tree);
    EXPECT_EQ(lattice.size(), 8U * 8 * 8 + 9U * 9 * 9);
    for (const LatticePoint& p : lattice) {
        EXPECT_EQ(p.spacing, 0.5);
        // An inner point has eight neighbours at sqrt(3)/2 of the lattice constant, six at one.
        const bool inner = p.point.x > -0.5 && p.point.x < 2.5 && p.point.y > 2.5 && p.point.y < 5.5 && p.point.z > 5.5 && p.point.z < 8.5;
        if (!inner) continue;
        std::size_t near = 0, at_one = 0;
        for (const LatticePoint& q : lattice) {
            const double d = distance(p.point, q.point) / 0.5;
            near += std::abs(d - std::sqrt(0.75)) < 1e-12;
            at_one += std::abs(d - 1) < 1e-12;
        }
        EXPECT_EQ(near, 8U);
        EXPECT_EQ(at_one, 6U);
    }
}

TEST(GradedOctree, UnusedLeavesHaveNoPoints) {
    GradedOctree tree({0, 0, 0}, 1);
    split_all(tree, 2);
    EXPECT_TRUE(lattice_of(tree).empty());
    tree.use(leaves(tree).front());
    EXPECT_EQ(lattice_of(tree).size(), 9U);
}

/// A used leaf leaves it to the first of its siblings to ask for what all of them need: also when that one is split before its turn.
TEST(GradedOctree, UsedLeavesHaveNothingMuchCoarserBesideThem) {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        GradedOctree tree({0, 0, 0}, 1);
        split_all(tree, 1);
        for (unsigned level = 0; level < 5; ++level)
            for (const std::uint32_t i : leaves(tree))
                if (mix64(seed, i) % 5 == 0) tree.split(i);
        for (const std::uint32_t i : leaves(tree))
            if (mix64(~seed, i) % 3 == 0) tree.use(i);
        Workers workers(2);
        tree.balance(workers);
        LatticeLeaves used;
        (void)tree.lattice(workers, used);
        const auto all = leaves(tree);
        for (const std::uint32_t i : all) {
            if (used.of_node[i] == LatticeLeaves::kNone) continue;
            const auto a = tree.box(i);
            for (const std::uint32_t j : all) {
                const auto b = tree.box(j);
                const bool touch = a.lo.x <= b.lo.x + b.side && b.lo.x <= a.lo.x + a.side && a.lo.y <= b.lo.y + b.side && b.lo.y <= a.lo.y + a.side && a.lo.z <= b.lo.z + b.side &&
                                   b.lo.z <= a.lo.z + a.side;
                if (touch) { ASSERT_LE(b.side, 2 * a.side) << seed; }
            }
        }
    }
}

TEST(GradedOctree, LeavesThatShareACornerDifferByOneLevelAtMost) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        GradedOctree tree({0, 0, 0}, 1);
        split_all(tree, 1);
        // Towards a random point, so that levels jump.
        const Vec3 aim{unit_double(mix64(seed, 1)), unit_double(mix64(seed, 2)), unit_double(mix64(seed, 3))};
        for (unsigned level = 0; level < 6; ++level)
            for (const std::uint32_t i : leaves(tree)) {
                const auto box = tree.box(i);
                const bool holds = aim.x >= box.lo.x && aim.x < box.lo.x + box.side && aim.y >= box.lo.y && aim.y < box.lo.y + box.side && aim.z >= box.lo.z && aim.z < box.lo.z + box.side;
                if (holds) tree.split(i);
            }
        for (const std::uint32_t i : leaves(tree)) tree.use(i);
        Workers workers(2);
        tree.balance(workers);
        const auto all = leaves(tree);
        double volume = 0;
        for (const std::uint32_t i : all) {
            const auto a = tree.box(i);
            volume += a.side * a.side * a.side;
            for (const std::uint32_t j : all) {
                const auto b = tree.box(j);
                const bool touch = a.lo.x <= b.lo.x + b.side && b.lo.x <= a.lo.x + a.side && a.lo.y <= b.lo.y + b.side && b.lo.y <= a.lo.y + a.side && a.lo.z <= b.lo.z + b.side &&
                                   b.lo.z <= a.lo.z + a.side;
                if (touch) { ASSERT_LE(a.side, 2 * b.side) << seed; }
            }
        }
        EXPECT_EQ(volume, 1);
        std::vector<LatticePoint> lattice = lattice_of(tree);
        std::sort(lattice.begin(), lattice.end(), [](const LatticePoint& p, const LatticePoint& q) { return lexicographically_less(p.point, q.point); });
        for (std::size_t i = 1; i < lattice.size(); ++i) ASSERT_NE(lattice[i - 1].point, lattice[i].point);
    }
}

/// Splits what is near a point down to so many levels, depth first; nodes of level `stop_at` are listed instead.
void grow(GradedOctree& tree, std::uint32_t node, const Vec3& aim, unsigned levels, unsigned stop_at, std::vector<std::uint32_t>* stopped) {
    const auto box = tree.box(node);
    const Vec3 centre{box.lo.x + box.side / 2, box.lo.y + box.side / 2, box.lo.z + box.side / 2};
    if (tree.depth(node) == stop_at) {
        stopped->push_back(node);
        return;
    }
    if (tree.depth(node) >= levels || norm(centre - aim) > 1.5 * box.side) {
        if (norm(centre - aim) < 2 * box.side) tree.use(node);
        return;
    }
    const std::uint32_t first = tree.split(node);
    for (std::uint32_t k = 0; k < 8; ++k) grow(tree, first + k, aim, levels, stop_at, stopped);
}

TEST(GradedOctree, GrownInBranchesIsTheSameAsInOne) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Vec3 aim{unit_double(mix64(seed, 1)), unit_double(mix64(seed, 2)), unit_double(mix64(seed, 3))};
        for (const unsigned stop_at : {0U, 1U, 2U, 3U, 5U}) {
            constexpr unsigned kLevels = 5, kNever = 99;
            GradedOctree whole({0, 0, 0}, 1), top({0, 0, 0}, 1);
            grow(whole, 0, aim, kLevels, kNever, nullptr);
            std::vector<std::uint32_t> stopped;
            grow(top, 0, aim, kLevels, stop_at, &stopped);
            std::vector<GradedOctree::Branch> branches;
            for (const std::uint32_t node : stopped) {
                branches.push_back({node, top.branch(node)});
                grow(branches.back().tree, 0, aim, kLevels, kNever, nullptr);
            }
            const GradedOctree joined = top.with(branches);
            ASSERT_EQ(joined.size(), whole.size());
            for (std::uint32_t i = 0; i < whole.size(); ++i) {
                ASSERT_EQ(joined.is_leaf(i), whole.is_leaf(i)) << seed << ' ' << stop_at << ' ' << i;
                ASSERT_EQ(joined.depth(i), whole.depth(i));
                ASSERT_TRUE(joined.box(i).lo == whole.box(i).lo);
            }
            const auto a = lattice_of(joined), b = lattice_of(whole);
            ASSERT_EQ(a.size(), b.size());
            for (std::size_t i = 0; i < a.size(); ++i) ASSERT_TRUE(a[i].point == b[i].point && a[i].spacing == b[i].spacing);
        }
    }
}

}  // namespace
}  // namespace wellmesh::testing
