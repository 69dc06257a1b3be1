// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <vector>

#include "certify/plane_triangulation.hpp"
#include "certify/planar_mesh.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh::certifying {
namespace {

struct Sheet {
    std::vector<Vec3> points;
    PlcFacet facet;

    void polygon(const std::vector<std::array<double, 2>>& corners) {
        std::vector<std::uint32_t> numbers;
        for (const auto& [x, y] : corners) {
            numbers.push_back(static_cast<std::uint32_t>(points.size()));
            points.push_back({x, y, 0});
        }
        facet.polygons.push_back(numbers);
    }
    [[nodiscard]] std::vector<Corners> cover() const {
        const auto result = triangulate_facet(points, facet);
        EXPECT_TRUE(result.has_value());
        return result.value_or(std::vector<Corners>{});
    }
};

double area(const std::vector<Corners>& triangles) {
    double sum = 0;
    for (const Corners& t : triangles) sum += norm(cross(t[1] - t[0], t[2] - t[0])) / 2;
    return sum;
}

bool covers(const std::vector<Corners>& triangles, double x, double y) {
    return std::any_of(triangles.begin(), triangles.end(), [&](const Corners& t) { return squared_distance({x, y, 0}, t) == 0; });
}

TEST(TriangulateFacet, TriangleAndSquare) {
    Sheet s;
    s.polygon({{0, 0}, {1, 0}, {0, 1}});
    EXPECT_EQ(s.cover().size(), 1U);
    Sheet q;
    q.polygon({{0, 0}, {2, 0}, {2, 2}, {0, 2}});
    EXPECT_EQ(q.cover().size(), 2U);
    EXPECT_EQ(area(q.cover()), 4);
}

TEST(TriangulateFacet, NothingForWhatHasNoArea) {
    Sheet s;
    s.polygon({{0, 0}, {1, 1}, {2, 2}});
    EXPECT_TRUE(s.cover().empty());
    Sheet p;
    p.polygon({{0, 0}, {1, 0}});
    EXPECT_TRUE(p.cover().empty());
}

TEST(TriangulateFacet, NestedPolygonIsAHoleOnlyWithAHolePoint) {
    Sheet s;
    s.polygon({{0, 0}, {4, 0}, {4, 4}, {0, 4}});
    s.polygon({{1, 1}, {3, 1}, {3, 3}, {1, 3}});
    EXPECT_DOUBLE_EQ(area(s.cover()), 16);
    s.facet.holes = {{2, 2, 0}};
    EXPECT_DOUBLE_EQ(area(s.cover()), 12);
    EXPECT_FALSE(covers(s.cover(), 2, 2));
    EXPECT_TRUE(covers(s.cover(), 0.5, 2));
    s.facet.holes = {{0.5, 0.5, 0}};  // the other way round
    EXPECT_DOUBLE_EQ(area(s.cover()), 4);
    s.facet.holes = {{1e9, 0.5, 0}};  // outside anyway
    EXPECT_DOUBLE_EQ(area(s.cover()), 16);
}

TEST(TriangulateFacet, IslandsAndSlitsAndPoints) {
    Sheet s;
    s.polygon({{0, 0}, {4, 0}, {4, 4}, {0, 4}});
    s.polygon({{1, 1}, {3, 1}, {3, 3}, {1, 3}});
    s.polygon({{1.5, 1.5}, {2.5, 1.5}, {2.5, 2.5}, {1.5, 2.5}});  // an island in the hole
    s.facet.holes = {{1.2, 1.2, 0}};
    s.polygon({{0.5, 0.5}, {0.5, 3}});  // a slit
    s.polygon({{3.5, 3.7}});            // a point
    s.polygon({{6, 0}, {7, 0}, {7, 1}});  // apart
    const auto cover = s.cover();
    EXPECT_DOUBLE_EQ(area(cover), 12 + 1 + 0.5);
    // Slit and point are corners of triangles.
    for (const Vec3 p : {Vec3{0.5, 0.5, 0}, Vec3{0.5, 3, 0}, Vec3{3.5, 3.7, 0}})
        EXPECT_TRUE(std::any_of(cover.begin(), cover.end(), [&](const Corners& t) { return std::find(t.begin(), t.end(), p) != t.end(); }));
}

TEST(TriangulateFacet, CollinearAndRepeatedVertices) {
    Sheet s;
    s.polygon({{0, 0}, {1, 0}, {2, 0}, {4, 0}, {4, 4}, {4, 4}, {2, 4}, {0, 4}, {0, 1}});
    EXPECT_DOUBLE_EQ(area(s.cover()), 16);
    s.polygon({{1, 0}, {1, 4}});  // ends in the middle of an edge
    EXPECT_DOUBLE_EQ(area(s.cover()), 16);
}

TEST(TriangulateFacet, CrossingEdges) {
    Sheet s;
    s.polygon({{0, 0}, {4, 0}, {4, 4}, {0, 4}});
    s.polygon({{1, -1}, {1, 5}});  // a wire across and beyond
    EXPECT_DOUBLE_EQ(area(s.cover()), 16);
    Sheet bow;
    bow.polygon({{0, 0}, {2, 3}, {2, 0}, {0, 2}});
    EXPECT_NEAR(area(bow.cover()), 0.5 * 2 * 0.8 + 0.5 * 3 * 1.2, 1e-12);
}

TEST(TriangulateFacet, AnyPlane) {
    for (std::uint64_t key = 0; key < 50; ++key) {
        const auto draw = [&](std::uint64_t i) { return 2 * unit_double(mix64(key, i)) - 1; };
        const Vec3 u{draw(0), draw(1), draw(2)}, v0{draw(3), draw(4), draw(5)}, v = v0 - (dot(u, v0) / squared_norm(u)) * u, o{100 * draw(6), draw(7), draw(8)};
        Sheet s;
        s.polygon({{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}});
        s.polygon({{1, 0.5}, {2, 0.25}, {3, 0.5}});
        s.facet.holes = {{2, 0.4, 0}};
        for (Vec3& p : s.points) p = o + p.x * u + p.y * v;
        for (Vec3& p : s.facet.holes) p = o + p.x * u + p.y * v;
        const double unit = norm(u) * norm(v);
        EXPECT_NEAR(area(s.cover()) / unit, 10 - 0.25, 1e-9) << key;
    }
}

TEST(TriangulateFacet, RandomStars) {
    for (std::uint64_t key = 0; key < 100; ++key) {
        Sheet s;
        std::vector<std::array<double, 2>> corners;
        const std::uint64_t n = 5 + mix64(key, 1) % 100;
        double expected = 0;
        for (std::uint64_t i = 0; i < n; ++i) {
            const double angle = 2 * 3.14159265358979 * static_cast<double>(i) / static_cast<double>(n), radius = 0.05 + unit_double(mix64(key, 2 + i));
            corners.push_back({radius * std::cos(angle), radius * std::sin(angle)});
        }
        for (std::size_t i = 0; i < n; ++i) expected += (corners[i][0] * corners[(i + 1) % n][1] - corners[(i + 1) % n][0] * corners[i][1]) / 2;
        s.polygon(corners);
        const auto cover = s.cover();
        EXPECT_EQ(cover.size(), n - 2);
        EXPECT_NEAR(area(cover), expected, 1e-12 * static_cast<double>(n));
    }
}

// A comb is bad for ear clipping, a circle for flips: both with 20000 vertices, and so is a grid of touching squares.
TEST(TriangulateFacet, LargeFacetsAreNotQuadratic) {
    const auto begin = std::chrono::steady_clock::now();
    const int n = 10000;
    std::vector<std::array<double, 2>> comb, circle;
    for (int i = 0; i < n; ++i) comb.push_back({1.0 * i, i % 2 == 0 ? 0.0 : 100.0});
    for (int i = n; i-- > 0;) comb.push_back({1.0 * i, (i % 2 == 0 ? 0.0 : 100.0) + 1});
    for (int i = 0; i < 2 * n; ++i) circle.push_back({std::cos(3.14159265358979 * i / n), std::sin(3.14159265358979 * i / n)});
    Sheet a, b, c;
    a.polygon(comb);
    EXPECT_EQ(a.cover().size(), comb.size() - 2);
    EXPECT_NEAR(area(a.cover()), n - 1, 1e-6);
    b.polygon(circle);
    EXPECT_NEAR(area(b.cover()), 3.14159265358979, 1e-6);
    c.polygon({{0, 0}, {100, 0}, {100, 100}, {0, 100}});
    for (int i = 0; i < 50; ++i)
        for (int j = 0; j < 50; ++j) {
            c.polygon({{2.0 * i + 0.5, 2.0 * j + 0.5}, {2.0 * i + 1.5, 2.0 * j + 0.5}, {2.0 * i + 1.5, 2.0 * j + 1.5}, {2.0 * i + 0.5, 2.0 * j + 1.5}});
            c.facet.holes.push_back({2.0 * i + 1, 2.0 * j + 1, 0});
        }
    EXPECT_NEAR(area(c.cover()), 7500, 1e-8);
    // Quadratic would be minutes; sanitizers slow this down tenfold.
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
}

TEST(Orient2d, IsExact) {
    EXPECT_EQ(orient2d({0, 0}, {1, 0}, {0, 1}), Sign::positive);
    EXPECT_EQ(orient2d({0, 0}, {0, 1}, {1, 0}), Sign::negative);
    const double u = 0x1p-53;
    int zeros = 0;
    for (int i = -8; i <= 8; ++i)
        for (int j = -8; j <= 8; ++j) {
            const Point2 p{0.5 + i * u, 0.5 + j * u};
            const Sign expected = i == j ? Sign::zero : j > i ? Sign::positive : Sign::negative;
            EXPECT_EQ(orient2d({12, 12}, {24, 24}, p), expected) << i << " " << j;
            zeros += i == j;
        }
    EXPECT_EQ(zeros, 17);
}

}  // namespace
}  // namespace wellmesh::certifying
