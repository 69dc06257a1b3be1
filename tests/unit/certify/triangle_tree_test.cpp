// SPDX-License-Identifier: Apache-2.0
#include "certify/triangle_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh::certifying {
namespace {

Vec3 random_point(std::uint64_t key) { return {unit_double(mix64(key, 0)), unit_double(mix64(key, 1)), unit_double(mix64(key, 2))}; }

TEST(TriangleDistance, Cases) {
    const Corners t{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
    EXPECT_EQ(squared_distance({0.2, 0.2, 3}, t), 9);        // above the inside
    EXPECT_EQ(squared_distance({0.5, -2, 0}, t), 4);         // beside an edge
    EXPECT_EQ(squared_distance({2, 0, 0}, t), 1);            // beyond a corner
    EXPECT_EQ(squared_distance({-3, -4, 0}, t), 25);
    EXPECT_EQ(squared_distance({0.25, 0.25, 0}, t), 0);      // on it
    EXPECT_NEAR(squared_distance({1, 1, 1}, t), 1.5, 1e-15);  // beside the hypotenuse, above
    const Corners needle{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}}, point{{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};
    EXPECT_EQ(squared_distance({1.5, 1, 0}, needle), 1);
    EXPECT_EQ(squared_distance({1, 1, 3}, point), 4);
}

TEST(TriangleDistance, AgreesWithSampling) {
    for (std::uint64_t key = 0; key < 200; ++key) {
        const Corners t{{random_point(mix64(key, 1)), random_point(mix64(key, 2)), random_point(mix64(key, 3))}};
        const Vec3 p = 2.0 * random_point(mix64(key, 4));
        double best = 1e300;
        const int n = 100;
        for (int i = 0; i <= n; ++i)
            for (int j = 0; i + j <= n; ++j) best = std::min(best, distance(p, t[0] + (1.0 * i / n) * (t[1] - t[0]) + (1.0 * j / n) * (t[2] - t[0])));
        const double d = std::sqrt(squared_distance(p, t));
        EXPECT_LE(d, best * (1 + 1e-12)) << key;
        EXPECT_GE(d, best - 0.03) << key;
    }
}

TEST(TriangleTree, NearestAgreesWithATrialOfAll) {
    std::vector<Corners> triangles;
    for (std::uint64_t i = 0; i < 500; ++i) {
        const Vec3 p = random_point(mix64(i, 7));
        triangles.push_back({p, p + 0.1 * random_point(mix64(i, 8)), p + 0.1 * random_point(mix64(i, 9))});
    }
    const TriangleTree tree(triangles);
    for (std::uint64_t key = 0; key < 500; ++key) {
        const Vec3 p = random_point(mix64(key, 10));
        double best = 1e300;
        for (const Corners& t : triangles) best = std::min(best, std::sqrt(squared_distance(p, t)));
        const TriangleTree::Nearest found = tree.nearest(p, static_cast<std::uint32_t>(key % 600));
        EXPECT_EQ(found.distance, best);
        EXPECT_EQ(std::sqrt(squared_distance(p, triangles[found.triangle])), best);
    }
}

/// Surface of the cube [-1, 1]^3, each face from a centre vertex, so that rays from the origin along axes hit vertices.
std::vector<Corners> cube_surface() {
    std::vector<Corners> triangles;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) {
            const auto at = [&](double u, double v) {
                std::array<double, 3> c{};
                c[axis] = side, c[(axis + 1) % 3] = u, c[(axis + 2) % 3] = v;
                return Vec3{c[0], c[1], c[2]};
            };
            const std::array<Vec3, 4> rim{at(-1, -1), at(1, -1), at(1, 1), at(-1, 1)};
            for (std::size_t k = 0; k < 4; ++k) triangles.push_back({at(0, 0), rim[k], rim[(k + 1) % 4]});
        }
    return triangles;
}

TEST(TriangleTree, EnclosesWhatIsInside) {
    const TriangleTree tree(cube_surface());
    int inside = 0;
    for (std::uint64_t key = 0; key < 2000; ++key) {
        const Vec3 p = 3.0 * random_point(key) - Vec3{1.5, 1.5, 1.5};
        const bool expected = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= 1;
        inside += expected;
        const auto found = tree.encloses(p);
        ASSERT_TRUE(found.has_value());
        EXPECT_EQ(*found, expected) << key;
    }
    EXPECT_GT(inside, 300);
    EXPECT_EQ(tree.encloses({0, 0, 0}), true);
    EXPECT_EQ(tree.encloses({0.25, 0.25, 0.25}), true);
    EXPECT_EQ(tree.encloses({0.2, 0.3, 1}), true) << "on a face";
    EXPECT_EQ(tree.encloses({0.2, 0.3, std::nextafter(1.0, 2.0)}), false);
    EXPECT_EQ(tree.encloses({0.2, 0.3, std::nextafter(1.0, 0.0)}), true);
    EXPECT_NE(tree.encloses({1, 1, 1}), false) << "a corner is on it: true, or every ray meets an edge";
    EXPECT_EQ(TriangleTree().encloses({0, 0, 0}), false);
}

TEST(TriangleTree, ACavityIsOutside) {
    std::vector<Corners> both = cube_surface();
    for (const Corners& t : cube_surface()) both.push_back({0.5 * t[0], 0.5 * t[1], 0.5 * t[2]});
    const TriangleTree tree(both);
    EXPECT_EQ(tree.encloses({0.1, 0.2, 0.3}), false);
    EXPECT_EQ(tree.encloses({0.1, 0.2, 0.7}), true);
}

TEST(TriangleTree, EnclosesFarFromTheOrigin) {
    std::vector<Corners> far = cube_surface();
    const Vec3 shift{1e7, -1e7, 1e7};
    for (Corners& t : far)
        for (Vec3& p : t) p = p + shift;
    const TriangleTree tree(far);
    for (std::uint64_t key = 0; key < 500; ++key) {
        const Vec3 offset = 3.0 * random_point(key) - Vec3{1.5, 1.5, 1.5}, p = offset + shift, q = p - shift;
        EXPECT_EQ(tree.encloses(p), std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z)}) <= 1) << key;
    }
}

}  // namespace
}  // namespace wellmesh::certifying
