// SPDX-License-Identifier: Apache-2.0
// What gaps take, against areas and lengths over widths.
#include "validation/gap_demand.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "support/gap_plcs.hpp"
#include "support/synthetic_plcs.hpp"

namespace wellmesh::testing {
namespace {

constexpr double kAll = std::numeric_limits<double>::infinity();

double demand(const Plc& plc, double enough = kAll) { Workers workers(2); return vertices_for_gaps(validate(plc), enough, workers); }

TEST(GapDemand, NothingWithoutGaps) {
    for (const NamedPlc& named : all_synthetic_plcs()) EXPECT_EQ(demand(named.plc), 0) << named.name;
}

/// The local feature size of a slab is its width all over the two squares, and in the middles of their edges.
TEST(GapDemand, OfSlabsIsExact) {
    for (const double width : {0.01, 0.005, 0.001}) EXPECT_NEAR(demand(slabs({width})) * width * width, 1 + 8 * 3 * width, 1e-9) << width;
}

TEST(GapDemand, OfSeveralGapsAddsUp) { EXPECT_NEAR(demand(slabs({0.002, 0.01})), demand(slabs({0.002})) + demand(slabs({0.01})), 1e-6); }

/// Both sides of a plate, and of a floor whose corners are far from it; at the edges, and beside them.
TEST(GapDemand, OfAPlateAboveAFloor) {
    for (const double side : {0.25, 0.5})
        for (const double width : {0.005, 0.001, 0.0002}) {
            const double expected = side * side / (width * width) + (12 + std::numbers::pi) * side / width;
            EXPECT_NEAR(demand(plate_above_floor(side, width, width)) / expected, 1, 0.45) << side << ", " << width;
        }
}

TEST(GapDemand, OfAGapThatWidens) {
    constexpr double kSide = 0.5, kNarrow = 0.0005, kWide = 0.008;
    // The mean of 1 / w^2 from the one width to the other is 1 / (their product).
    const double expected = kSide * kSide / (kNarrow * kWide);
    const double found = demand(plate_above_floor(kSide, kNarrow, kWide));
    EXPECT_GE(found, 0.7 * expected);  // half of it without the floor
    EXPECT_LE(found, 2 * expected);
}

/// Lengths over widths: nothing but an edge is near the floor.
TEST(GapDemand, OfABladeAboveAFloor) {
    for (const double width : {0.01, 0.001, 0.0001}) {
        constexpr double kLength = 0.4;
        const double segments = 3 * kLength / width, beside_it = std::numbers::pi / 2 * kLength / width;
        const double found = demand(blade_above_floor(kLength, width));
        EXPECT_GE(found, 0.99 * segments) << width;
        // Pieces of the blade that have but an edge near the floor count as if they lay along it: that takes over where the gap is narrow beside them.
        if (width > 0.005) { EXPECT_LE(found, 1.5 * (segments + beside_it)); }
    }
}

TEST(GapDemand, OfTwoWires) {
    for (const double width : {0.01, 0.0001}) EXPECT_NEAR(demand(two_wires(0.4, width)) * width / 0.4, 2 * 3 * 0.75, 0.5) << width;  // three quarters are beside each other
}

TEST(GapDemand, IsTheSameForCopies) {
    for (const Plc& plc : {slabs({0.002, 0.01}), plate_above_floor(0.5, 0.001, 0.004), blade_above_floor(0.4, 0.001)}) {
        const double here = demand(plc);
        EXPECT_GT(here, 0);
        EXPECT_DOUBLE_EQ(demand(transformed(plc, 0, 0, 1024)), here);
        for (const std::uint64_t rotation : {1U, 2U, 3U}) EXPECT_NEAR(demand(transformed(plc, rotation, 0, 3e-4)) / here, 1, 0.1) << rotation;
    }
}

TEST(GapDemand, EnoughIsEnough) {
    const Plc plc = plate_above_floor(0.5, 0.001, 0.001);
    const double all = demand(plc);
    for (const double part : {0.0, 0.1, 0.5, 0.99}) {
        const double found = demand(plc, part * all);
        EXPECT_GT(found, part * all);
        EXPECT_LE(found, all);
    }
    EXPECT_LT(demand(plc, 0), 0.5 * all);
    EXPECT_EQ(demand(plc, all), all);
}

/// However much is enough, and wherever the gap is.
TEST(GapDemand, IsComparedWithoutBeingCounted) {
    Workers workers(2);
    std::vector<Plc> plcs{slabs({0.002, 0.01}), plate_above_floor(0.5, 0.0005, 0.008), blade_above_floor(0.4, 0.001), two_wires(0.4, 0.001), crossed_wires(20, 1e-8)};
    for (const NamedPlc& named : all_synthetic_plcs()) plcs.push_back(named.plc);
    for (const Plc& plc : plcs)
        for (const std::uint64_t rotation : {0U, 1U, 2U}) {
            const ValidPlc valid = validate(transformed(plc, rotation, 0, rotation == 2 ? 3e-4 : 1));
            const double all = vertices_for_gaps(valid, kAll, workers);
            for (const double enough : {1e-3, 0.5 * all, 0.99 * all, 1.01 * all, 1e3 * all, 1e5, 1e9})
                EXPECT_EQ(gaps_take_more_than(enough, valid, workers), all > enough) << all << ", " << enough;
        }
}

/// Smaller pieces than kSlender widths are ordinary: they need no more than any mesh does.
TEST(GapDemand, OfShortPiecesIsNotCounted) {
    EXPECT_EQ(demand(blade_above_floor(0.4, 1.01 * 0.4 / kSlender)), 0);
    EXPECT_GT(demand(blade_above_floor(0.4, 0.99 * 0.4 / kSlender)), 0);
}

/// Pieces cover the triangle, and each is as wide everywhere as half to twice what is said, or narrower than its gap, or was halved often enough.
TEST(SampleGap, CoversTheTriangleByPiecesOfAboutOneWidth) {
    const ValidPlc plc = validate(plate_above_floor(0.5, 0.001, 0.1));
    const LocalFeatureSize size(plc);
    const std::array<Vec3, 3> corners{Vec3{0.25, 0.25, 0.001}, Vec3{0.75, 0.25, 0.1}, Vec3{0.75, 0.75, 0.1}};
    const double area = 0.5 * norm(cross(corners[1] - corners[0], corners[2] - corners[0]));
    for (const unsigned most : {0U, 3U, 6U, 12U}) {
        double sum = 0, least = kAll, weighed = 0;
        std::size_t count = 0;
        sample_gap(size, corners, {size(corners[0]), size(corners[1]), size(corners[2])}, [&](double piece, double width) {
            sum += piece;
            weighed += piece / width;
            least = std::min(least, piece);
            ++count;
        }, Halvings{0, most});
        EXPECT_NEAR(sum, area, 1e-12);
        EXPECT_LE(count, std::size_t{1} << most);
        EXPECT_GE(least, 0.999 * area / static_cast<double>(1U << most));
        if (most < 12) continue;
        EXPECT_LT(count, 400U);  // not as often where it is wide
        // Width grows with x alone: the mean of 1 / w over a triangle whose breadth grows as x does.
        const double growth = 0.099, from = 0.001;
        EXPECT_NEAR(weighed / area, 2 / growth * (1 - from / growth * std::log(0.1 / from)), 0.25 * weighed / area);
    }
    std::size_t count = 0;
    sample_gap(size, corners, {0.05, 0.05, 0.05}, [&](double, double) { ++count; }, Halvings{4, 12});
    EXPECT_GE(count, 16U);  // at least so often though its corners are alike
}

/// Pieces that are not slender enough to be told of are not looked for, and no others are missed.
TEST(SampleGap, LooksForSlenderPiecesOnly) {
    const ValidPlc plc = validate(plate_above_floor(0.5, 0.001, 0.1));
    const LocalFeatureSize size(plc);
    const auto random = [](std::uint64_t k) { return unit_double(mix64(11, k)); };
    std::size_t told = 0, left_out = 0;
    for (std::uint64_t k = 0; k < 900; ++k) {
        std::array<Vec3, 3> corners;
        std::array<double, 3> widths{};
        const double reach = std::pow(0.5, static_cast<double>(k % 6));
        for (std::uint64_t i = 0; i < 3; ++i) {
            corners[i] = {random(9 * k) + reach * (random(9 * k + i) - 0.5), 0.5 + reach * (random(1000 + 9 * k + i) - 0.5), 0.05 * random(2000 + 9 * k + i)};
            widths[i] = size(corners[i]);
        }
        for (const double slender : {1.0, 3.0, 8.0}) {
            std::vector<std::pair<double, double>> all, some;
            sample_gap(size, corners, widths, [&](double area, double width) {
                if (area > slender * slender * width * width) all.emplace_back(area, width);
                else ++left_out;
            }, Halvings{4, 8});
            sample_gap(size, corners, widths, [&](double area, double width) { some.emplace_back(area, width); }, Halvings{4, 8}, slender);
            EXPECT_EQ(some, all);
            told += all.size();
        }
    }
    EXPECT_GT(told, 1000U);
    EXPECT_GT(left_out, 1000U);
}

}  // namespace
}  // namespace wellmesh::testing
