// SPDX-License-Identifier: Apache-2.0
#include "refinement/planar_refiner.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "core/rng.hpp"

namespace wellmesh::testing {
namespace {

using Point = PlanarRefiner::Point;
using Corners = PlanarRefiner::Corners;

double squared_distance(const Point& p, const Point& q) { return (p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y); }
double area_of(const Point& a, const Point& b, const Point& c) { return ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2; }

struct Circle {
    Point centre;
    double squared_radius = 0;
};

Circle circle_of(const Point& a, const Point& b, const Point& c) {
    const double ux = b.x - a.x, uy = b.y - a.y, vx = c.x - a.x, vy = c.y - a.y, u2 = ux * ux + uy * uy, v2 = vx * vx + vy * vy, d = 2 * (ux * vy - uy * vx);
    const double x = (vy * u2 - uy * v2) / d, y = (ux * v2 - vx * u2) / d;
    return {{a.x + x, a.y + y}, x * x + y * y};
}

std::vector<Corners> triangles_of(const PlanarRefiner& plane) {
    std::vector<Corners> out;
    plane.for_each_triangle([&](const Corners& c) { out.push_back(c); });
    return out;
}

/// A square of side 2, turned, moved and scaled.
struct Square {
    double angle = 0, scale = 1;
    Point origin{};
    [[nodiscard]] Point at(double x, double y) const {
        return {origin.x + scale * (std::cos(angle) * x - std::sin(angle) * y), origin.y + scale * (std::sin(angle) * x + std::cos(angle) * y)};
    }
    [[nodiscard]] std::vector<Point> corners() const { return {at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)}; }
};

const std::vector<Square> kSquares{{}, {0.3, 1, {}}, {2, 1e-7, {1e-3, -2e-3}}, {1, 1e6, {-1e9, 1e8}}};
constexpr auto kAlways = [] { return true; };
constexpr auto kAnyNeighbour = [](const Point&, std::uint32_t) { return true; };

/// Its sides split into `pieces`.
void begin_square(PlanarRefiner& plane, const Square& square, std::uint32_t pieces) {
    EXPECT_TRUE(plane.begin(square.corners(), std::vector<Corners>{{0, 1, 2}, {0, 2, 3}}, std::vector<std::uint8_t>{0, 0}));
    const std::vector<Point> corners = square.corners();
    for (std::uint32_t side = 0; side < 4; ++side) {
        std::uint32_t before = side;
        for (std::uint32_t k = 1; k < pieces; ++k) {
            const Point &a = corners[side], &b = corners[(side + 1) % 4];
            const double t = static_cast<double>(k) / pieces;
            before = plane.split_edge(before, (side + 1) % 4, {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)});
            EXPECT_NE(before, PlanarRefiner::kNone);
        }
    }
}

/// Then refined to `radius`; lengths in half sides. @return edges that were encroached
std::set<std::pair<std::uint32_t, std::uint32_t>> refine_square(PlanarRefiner& plane, const Square& square, std::uint32_t pieces, double radius, std::uint64_t seed = 1) {
    begin_square(plane, square, pieces);
    std::set<std::pair<std::uint32_t, std::uint32_t>> encroached;
    std::size_t inserted = 0;
    const std::size_t before = plane.points().size();
    const double most = radius * square.scale;
    EXPECT_TRUE(plane.refine([&](const Point&) { return most * most; },
                             [&](const Corners& c, double r, Point& p) {
                                 p.x += 0.02 * r * (unit_double(mix64(seed, mix64(c[0], mix64(c[1], c[2])))) - 0.5);
                             },
                             [&](std::uint32_t a, std::uint32_t b) { encroached.emplace(std::min(a, b), std::max(a, b)); }, kAnyNeighbour, [&] { ++inserted; }, kAlways));
    EXPECT_EQ(plane.points().size(), before + inserted);
    return encroached;
}

TEST(PlanarRefiner, SquareIsCoveredDelaunayAndFineEnough) {
    for (const Square& square : kSquares)
        for (std::uint64_t seed = 1; seed < 4; ++seed) {
            PlanarRefiner plane;
            EXPECT_TRUE(refine_square(plane, square, 20, 0.1, seed).empty());  // pieces of 1, in radii
            const auto points = plane.points();
            const std::vector<Corners> triangles = triangles_of(plane);
            EXPECT_GT(points.size(), 300U);
            double area = 0, largest = 0;
            std::vector<char> is_used(points.size(), 0);
            for (const Corners& c : triangles) {
                const double a = area_of(points[c[0]], points[c[1]], points[c[2]]);
                ASSERT_GT(a, 0);
                area += a;
                const Circle circle = circle_of(points[c[0]], points[c[1]], points[c[2]]);
                largest = std::max(largest, std::sqrt(circle.squared_radius));
                for (const std::uint32_t v : c) is_used[v] = 1;
                // Points evenly spaced on a line are on no circle with a third; elsewhere nothing is near a tie.
                for (const Point& p : points) ASSERT_GT(squared_distance(circle.centre, p), circle.squared_radius * (1 - 1e-6));
            }
            EXPECT_NEAR(area / (square.scale * square.scale), 4, 1e-6);
            EXPECT_LE(largest, 0.1 * square.scale * (1 + 1e-6));
            EXPECT_EQ(std::count(is_used.begin(), is_used.end(), 0), 0);
            EXPECT_EQ(triangles.size(), 2 * points.size() - 2 - 80);  // Euler, 80 points on the rim
        }
}

/// Sides that are too long keep the inside coarse beside them, and that is told.
TEST(PlanarRefiner, FixedEdgesStayAndTellWhatTheyKeepAway) {
    PlanarRefiner plane;
    const auto encroached = refine_square(plane, {}, 2, 0.1);
    const auto points = plane.points();
    EXPECT_GT(points.size(), 40U);
    EXPECT_EQ(encroached.size(), 8U);
    for (const auto& [i, j] : encroached) {
        ASSERT_LT(j, 8U);
        const Point &a = points[i], &b = points[j], middle{(a.x + b.x) / 2, (a.y + b.y) / 2};
        EXPECT_NEAR(squared_distance(a, b), 1, 1e-12);
        for (std::uint32_t v = 8; v < points.size(); ++v) EXPECT_GE(squared_distance(points[v], middle), 0.25 - 1e-9);
    }
}

/// A slit from the middle of the left side to the centre of the square.
TEST(PlanarRefiner, SlitsAreSplitAndNeverCrossed) {
    PlanarRefiner plane;
    const std::vector<Point> points{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, 0}, {0, 0}};
    const std::vector<Corners> triangles{{0, 1, 5}, {1, 2, 5}, {2, 3, 5}, {3, 4, 5}, {4, 0, 5}};
    ASSERT_TRUE(plane.begin(points, triangles, std::vector<std::uint8_t>{0, 0, 0, 1, 2}));
    std::vector<std::uint32_t> on_slit{4};
    for (int k = 1; k < 5; ++k) on_slit.push_back(plane.split_edge(on_slit.back(), 5, {-1 + 0.2 * k, 0}));
    on_slit.push_back(5);
    EXPECT_TRUE(plane.refine([](const Point&) { return 0.04; }, [](const Corners&, double, Point& p) { p.x += 1e-3; }, [](std::uint32_t, std::uint32_t) {}, kAnyNeighbour, [] {}, kAlways));
    std::multiset<std::pair<std::uint32_t, std::uint32_t>> edges;
    double area = 0;
    for (const Corners& c : triangles_of(plane)) {
        area += area_of(plane.points()[c[0]], plane.points()[c[1]], plane.points()[c[2]]);
        for (unsigned k = 0; k < 3; ++k) edges.emplace(std::min(c[k], c[(k + 1) % 3]), std::max(c[k], c[(k + 1) % 3]));
    }
    EXPECT_NEAR(area, 4, 1e-12);
    for (std::size_t k = 0; k + 1 < on_slit.size(); ++k) EXPECT_EQ(edges.count({std::min(on_slit[k], on_slit[k + 1]), std::max(on_slit[k], on_slit[k + 1])}), 2U);
}

TEST(PlanarRefiner, NeighboursMayBeRefused) {
    PlanarRefiner plane;
    ASSERT_TRUE(plane.begin(Square{}.corners(), std::vector<Corners>{{0, 1, 2}, {0, 2, 3}}, std::vector<std::uint8_t>{0, 0}));
    const auto far_from_first = [&](const Point& p, std::uint32_t v) { return v != 0 || squared_distance(p, plane.points()[0]) > 1; };
    EXPECT_TRUE(plane.refine([](const Point&) { return 0.01; }, [](const Corners&, double, Point& p) { p.y += 1e-3; }, [](std::uint32_t, std::uint32_t) {}, far_from_first, [] {}, kAlways));
    for (std::uint32_t v = 4; v < plane.points().size(); ++v) EXPECT_GT(squared_distance(plane.points()[v], plane.points()[0]), 1);
}

TEST(PlanarRefiner, WhatIsNoTriangulationIsRefused) {
    const std::vector<Point> points{{0, 0}, {1, 0}, {0, 1}, {1, 1}, {2, 2}};
    PlanarRefiner plane;
    EXPECT_FALSE(plane.begin(points, std::vector<Corners>{{0, 3, 4}}, std::vector<std::uint8_t>{0}));  // flat
    EXPECT_FALSE(plane.begin(points, std::vector<Corners>{{0, 2, 1}}, std::vector<std::uint8_t>{0}));  // clockwise
    EXPECT_FALSE(plane.begin(points, std::vector<Corners>{{0, 1, 2}, {0, 1, 3}, {0, 1, 2}}, std::vector<std::uint8_t>{0, 0, 0}));
    ASSERT_TRUE(plane.begin(points, std::vector<Corners>{{0, 1, 2}}, std::vector<std::uint8_t>{0}));
    EXPECT_EQ(plane.split_edge(0, 3, {0.5, 0.5}), PlanarRefiner::kNone);    // no edge
    EXPECT_EQ(plane.split_edge(0, 1, {1.5, 0}), PlanarRefiner::kNone);  // beyond its end
    EXPECT_NE(plane.split_edge(0, 1, {0.5, 0}), PlanarRefiner::kNone);
}

TEST(PlanarRefiner, EndsWhenTold) {
    PlanarRefiner plane;
    begin_square(plane, {}, 200);
    int asked = 0;
    EXPECT_FALSE(plane.refine([](const Point&) { return 1e-4; }, [](const Corners&, double r, Point& p) { p.x += 0.01 * r; }, [](std::uint32_t, std::uint32_t) {}, kAnyNeighbour, [] {},
                              [&] { return ++asked < 3; }));
    EXPECT_EQ(asked, 3);
}

}  // namespace
}  // namespace wellmesh::testing
