// SPDX-License-Identifier: Apache-2.0
#include "quality/tet_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/rng.hpp"

namespace wellmesh {
namespace {

using Corners = std::array<Vec3, 4>;

TetShape shape_of(const Corners& p) { return wellmesh::shape_of(p[0], p[1], p[2], p[3]); }
double max_cos(const Corners& p) { return max_cos_dihedral(p[0], p[1], p[2], p[3]); }

Corners oriented(Corners p) {
    if (six_volumes(p[0], p[1], p[2], p[3]) < 0) std::swap(p[0], p[1]);
    return p;
}

Vec3 random_point(std::uint64_t key) { return {unit_double(mix64(key, 0)), unit_double(mix64(key, 1)), unit_double(mix64(key, 2))}; }

/// Tetrahedra of all kinds: round ones, needles, wedges and slivers squashed by up to 1e-6.
Corners random_tet(std::uint64_t key) {
    Corners p;
    for (std::uint64_t i = 0; i < 4; ++i) p[i] = random_point(mix64(key, 10 + i));
    const double squash = std::pow(10.0, -6 * unit_double(mix64(key, 20)));
    switch (mix64(key, 21) % 4) {
        case 0: break;
        case 1: for (Vec3& q : p) q.z *= squash; break;                // sliver or cap
        case 2: p[1] = p[0] + squash * (p[1] - p[0]); break;           // one short edge
        default: for (Vec3& q : p) q.y *= squash, q.z *= squash; break;  // needle
    }
    return oriented(p);
}

TEST(TetShape, RegularTetrahedron) {
    const TetShape s = shape_of(oriented({{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}}));
    const double edge = std::sqrt(8.0);
    EXPECT_NEAR(s.volume, 8.0 / 3, 1e-14);
    EXPECT_NEAR(s.shortest_edge, edge, 1e-14);
    EXPECT_NEAR(s.circumradius, std::sqrt(3.0), 1e-14);
    EXPECT_NEAR(s.radius_edge, std::sqrt(6.0) / 4, 1e-14);
    EXPECT_NEAR(s.aspect, 3, 1e-13);
    EXPECT_NEAR(s.sigma, std::sqrt(2.0) / 12, 1e-14);
    EXPECT_NEAR(s.min_dihedral_deg, 70.528779365509308, 1e-12);
    EXPECT_NEAR(s.max_dihedral_deg, 70.528779365509308, 1e-12);
}

TEST(TetShape, TetrahedronOfTheBodyCentredCubicLattice) {
    const Corners p = oriented({{{0, 0, 0}, {2, 0, 0}, {1, 1, 1}, {1, 1, -1}}});
    const TetShape s = shape_of(p);
    EXPECT_NEAR(s.volume, 2.0 / 3, 1e-15);
    EXPECT_NEAR(s.radius_edge, std::sqrt(5.0 / 12), 1e-15);
    EXPECT_NEAR(s.aspect, std::sqrt(10.0), 1e-13);
    EXPECT_NEAR(s.sigma, 2 / (9 * std::sqrt(3.0)), 1e-15);
    EXPECT_NEAR(s.min_dihedral_deg, 60, 1e-12);
    EXPECT_NEAR(s.max_dihedral_deg, 90, 1e-12);
    EXPECT_NEAR(max_cos(p), 0.5, 1e-15);
}

TEST(TetShape, AnglesBelongToTheEdgesStated) {
    // Corner of a cube: the edges at the corner have right angles, the other three arccos(1/sqrt 3).
    const std::array<double, 6> angles = dihedral_angles_deg({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
    // in the order of the opposite edges: cd, bd, bc, ad, ac, ab
    for (const std::size_t i : {0U, 1U, 2U}) EXPECT_NEAR(angles[i], std::acos(1 / std::sqrt(3.0)) * 180 / std::numbers::pi, 1e-12);
    for (const std::size_t i : {3U, 4U, 5U}) EXPECT_NEAR(angles[i], 90, 1e-12);
}

TEST(TetShape, ExtremesAreThoseOfTheSixAnglesHoweverFlat) {
    for (std::uint64_t key = 0; key < 3000; ++key) {
        const auto draw = [&](std::uint64_t i) { return 2 * unit_double(mix64(71, 16 * key + i)) - 1; };
        const double height = std::pow(10.0, -12 * unit_double(mix64(72, key)));  // from well shaped to almost flat, and needles
        const Vec3 a{0, 0, 0}, b{1, draw(0), height * draw(1)}, c{draw(2), draw(3), height * draw(4)}, d{draw(5), key % 2 == 0 ? draw(6) : height, height * draw(7)};
        const std::array<double, 6> angles = dihedral_angles_deg(a, b, c, d);
        const TetShape s = shape_of(a, b, c, d);
        EXPECT_NEAR(s.min_dihedral_deg, *std::min_element(angles.begin(), angles.end()), 1e-12) << key;
        EXPECT_NEAR(s.max_dihedral_deg, *std::max_element(angles.begin(), angles.end()), 1e-12) << key;
    }
}

TEST(TetShape, FastAngleAgreesWithTheAccurateOne) {
    int small = 0;
    for (std::uint64_t key = 0; key < 20000; ++key) {
        const Corners p = random_tet(key);
        const TetShape s = shape_of(p);
        small += s.min_dihedral_deg < 0.1;
        // The angle that a cosine close to 1 resolves: sqrt(2 * a few roundings) = 3e-8 radians.
        EXPECT_NEAR(min_dihedral_deg(p[0], p[1], p[2], p[3]), s.min_dihedral_deg, 1e-9 + 4e-6 * (s.min_dihedral_deg < 0.1)) << key;
    }
    EXPECT_GT(small, 1000);
}

TEST(TetShape, FastAngleIsWorstForWhatIsNoTetrahedron) {
    const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0}, d{0, 0, 1};
    EXPECT_LT(max_cos_dihedral(a, b, c, d), 1);
    EXPECT_GE(max_cos_dihedral(b, a, c, d), 1);                  // inverted
    EXPECT_GE(max_cos_dihedral(a, b, c, {0.3, 0.3, 0}), 1);      // flat
    EXPECT_GE(max_cos_dihedral(a, b, c, c), 1);                  // a corner twice
    EXPECT_GE(max_cos_dihedral(a, a, a, a), 1);
    EXPECT_GE(max_cos_dihedral(a, b, c, {std::numeric_limits<double>::quiet_NaN(), 0, 1}), 1);
    EXPECT_EQ(min_dihedral_deg(b, a, c, d), 0);
    EXPECT_NEAR(max_cos_dihedral(a, b, c, {0.3, 0.3, 1e-12}), 1, 1e-12);  // nearly flat
}

TEST(TetShape, FastAngleWorksAtAnyScale) {
    for (const double scale : {1e-50, 1e-20, 1.0, 1e20, 1e50}) {
        const Corners p{{{0, 0, 0}, {scale, 0, 0}, {0, scale, 0}, {0, 0, scale}}};
        EXPECT_NEAR(max_cos(p), 1 / std::sqrt(3.0), 1e-15) << scale;
    }
}

TEST(TetShape, AngleTestAgreesWithTheAngle) {
    int below = 0;
    for (std::uint64_t key = 0; key < 20000; ++key) {
        const Corners p = random_tet(key);
        const double cosine = max_cos(p);
        for (const double bound : {std::cos(0.1), std::cos(0.35), std::cos(0.52), cosine * (1 - 1e-12), cosine * (1 + 1e-12)}) {
            EXPECT_EQ(has_dihedral_below(p[0], p[1], p[2], p[3], bound), cosine > bound) << key << " " << bound;
            below += cosine > bound;
        }
    }
    EXPECT_GT(below, 40000);
    for (const double scale : {1e-50, 1e-20, 1.0, 1e20, 1e50}) {
        const Corners p{{{0, 0, 0}, {scale, 0, 0}, {0, scale, 0}, {0, 0, scale}}};
        EXPECT_FALSE(has_dihedral_below(p[0], p[1], p[2], p[3], 0.5774)) << scale;  // 1 / sqrt(3) = 0.57735
        EXPECT_TRUE(has_dihedral_below(p[0], p[1], p[2], p[3], 0.5773)) << scale;
        EXPECT_TRUE(has_dihedral_below(p[1], p[0], p[2], p[3], 0.5774)) << scale;  // inverted
    }
    const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0};
    EXPECT_TRUE(has_dihedral_below(a, b, c, {std::numeric_limits<double>::quiet_NaN(), 0, 1}, 0.99));
    EXPECT_TRUE(has_dihedral_below(a, b, c, {0.3, 0.3, 0}, 0.99));
}

TEST(TetShape, RadiusEdgeSquaredAgrees) {
    for (std::uint64_t key = 0; key < 2000; ++key) {
        const Corners p = random_tet(key);
        const double ratio = shape_of(p).radius_edge;
        EXPECT_NEAR(std::sqrt(radius_edge_squared(p[0], p[1], p[2], p[3])) / ratio, 1, 1e-12) << key;
    }
    EXPECT_EQ(radius_edge_squared({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}), std::numeric_limits<double>::infinity());
}

TEST(TetShape, CircumradiusIsTheDistanceToAllCorners) {
    for (std::uint64_t key = 0; key < 2000; ++key) {
        Corners p = oriented({{random_point(mix64(key, 1)), random_point(mix64(key, 2)), random_point(mix64(key, 3)), random_point(mix64(key, 4))}});
        const TetShape s = shape_of(p);
        const Vec3 centre = p[0] + (1 / (12 * s.volume)) * scaled_circumcentre(p[1] - p[0], p[2] - p[0], p[3] - p[0]);
        for (const Vec3& q : p) EXPECT_NEAR(distance(q, centre) / s.circumradius, 1, 1e-6) << key;
    }
}

// Lemma 2.1 of [LiTeng01]: R / r <= sqrt(3) rho^3 / sigma.
TEST(TetShape, AspectRatioIsBoundedByRadiusEdgeRatioAndSigma) {
    double closest = 0;
    for (std::uint64_t key = 0; key < 100000; ++key) {
        const TetShape s = shape_of(random_tet(key));
        const double bound = std::sqrt(3.0) * s.radius_edge * s.radius_edge * s.radius_edge / s.sigma;
        ASSERT_LE(s.aspect, bound * (1 + 1e-9)) << key;
        closest = std::max(closest, s.aspect / bound);
    }
    EXPECT_GT(closest, 0.8);  // the bound is nearly sharp: it is really tested
}

TEST(TetShape, MeasuresDoNotDependOnTheNumberingOrOnPowersOfTwo) {
    for (std::uint64_t key = 0; key < 500; ++key) {
        const Corners p = random_tet(key), q{p[1], p[2], p[0], p[3]};
        const TetShape s = shape_of(p), t = shape_of(q);
        EXPECT_NEAR(s.aspect / t.aspect, 1, 1e-6);
        EXPECT_NEAR(s.min_dihedral_deg, t.min_dihedral_deg, 1e-7);
        Corners scaled = p;
        for (Vec3& v : scaled) v = 1024.0 * v;
        EXPECT_EQ(shape_of(scaled).radius_edge, s.radius_edge);
        EXPECT_EQ(shape_of(scaled).min_dihedral_deg, s.min_dihedral_deg);
    }
}

TEST(TetShape, MeasuresHoldWhereProductsOfLengthsUnderflowOrOverflow) {
    for (std::uint64_t key = 0; key < 200; ++key) {
        const Corners p = random_tet(key);
        const TetShape s = shape_of(p);
        for (const int power : {-190, -170, -150, -128, -100, 85}) {
            Corners scaled = p;
            for (Vec3& v : scaled) v = std::ldexp(1.0, power) * v;
            const TetShape t = shape_of(scaled);
            EXPECT_DOUBLE_EQ(t.radius_edge, s.radius_edge) << power;
            EXPECT_DOUBLE_EQ(t.aspect, s.aspect) << power;
            EXPECT_DOUBLE_EQ(t.sigma, s.sigma) << power;
            EXPECT_DOUBLE_EQ(t.min_dihedral_deg, s.min_dihedral_deg) << power;
            EXPECT_DOUBLE_EQ(t.circumradius, std::ldexp(s.circumradius, power));
            EXPECT_DOUBLE_EQ(t.shortest_edge, std::ldexp(s.shortest_edge, power));
            EXPECT_DOUBLE_EQ(t.volume, std::ldexp(s.volume, 3 * power));
        }
    }
}

}  // namespace
}  // namespace wellmesh
