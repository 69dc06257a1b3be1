// SPDX-License-Identifier: Apache-2.0
#include "validation/triangulate_facet.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh {
namespace {

using Edge = std::array<std::uint32_t, 2>;

const PlaneProjection kFlat({0, 0, 1});

double area(const std::vector<Vec3>& p, const FacetTriangulation& t) {
    double sum = 0;
    for (const auto& c : t.triangles) {
        EXPECT_EQ(orient2d(kFlat(p[c[0]]), kFlat(p[c[1]]), kFlat(p[c[2]])), Sign::positive);
        sum += 0.5 * cross(p[c[1]] - p[c[0]], p[c[2]] - p[c[0]]).z;
    }
    return sum;
}

/// Each edge belongs to one triangle, on the boundary, or to two that run along it in opposite directions.
void expect_manifold(const FacetTriangulation& t) {
    std::map<Edge, int> directed;
    for (const auto& c : t.triangles)
        for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ((++directed[Edge{c[i], c[(i + 1) % 3]}]), 1);
}

std::vector<Edge> loop(std::uint32_t first, std::uint32_t n) {
    std::vector<Edge> edges;
    for (std::uint32_t i = 0; i < n; ++i) edges.push_back({first + i, first + (i + 1) % n});
    return edges;
}

TEST(TriangulateFacet, StarShapedPolygonsWithPoints) {
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        const auto n = static_cast<std::uint32_t>(3 + mix64(seed) % 40);
        std::vector<Vec3> p;
        double expected = 0;
        for (std::uint32_t i = 0; i < n; ++i) {
            const double a = 2 * std::numbers::pi * i / n, r = 1 + 4 * unit_double(mix64(seed, i));
            p.push_back({r * std::cos(a), r * std::sin(a), 0});
        }
        for (std::uint32_t i = 0; i < n; ++i) expected += 0.5 * cross(p[i], p[(i + 1) % n]).z;
        const bool with_centre = n > 4 && seed % 2 == 0;
        if (with_centre) p.push_back({0, 0, 0});
        const FacetTriangulation t = triangulate_facet(p, kFlat, loop(0, n), {}, 0);
        EXPECT_NEAR(area(p, t), expected, 1e-12 * expected);
        EXPECT_EQ(t.triangles.size(), n - 2 + (with_centre ? 2 : 0));
        EXPECT_EQ(t.constraints.size(), n);
        EXPECT_TRUE(t.splits.empty() && t.crossings.empty());
        expect_manifold(t);
    }
}

TEST(TriangulateFacet, GridsAreFullOfTies) {
    std::vector<Vec3> p;
    for (int x = 0; x < 20; ++x)
        for (int y = 0; y < 20; ++y) p.push_back({static_cast<double>(x), static_cast<double>(y), 0});
    // the outline in four long edges: they run through grid points and are split there
    const std::vector<Edge> edges{{0, 380}, {380, 399}, {399, 19}, {19, 0}};
    const FacetTriangulation t = triangulate_facet(p, kFlat, edges, {}, 0);
    EXPECT_EQ(t.triangles.size(), 722U);
    EXPECT_EQ(t.constraints.size(), 76U);
    EXPECT_EQ(t.splits.size(), 72U);
    EXPECT_EQ(area(p, t), 361);
    expect_manifold(t);
}

TEST(TriangulateFacet, HolesAndSlits) {
    const std::vector<Vec3> p{{0, 0, 0}, {9, 0, 0}, {9, 9, 0}, {0, 9, 0}, {1, 1, 0}, {3, 1, 0}, {3, 3, 0}, {1, 3, 0}, {5, 5, 0}, {8, 5, 0}, {8, 8, 0}, {5, 8, 0}, {5, 2, 0}, {7, 2, 0}};
    std::vector<Edge> edges = loop(0, 4);
    for (const Edge& e : loop(4, 4)) edges.push_back(e);
    for (const Edge& e : loop(8, 4)) edges.push_back(e);
    edges.push_back({12, 13});
    const std::vector<Vec3> holes{{2, 2, 0}, {20, 20, 0}};
    const FacetTriangulation t = triangulate_facet(p, kFlat, edges, holes, 0);
    EXPECT_EQ(area(p, t), 81 - 4);  // the second square encloses area without a hole point: it stays
    EXPECT_EQ(t.idle_holes, std::vector<std::size_t>{1});
    EXPECT_EQ(t.constraints.size(), 13U);
    expect_manifold(t);
}

TEST(TriangulateFacet, CrossingConstraintsAreReported) {
    const std::vector<Vec3> p{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    const std::vector<Edge> edges{{0, 2}, {1, 3}};
    const FacetTriangulation t = triangulate_facet(p, kFlat, edges, {}, 0);
    EXPECT_EQ(t.crossings.size(), 1U);
}

TEST(TriangulateFacet, VerticesWithinRoundingOfAnEdgeSplitIt) {
    for (const double off : {-1e-16, 0.0, 1e-16}) {
        const std::vector<Vec3> p{{0, 0, 0}, {1, off, 0}, {2, 0, 0}, {1, 3, 0}, {1, 0.5, 0}};
        const std::vector<Edge> edges{{0, 2}, {2, 3}, {3, 0}};
        const FacetTriangulation t = triangulate_facet(p, kFlat, edges, {}, 1e-15);
        ASSERT_EQ(t.splits.size(), 1U);
        EXPECT_EQ(t.splits[0].inside, 1U);
        EXPECT_EQ(t.constraints.size(), 4U);
        EXPECT_NEAR(area(p, t), 3, 1e-12);
        EXPECT_EQ(t.triangles.size(), 4U);
    }
}

TEST(TriangulateFacet, TenThousandVerticesTakeNoTime) {
    const std::uint32_t n = 10000;
    std::vector<Vec3> p;
    for (std::uint32_t i = 0; i < n; ++i) {  // a comb: long needles, hard for constraint insertion
        const double a = 2 * std::numbers::pi * i / n, r = i % 2 == 0 ? 1 : 0.2;
        p.push_back({r * std::cos(a), r * std::sin(a), 0});
    }
    const auto start = std::chrono::steady_clock::now();
    const FacetTriangulation t = triangulate_facet(p, kFlat, loop(0, n), {}, 0);
    EXPECT_EQ(t.triangles.size(), n - 2);
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 20);
}

TEST(FitPlane, IsAsPreciseAsTheCoordinatesFarAwayAndOnNeedles) {
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        const auto draw = [&](std::uint64_t k) { return 2 * unit_double(mix64(seed, k)) - 1; };
        Vec3 n{draw(0), draw(1), draw(2)};
        n = (1 / norm(n)) * n;
        Vec3 u = cross(n, {draw(3), draw(4), draw(5)});
        u = (1 / norm(u)) * u;
        const Vec3 v = cross(n, u);
        const double offset = seed % 3 == 0 ? 1e6 : 0, aspect = seed % 2 == 0 ? 1e-5 : 1;
        std::vector<Vec3> points;
        double largest = 0;
        for (std::uint64_t i = 0; i < 12; ++i) {
            points.push_back(Vec3{offset, offset, offset} + draw(10 + 2 * i) * u + (aspect * draw(11 + 2 * i)) * v);
            largest = std::max({largest, std::abs(points.back().x), std::abs(points.back().y), std::abs(points.back().z)});
        }
        const FittedPlane plane = fit_plane(points);
        EXPECT_LE(plane.residual, 4 * 0x1p-52 * largest) << seed;
        EXPECT_NEAR(norm(plane.normal), 1, 1e-14);
    }
}

}  // namespace
}  // namespace wellmesh
