// SPDX-License-Identifier: Apache-2.0
// Which gaps are left, against what areas and lengths over widths say that filling them takes.
#include "refinement/thin_gaps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <set>

#include "core/vec3_math.hpp"
#include "refinement/refine.hpp"
#include "support/acute_plcs.hpp"
#include "support/gap_plcs.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"

namespace wellmesh::testing {
namespace {

std::unique_ptr<StagedMesh> conformed(const Plc& plc) {
    auto staged = std::make_unique<StagedMesh>(plc, MeshOptions{}, true);
    staged->conform();
    return staged;
}

bool never(TetId) { return false; }

ThinGaps gaps_in(const StagedMesh& staged, double most_vertices) { return {staged.mesh, most_vertices, never, nullptr}; }

/// What all gaps take, as far as it is looked at: that of a budget for next to nothing is left.
double demand(const StagedMesh& staged) {
    const ThinGaps gaps = gaps_in(staged, 1e-3);
    return gaps.any() ? gaps.left()->vertices : 0;
}

TEST(ThinGaps, NoneWithoutAGap) {
    for (const NamedPlc& named : all_synthetic_plcs()) {
        const auto staged = conformed(named.plc);
        const ThinGaps gaps = gaps_in(*staged, 0);
        EXPECT_FALSE(gaps.any()) << named.name;
        EXPECT_EQ(gaps.expected_vertices(), 0);
        staged->for_domain([&](TetId t) { EXPECT_FALSE(gaps.sides_joined_by(staged->mesh, t)); });
    }
    EXPECT_FALSE(ThinGaps().any());
}

/// Both squares of a slab are beside the gap, all of them at its width, and so are their edges.
double demand_of_slab(double width) { return 1 / (width * width) + 8 * 3 / width; }

TEST(ThinGaps, OfSlabsIsExact) {
    for (const double width : {0.05, 0.01, 1e-4}) EXPECT_NEAR(demand(*conformed(slabs({width}))) / demand_of_slab(width), 1, 1e-9) << width;
}

TEST(ThinGaps, OfAPlateAboveAFloor) {
    for (const double side : {0.25, 0.5})
        for (const double width : {0.01, 0.001, 0.0001}) {
            const double expected = side * side / (width * width) + (12 + std::numbers::pi) * side / width;
            EXPECT_NEAR(demand(*conformed(plate_above_floor(side, width, width))) / expected, 1, 0.4) << side << ", " << width;
        }
}

TEST(ThinGaps, OfAGapThatWidens) {
    constexpr double kSide = 0.5, kNarrow = 0.0005, kWide = 0.008;
    EXPECT_NEAR(demand(*conformed(plate_above_floor(kSide, kNarrow, kWide))) * kNarrow * kWide / (kSide * kSide), 1, 0.35);
}

TEST(ThinGaps, OfABladeAboveAFloor) {
    for (const double width : {0.01, 0.001, 0.0001}) {
        constexpr double kLength = 0.4;
        // More, as triangles of the floor count that only have an edge beneath the blade.
        EXPECT_GE(demand(*conformed(blade_above_floor(kLength, width))) * width / kLength, 3) << width;
    }
}

TEST(ThinGaps, OfTwoWires) {
    for (const double width : {0.01, 0.001, 0.0001}) {
        // Three quarters of each are beside the other one.
        const double found = demand(*conformed(two_wires(0.4, width))) * width / 0.4, expected = 2 * 3 * 0.75;
        EXPECT_NEAR(found, expected, 0.1 * expected) << width;
    }
}

/// Across the boundary is another gap: what the local feature size says there is not about this one.
TEST(ThinGaps, TheOtherSideOfAWallIsNotInTheGap) {
    const auto staged = conformed(stack({0.1, 0.01}));
    const ThinGaps gaps = gaps_in(*staged, 2000);
    ASSERT_TRUE(gaps.any());
    // Of the wide one the floor and its edges; the other side of the middle square is beside the narrow gap.
    EXPECT_NEAR(gaps.left()->vertices + gaps.expected_vertices(), demand_of_slab(0.01) + 0.5 / 0.01 + 4 * 3 / 0.1, 1e-3);
    EXPECT_LE(gaps.expected_vertices(), 2000);
    EXPECT_NEAR(gaps.left()->filled_from, 0.0101, 1e-9);
}

TEST(ThinGaps, EnoughForAllLeavesNone) {
    const auto staged = conformed(slabs({0.01}));
    EXPECT_TRUE(gaps_in(*staged, 0.95 * demand_of_slab(0.01)).any());  // the smallest pieces aren't looked at
    const ThinGaps filled = gaps_in(*staged, demand_of_slab(0.01) + 1);
    EXPECT_FALSE(filled.any());
    EXPECT_NEAR(filled.expected_vertices() / demand_of_slab(0.01), 1, 0.05);
    const ThinGaps plenty = gaps_in(*staged, 1e6);  // bounds alone say so: nothing is sampled
    EXPECT_FALSE(plenty.any());
    EXPECT_EQ(plenty.expected_vertices(), 0);
}

/// 456, 3700 and 44800 vertices.
TEST(ThinGaps, TheWidestAreFilledFirst) {
    const auto staged = conformed(slabs({0.02, 0.005, 0.08}));
    struct Case {
        double budget, filled, filled_from;
    };
    const double wide = demand_of_slab(0.08), middling = demand_of_slab(0.02), narrow = demand_of_slab(0.005);
    for (const Case& c : {Case{30, 0, 0.08}, {wide + 40, wide, 0.02}, {wide + middling + 40, wide + middling, 0.005}}) {
        SCOPED_TRACE(c.budget);
        const ThinGaps gaps = gaps_in(*staged, c.budget);
        ASSERT_TRUE(gaps.any());
        const LeftGaps& left = *gaps.left();
        EXPECT_GE(gaps.expected_vertices(), 0.95 * c.filled);  // the smallest pieces aren't looked at
        EXPECT_LE(gaps.expected_vertices(), c.budget);
        EXPECT_NEAR(left.vertices + gaps.expected_vertices(), wide + middling + narrow, 0.05 * c.budget);
        EXPECT_NEAR(left.width, 0.005, 1e-12);  // of that which takes most
        EXPECT_NEAR(left.narrowest, 0.005, 1e-12);
        EXPECT_GE(left.filled_from, c.filled_from);
        EXPECT_LE(left.filled_from, 1.02 * c.filled_from);
        EXPECT_NE(staged->mesh.point(left.sides[0]).z, staged->mesh.point(left.sides[1]).z);
        std::set<double> widths;
        staged->for_domain([&](TetId t) {
            const auto sides = gaps.sides_joined_by(staged->mesh, t);
            const auto& corners = staged->mesh.tets().corners(t);
            const double x = 0.25 * (staged->mesh.point(corners[0]).x + staged->mesh.point(corners[1]).x + staged->mesh.point(corners[2]).x + staged->mesh.point(corners[3]).x);
            const double width = x < 2 ? 0.02 : x < 5 ? 0.005 : 0.08;
            EXPECT_EQ(sides.has_value(), width <= c.filled_from) << width;
            if (sides) widths.insert(width);
        });
        EXPECT_EQ(widths.size(), c.filled_from > 0.05 ? 3U : c.filled_from > 0.01 ? 2U : 1U);
    }
}

/// What is nearly as flat as the gap that is left, but not beside it.
TEST(ThinGaps, AWiderGapIsNotInIt) {
    const auto staged = conformed(slabs({0.005, 0.009}));
    const ThinGaps gaps = gaps_in(*staged, demand_of_slab(0.009) + 10);
    ASSERT_TRUE(gaps.any());
    staged->for_domain([&](TetId t) {
        const bool is_narrow = staged->mesh.point(staged->mesh.tets().corner(t, 0)).x < 2;
        EXPECT_EQ(gaps.sides_joined_by(staged->mesh, t).has_value(), is_narrow);
    });
}

/// A plate's gap is beneath it.
TEST(ThinGaps, TetrahedraInTheGapJoinItsSides) {
    const auto staged = conformed(plate_above_floor(0.5, 0.001, 0.001));
    const ConformingMesh& mesh = staged->mesh;
    const ThinGaps gaps = gaps_in(*staged, 100);
    ASSERT_TRUE(gaps.any());
    EXPECT_NEAR(gaps.left()->width, 0.001, 1e-9);
    std::size_t inside = 0, outside = 0;
    staged->for_domain([&](TetId t) {
        const auto& corners = mesh.tets().corners(t);
        const Vec3 p = 0.25 * (mesh.point(corners[0]) + mesh.point(corners[1]) + mesh.point(corners[2]) + mesh.point(corners[3]));
        const auto sides = gaps.sides_joined_by(mesh, t);
        const bool beneath = p.z < 0.001 && p.x > 0.25 && p.x < 0.75 && p.y > 0.25 && p.y < 0.75;
        if (beneath) {
            EXPECT_TRUE(sides);
            ++inside;
        }
        if (p.z > 0.1) {
            EXPECT_FALSE(sides);
            ++outside;
        }
    });
    EXPECT_GT(inside, 3U);
    EXPECT_GT(outside, 3U);
}

TEST(ThinGaps, WhatIsForcedIsNoGap) {
    const auto staged = conformed(slabs({0.01, 0.005}));
    const auto is_narrow = [&](TetId t) { return staged->mesh.point(staged->mesh.tets().corner(t, 0)).x > 2; };
    const ThinGaps gaps(staged->mesh, 100, is_narrow, nullptr);
    ASSERT_TRUE(gaps.any());
    EXPECT_NEAR(gaps.left()->vertices + gaps.expected_vertices(), demand_of_slab(0.01), 1e-3);
    EXPECT_NEAR(gaps.left()->narrowest, 0.01, 1e-9);
    EXPECT_FALSE(ThinGaps(staged->mesh, 100, [](TetId) { return true; }, nullptr).any());
}

/// Sides of an acute angle are near each other, but meet.
TEST(ThinGaps, AcuteAnglesAreNoGaps) {
    for (const Plc& plc : {two_blades(0.2), spike(0.5)}) {
        SCOPED_TRACE(plc.vertices.size());
        const auto staged = conformed(plc);
        EXPECT_TRUE(gaps_in(*staged, 1).any());  // edges that end it are apart from each other
        Refiner refiner(staged->mesh, staged->boundary, staged->guard, staged->options);
        refiner.leave_gaps(1);
        EXPECT_FALSE(refiner.gaps().any());
    }
    const auto slab = conformed(slabs({0.01}));
    Refiner refiner(slab->mesh, slab->boundary, slab->guard, slab->options);
    refiner.leave_gaps(1);
    EXPECT_TRUE(refiner.gaps().any());
}

TEST(ThinGaps, AreTheSameInCopies) {
    for (const Plc& plc : {slabs({0.02, 0.005, 0.08}), plate_above_floor(0.5, 0.001, 0.001), blade_above_floor(0.4, 0.001)}) {
        const auto here = conformed(plc);
        const double budget = 0.1 * demand(*here);
        const ThinGaps gaps = gaps_in(*here, budget);
        ASSERT_TRUE(gaps.any());
        const auto compare = [&](std::uint64_t rotation, double scale, double tolerance) {
            const auto there = conformed(transformed(plc, rotation, 0, scale));
            const ThinGaps copy = gaps_in(*there, budget);
            ASSERT_TRUE(copy.any());
            EXPECT_NEAR(copy.left()->width / scale, gaps.left()->width, 1e-6 * gaps.left()->width + tolerance * gaps.left()->width);
            EXPECT_NEAR(copy.left()->narrowest / scale, gaps.left()->narrowest, tolerance * gaps.left()->narrowest);
            EXPECT_NEAR(copy.left()->filled_from / scale, gaps.left()->filled_from, tolerance * gaps.left()->filled_from);
            EXPECT_LE(copy.expected_vertices(), budget);
            // Of pieces equally wide some are filled: which is a matter of rounding.
            const double all = gaps.left()->vertices + gaps.expected_vertices();
            EXPECT_NEAR(copy.left()->vertices + copy.expected_vertices(), all, tolerance * all);
        };
        compare(0, 1024, 1e-12);
        for (const std::uint64_t rotation : {1U, 2U}) compare(rotation, 3e-4, 0.25);
    }
}

}  // namespace
}  // namespace wellmesh::testing
