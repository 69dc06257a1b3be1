// SPDX-License-Identifier: Apache-2.0
#include "quality/shape_lanes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/rng.hpp"
#include "quality/tet_shape.hpp"

namespace wellmesh::testing {
namespace {

/// Random, every third one nearly flat, of all sizes.
std::array<Vec3, 4> some_tet(std::uint64_t k) {
    const auto draw = [&](std::uint64_t i) { return unit_double(mix64(k, i)) - 0.5; };
    const double scale = std::pow(10.0, static_cast<double>(k % 7) - 3);
    std::array<Vec3, 4> p;
    for (std::size_t i = 0; i < 4; ++i) p[i] = scale * Vec3{draw(3 * i), draw(3 * i + 1), draw(3 * i + 2)};
    if (k % 3 == 0) p[3] = p[0] + 0.4 * (p[1] - p[0]) + 0.4 * (p[2] - p[0]) + 1e-6 * draw(20) * (p[3] - p[0]);
    if (six_volumes(p[0], p[1], p[2], p[3]) < 0) std::swap(p[0], p[1]);
    return p;
}

std::vector<ShapeLane> arrays_of(const SquaredShapes& s) {
    return {s.six_volumes, s.shortest_edge, s.longest_edge, s.radius_edge, s.sigma, s.scaled_radius, s.areas[0], s.areas[1], s.areas[2], s.areas[3], s.largest_cosine, s.smallest_cosine};
}

TEST(ShapeLanes, AreTheSameBitsWhateverTheProcessorHas) {
    const std::vector<SquareShapes> ways = ways_to_square_shapes();
    for (std::uint64_t k = 0; k < 4000; k += kShapeLanes) {
        CornerLanes corners{};
        for (std::size_t lane = 0; lane < kShapeLanes; ++lane) {
            const auto p = some_tet(k + lane);
            for (std::size_t i = 0; i < 4; ++i) corners.at[i][0][lane] = p[i].x, corners.at[i][1][lane] = p[i].y, corners.at[i][2][lane] = p[i].z;
        }
        SquaredShapes first{};
        ways[0](corners, first);
        for (const SquareShapes way : ways) {
            SquaredShapes shapes{};
            way(corners, shapes);
            ASSERT_EQ(arrays_of(shapes), arrays_of(first)) << k;
        }
    }
}

/// Each tetrahedron once, in order, also the last ones, which fill no lanes; and what is said is true of it.
TEST(ShapeBatch, MeasuresEachTetrahedronOnce) {
    for (const std::size_t count : {0U, 1U, 15U, 16U, 17U, 1000U}) {
        ShapeBatch<std::size_t> batch;
        std::size_t next = 0;
        const auto look = [&](std::size_t k, const SquaredShapes& s, std::size_t lane) {
            ASSERT_EQ(k, next++);
            const auto [a, b, c, d] = some_tet(k);
            ASSERT_EQ(s.six_volumes[lane], six_volumes(a, b, c, d));
            double longest = 0;
            for (const Vec3& p : {a, b, c, d})
                for (const Vec3& q : {a, b, c, d}) longest = std::max(longest, squared_distance(p, q));
            ASSERT_NEAR(s.longest_edge[lane] / longest, 1, 1e-12);
            ASSERT_NEAR(s.shortest_edge[lane] / shortest_edge_squared(a, b, c, d), 1, 1e-9);
            if (!may_trust(s, lane)) return;
            const TetShape shape = shape_of(a, b, c, d);
            ASSERT_NEAR(std::sqrt(s.radius_edge[lane]) / shape.radius_edge, 1, kLaneSlack) << k;
            const double cosine = std::cos(shape.min_dihedral_deg * (std::numbers::pi / 180));
            ASSERT_NEAR(s.largest_cosine[lane], cosine * cosine, kLaneSlack) << k;
        };
        for (std::size_t k = 0; k < count; ++k) {
            const auto [a, b, c, d] = some_tet(k);
            batch.add(k, a, b, c, d, look);
        }
        batch.finish(look);
        EXPECT_EQ(next, count);
        batch.finish(look);
        EXPECT_EQ(next, count);
    }
}

}  // namespace
}  // namespace wellmesh::testing
