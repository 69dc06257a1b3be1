// SPDX-License-Identifier: Apache-2.0
// lfs against its definition, all pairs of features tried.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "support/synthetic_plcs.hpp"
#include "validation/local_feature_size.hpp"

namespace wellmesh::testing {
namespace {

Vec3 random_point(std::uint64_t key, double low, double high) {
    const auto coordinate = [&](std::uint64_t k) { return low + (high - low) * unit_double(mix64(key, k)); };
    return {coordinate(1), coordinate(2), coordinate(3)};
}

/// Distance to a triangle by golden search over two nested convex functions: shares nothing with the code.
double slow_distance_to_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto least = [](auto&& f) {
        double low = 0, high = 1;
        for (unsigned i = 0; i < 45; ++i) {
            const double p = low + 0.381966011250105 * (high - low), q = low + 0.618033988749895 * (high - low);
            if (f(p) < f(q)) high = q;
            else low = p;
        }
        return f((low + high) / 2);
    };
    return least([&](double s) { return least([&](double t) { return norm(x - ((1 - s) * a + s * ((1 - t) * b + t * c))); }); });
}

struct Feature {
    std::vector<std::uint32_t> vertices;
    double distance = 0;
};

double brute_force_lfs(const ValidPlc& plc, const Vec3& x) {
    const auto point = [&](VertexId v) { return plc.vertices[v.index()]; };
    std::vector<Feature> features;
    for (std::size_t i = 0; i < plc.vertices.size(); ++i) features.push_back({{static_cast<std::uint32_t>(i)}, norm(x - plc.vertices[i])});
    for (const ValidSegment& s : plc.segments) {
        const Vec3 a = point(s.ends[0]), d = point(s.ends[1]) - a;
        const double t = std::min(1.0, std::max(0.0, dot(x - a, d) / squared_norm(d)));
        features.push_back({{s.ends[0].value(), s.ends[1].value()}, norm(x - (a + t * d))});
    }
    for (const ValidFacet& f : plc.facets) {
        Feature facet{{}, std::numeric_limits<double>::infinity()};
        for (const VertexId v : f.vertices) facet.vertices.push_back(v.value());
        for (const auto& t : f.triangles) facet.distance = std::min(facet.distance, slow_distance_to_triangle(x, point(t[0]), point(t[1]), point(t[2])));
        features.push_back(facet);
    }
    double lfs = std::numeric_limits<double>::infinity();
    for (const Feature& f : features)
        for (const Feature& g : features) {
            bool touch = false;
            for (const std::uint32_t v : f.vertices)
                for (const std::uint32_t w : g.vertices) touch = touch || v == w;
            if (!touch) lfs = std::min(lfs, std::max(f.distance, g.distance));
        }
    return lfs;
}

TEST(LocalFeatureSize, DistanceToATriangle) {
    for (std::uint64_t k = 0; k < 100; ++k) {
        const Vec3 x = random_point(4 * k, -1, 1), a = random_point(4 * k + 1, -1, 1), b = random_point(4 * k + 2, -1, 1), c = random_point(4 * k + 3, -1, 1);
        EXPECT_NEAR(distance_to_triangle(x, a, b, c), slow_distance_to_triangle(x, a, b, c), 1e-7);
    }
    const Vec3 a{0, 0, 0}, b{1, 0, 0};
    EXPECT_DOUBLE_EQ(distance_to_triangle({2, 0, 0}, a, b, {0.5, 0, 0}), 1);  // degenerate
    EXPECT_DOUBLE_EQ(distance_to_segment({3, 4, 0}, a, a), 5);
}

TEST(LocalFeatureSize, OfACubeByHand) {
    const ValidPlc plc = validate(cube(2));
    const LocalFeatureSize lfs(plc);
    EXPECT_DOUBLE_EQ(lfs({0, 0, 0}), 2);      // a corner: the nearest feature that does not hold it
    EXPECT_DOUBLE_EQ(lfs({1, 1, 1}), 1);      // centre: opposite facets
    EXPECT_DOUBLE_EQ(lfs({1, 0, 0}), 1);      // middle of an edge: the ends are vertices that are not incident
    EXPECT_DOUBLE_EQ(lfs({1, 1, 0}), 1);      // middle of a facet: two opposite edges of it
    EXPECT_DOUBLE_EQ(lfs({5, 1, 1}), std::sqrt(10.0));  // outside: two opposite edges of the facet that it faces
    // A thin slab: facets count, though the paper names vertices and segments only.
    Plc slab = cube(1);
    for (Vec3& p : slab.vertices) p.z *= 0.01;
    const ValidPlc thin = validate(slab);
    EXPECT_NEAR(LocalFeatureSize(thin)({0.5, 0.5, 0}), 0.01, 1e-15);
}

TEST(LocalFeatureSize, EqualsAllPairs) {
    std::vector<Plc> domains;
    for (const NamedPlc& named : all_synthetic_plcs()) domains.push_back(transformed(named.plc, 1, 0, 1));
    for (std::uint64_t seed = 1; seed <= 3; ++seed) domains.push_back(random_polycube(seed).plc);
    std::uint64_t key = 1000;
    for (const Plc& plc : domains) {
        const ValidPlc valid = validate(plc);
        const LocalFeatureSize lfs(valid);
        EXPECT_EQ(lfs.features(), valid.vertices.size() + valid.segments.size() + valid.facets.size());
        for (unsigned i = 0; i < 9; ++i) {
            Vec3 x = random_point(++key, -1, 4);
            if (i % 3 == 0) x = valid.vertices[key % valid.vertices.size()];
            const double d = diagonal(plc);
            EXPECT_NEAR(lfs(x), brute_force_lfs(valid, x), 1e-6 * d);
        }
    }
}

TEST(LocalFeatureSize, IsLipschitz) {
    const ValidPlc plc = validate(transformed(stepped_shaft(), 2, 0, 1));
    const LocalFeatureSize lfs(plc);
    for (std::uint64_t k = 0; k < 2000; ++k) {
        const Vec3 x = random_point(2 * k, -2, 2), y = random_point(2 * k + 1, -2, 2);
        EXPECT_LE(std::abs(lfs(x) - lfs(y)), norm(x - y) * (1 + 1e-12));
    }
}

TEST(SpacingOfPoints, IsTheSecondNearest) {
    std::vector<Vec3> points;
    for (std::uint64_t k = 0; k < 500; ++k) points.push_back(random_point(k, 0, 1));
    const SpacingOfPoints spacing(points);
    for (std::uint64_t k = 0; k < 300; ++k) {
        const Vec3 x = k % 2 ? points[k] : random_point(9000 + k, -0.5, 1.5);
        std::vector<double> d;
        for (const Vec3& p : points) d.push_back(norm(x - p));
        std::nth_element(d.begin(), d.begin() + 1, d.end());
        EXPECT_DOUBLE_EQ(spacing(x), d[1]);
    }
    EXPECT_TRUE(std::isinf(SpacingOfPoints({{0, 0, 0}})({1, 1, 1})));
}

}  // namespace
}  // namespace wellmesh::testing
