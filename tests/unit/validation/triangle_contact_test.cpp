// SPDX-License-Identifier: Apache-2.0
// Contact of triangles against an oracle that clips one by the other in rational arithmetic.
#include "validation/triangle_contact.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <vector>

#include "core/rng.hpp"
#include "validation/plane.hpp"

namespace wellmesh {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using Point = std::array<Rational, 3>;

Point exact(const Vec3& p) { return {Rational(p.x), Rational(p.y), Rational(p.z)}; }
Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Point cross_product(const Point& a, const Point& b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }
Rational dot_product(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// The part of a convex polygon with dot(n, x - o) >= 0.
std::vector<Point> clip(const std::vector<Point>& polygon, const Point& o, const Point& n) {
    std::vector<Point> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const Rational da = dot_product(n, minus(a, o)), db = dot_product(n, minus(b, o));
        if (da >= 0) kept.push_back(a);
        if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
            const Rational t = da / (da - db);
            kept.push_back({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])});
        }
    }
    return kept;
}

/// Corners of the intersection of two closed triangles.
std::vector<Point> intersection(const NamedTriangle& s, const NamedTriangle& t) {
    std::vector<Point> polygon{exact(s.p[0]), exact(s.p[1]), exact(s.p[2])};
    const std::array<Point, 3> q{exact(t.p[0]), exact(t.p[1]), exact(t.p[2])};
    const Point n = cross_product(minus(q[1], q[0]), minus(q[2], q[0])), back{-n[0], -n[1], -n[2]};
    polygon = clip(clip(polygon, q[0], n), q[0], back);
    for (std::size_t i = 0; i < 3; ++i) polygon = clip(polygon, q[i], cross_product(n, minus(q[(i + 1) % 3], q[i])));
    return polygon;
}

bool oracle(const NamedTriangle& s, const NamedTriangle& t) {
    std::vector<Point> common;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            if (s.name[i] == t.name[j]) common.push_back(exact(s.p[i]));
    for (const Point& p : intersection(s, t)) {
        if (common.empty() || common.size() == 3) return true;
        const Point off = minus(p, common[0]);
        if (common.size() == 1 && off != Point{0, 0, 0}) return true;
        if (common.size() == 2 && cross_product(off, minus(common[1], common[0])) != Point{0, 0, 0}) return true;
    }
    return false;
}

class Draw {
public:
    explicit Draw(std::uint64_t seed) : seed_(seed) {}
    std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(unit_double(mix64(seed_, next_++)) * n); }

private:
    std::uint64_t seed_, next_ = 0;
};

TEST(TriangleContact, AgreesWithRationalClippingOnSmallGrids) {
    Draw draw(20240101);
    std::array<std::size_t, 4> met{}, missed{};  // by number of common corners
    for (int i = 0; i < 30000; ++i) {
        const std::uint32_t grid = 2 + draw.below(3);
        std::vector<Vec3> points;
        for (int k = 0; k < 6; ++k)
            points.push_back({static_cast<double>(draw.below(grid)), static_cast<double>(draw.below(grid)), static_cast<double>(draw.below(i % 4 == 0 ? 1 : grid))});
        NamedTriangle s, t;
        for (std::uint32_t k = 0; k < 3; ++k) {
            s.p[k] = points[k];
            s.name[k] = k;
        }
        const std::uint32_t shared = draw.below(3), turn = draw.below(3);
        for (std::uint32_t k = 0; k < 3; ++k) {
            t.name[k] = k < shared ? (k + turn) % 3 : 3 + k;
            t.p[k] = points[t.name[k]];
        }
        // distinct names have distinct places; degenerate triangles are excluded by contract
        bool usable = !collinear(s.p[0], s.p[1], s.p[2]) && !collinear(t.p[0], t.p[1], t.p[2]);
        for (std::uint32_t a = 0; a < 3; ++a)
            for (std::uint32_t b = 0; b < 3; ++b) usable = usable && (s.name[a] == t.name[b]) == (s.p[a] == t.p[b]);
        if (!usable) continue;
        const bool expected = oracle(s, t);
        ++(expected ? met : missed)[shared];
        ASSERT_EQ(contact(s, t).has_value(), expected) << "case " << i;
        ASSERT_EQ(contact(t, s).has_value(), expected) << "case " << i;
    }
    for (std::size_t shared = 0; shared < 3; ++shared) {
        EXPECT_GT(met[shared], 200U) << shared;
        EXPECT_GT(missed[shared], 200U) << shared;
    }
}

TEST(TriangleContact, SegmentsAgreeWithThinTriangles) {
    // a segment meets a triangle iff the fan of two triangles over it, opened towards both sides of everything, does
    Draw draw(7);
    std::size_t met = 0, missed = 0;
    for (int i = 0; i < 20000; ++i) {
        std::array<Vec3, 5> p;
        for (Vec3& q : p) q = {static_cast<double>(draw.below(4)), static_cast<double>(draw.below(4)), static_cast<double>(draw.below(i % 3 == 0 ? 1 : 4))};
        if (collinear(p[2], p[3], p[4]) || p[0] == p[1]) continue;
        bool apart = true;
        for (std::size_t a = 0; a < 2; ++a)
            for (std::size_t b = 2; b < 5; ++b) apart = apart && p[a] != p[b];
        if (!apart) continue;
        const NamedSegment s{{p[0], p[1]}, {0, 1}};
        const NamedTriangle t{{p[2], p[3], p[4]}, {2, 3, 4}};
        // rational: clip the segment, a polygon of two corners, by the triangle
        std::vector<Point> polygon{exact(p[0]), exact(p[1])};
        const std::array<Point, 3> q{exact(p[2]), exact(p[3]), exact(p[4])};
        const Point n = cross_product(minus(q[1], q[0]), minus(q[2], q[0])), back{-n[0], -n[1], -n[2]};
        polygon = clip(clip(polygon, q[0], n), q[0], back);
        for (std::size_t k = 0; k < 3; ++k) polygon = clip(polygon, q[k], cross_product(n, minus(q[(k + 1) % 3], q[k])));
        ++(polygon.empty() ? missed : met);
        ASSERT_EQ(contact(s, t).has_value(), !polygon.empty()) << i;
    }
    EXPECT_GT(met, 1000U);
    EXPECT_GT(missed, 1000U);
}

TEST(TriangleContact, Segments) {
    const NamedSegment a{{Vec3{0, 0, 0}, Vec3{2, 2, 2}}, {0, 1}};
    EXPECT_TRUE(contact(a, NamedSegment{{Vec3{0, 2, 1}, Vec3{2, 0, 1}}, {2, 3}}).has_value());
    EXPECT_FALSE(contact(a, NamedSegment{{Vec3{0, 2, 0}, Vec3{2, 0, 1}}, {2, 3}}).has_value());
    EXPECT_TRUE(contact(a, NamedSegment{{Vec3{1, 1, 1}, Vec3{3, 3, 3}}, {2, 3}}).has_value());
    EXPECT_FALSE(contact(a, NamedSegment{{Vec3{3, 3, 3}, Vec3{4, 4, 4}}, {2, 3}}).has_value());
    EXPECT_TRUE(contact(a, NamedSegment{{Vec3{0, 0, 0}, Vec3{1, 1, 1}}, {0, 3}}).has_value());
    EXPECT_FALSE(contact(a, NamedSegment{{Vec3{0, 0, 0}, Vec3{-1, -1, -1}}, {0, 3}}).has_value());
    EXPECT_FALSE(contact(a, NamedSegment{{Vec3{0, 0, 0}, Vec3{1, 0, 0}}, {0, 3}}).has_value());
}

}  // namespace
}  // namespace wellmesh
