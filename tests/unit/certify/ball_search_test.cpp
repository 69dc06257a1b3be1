// SPDX-License-Identifier: Apache-2.0
#include "certify/ball_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "wellmesh/predicates.hpp"

namespace wellmesh::certifying {
namespace {

Vec3 random_point(std::uint64_t key) { return {unit_double(mix64(key, 0)), unit_double(mix64(key, 1)), unit_double(mix64(key, 2))}; }

/// Point sets on which rounding matters: a grid (cospherical), a thin layer (huge balls, clusters), far from the origin, tiny.
std::vector<std::vector<Vec3>> point_sets() {
    std::vector<std::vector<Vec3>> sets(5);
    for (std::uint64_t i = 0; i < 300; ++i) {
        sets[0].push_back(random_point(i));
        sets[1].push_back({static_cast<double>(i % 7), static_cast<double>(i / 7 % 7), static_cast<double>(i / 49)});
        Vec3 p = random_point(1000 + i);
        sets[2].push_back({p.x, p.y, 1e-9 * p.z});
        sets[3].push_back(p + Vec3{1e6, -1e6, 1e6});
        sets[4].push_back(1e-40 * p);
    }
    return sets;
}

TEST(BallSearch, FindsEveryVertexInACircumball) {
    std::uint64_t inside_total = 0, flat = 0;
    for (const auto& points : point_sets()) {
        const BallSearch search(points);
        for (std::uint64_t key = 0; key < 400; ++key) {
            std::array<Vec3, 4> p;
            for (std::uint64_t k = 0; k < 4; ++k) p[k] = points[mix64(key, k) % points.size()];
            const Sign s = orient3d(p[0], p[1], p[2], p[3]);
            if (s == Sign::zero) continue;
            if (s == Sign::negative) std::swap(p[0], p[1]);
            std::set<std::uint32_t> expected, visited;
            for (std::uint32_t q = 0; q < points.size(); ++q)
                if (insphere(p[0], p[1], p[2], p[3], points[q]) == Sign::positive) expected.insert(q);
            search.any_in(search.circumball({p[0]}, {p[1]}, {p[2]}, {p[3]}), [&](std::uint32_t q) {
                visited.insert(q);
                return false;
            });
            for (const std::uint32_t q : expected) ASSERT_TRUE(visited.contains(q)) << key;
            inside_total += expected.size();
            flat += visited.size() > 2 * expected.size() + 20;
        }
    }
    EXPECT_GT(inside_total, 10000U);
    EXPECT_LT(flat, 20U) << "the search does not prune";
}

TEST(BallSearch, FindsEveryVertexInEquatorialAndDiametralBalls) {
    std::uint64_t inside_total = 0;
    for (const auto& points : point_sets()) {
        const BallSearch search(points);
        for (std::uint64_t key = 0; key < 400; ++key) {
            const Vec3 &a = points[mix64(key, 10) % points.size()], &b = points[mix64(key, 11) % points.size()], &c = points[mix64(key, 12) % points.size()];
            if (a == b) continue;
            const Ball ball = search.equatorial_ball({a}, {b}, {c}), segment = search.diametral_ball({a}, {b});
            std::set<std::uint32_t> in_ball, in_segment;
            search.any_in(segment, [&](std::uint32_t q) { return in_segment.insert(q), false; });
            if (squared_norm(cross(b - a, c - a)) > 0) search.any_in(ball, [&](std::uint32_t q) { return in_ball.insert(q), false; });
            for (std::uint32_t q = 0; q < points.size(); ++q) {
                if (side_of_diametral_sphere(a, b, points[q]) == Sign::positive) {
                    ++inside_total;
                    ASSERT_TRUE(in_segment.contains(q));
                    EXPECT_NEAR(search.depth(segment, q), 1 - squared_distance(points[q], a + 0.5 * (b - a)) / (squared_distance(a, b) / 4), 1e-8);
                }
                if (squared_norm(cross(b - a, c - a)) > 0 && side_of_equatorial_sphere(a, b, c, points[q]) == Sign::positive) {
                    ++inside_total;
                    ASSERT_TRUE(in_ball.contains(q));
                    EXPECT_GT(search.depth(ball, q), -1e-8);
                }
            }
        }
    }
    EXPECT_GT(inside_total, 10000U);
}

/// Points near a few balls, held against each of them: the same promise as that of a search.
TEST(BallSearch, NeighbourhoodsMissNoVertex) {
    std::uint64_t inside_total = 0, listed = 0, visited_total = 0;
    for (const auto& points : point_sets()) {
        const BallSearch search(points);
        BallSearch::Neighbourhood near;
        for (std::uint64_t key = 0; key < 200; ++key) {
            std::vector<std::array<Vec3, 3>> triangles;
            std::vector<Ball> balls;
            for (std::uint64_t k = 0; balls.size() < 4 && k < 100; ++k) {
                std::array<Vec3, 3> t;
                for (std::uint64_t c = 0; c < 3; ++c) t[c] = points[mix64(mix64(key, k), c) % points.size()];
                if (!(squared_norm(cross(t[1] - t[0], t[2] - t[0])) > 0)) continue;
                triangles.push_back(t);
                balls.push_back(search.equatorial_ball({t[0]}, {t[1]}, {t[2]}));
            }
            if (!search.list_near(balls, near)) continue;
            ++listed;
            for (std::size_t i = 0; i < balls.size(); ++i) {
                std::set<std::uint32_t> visited;
                near.any_in(balls[i], [&](std::uint32_t q) { return visited.insert(q), false; });
                visited_total += visited.size();
                for (std::uint32_t q = 0; q < points.size(); ++q) {
                    if (side_of_equatorial_sphere(triangles[i][0], triangles[i][1], triangles[i][2], points[q]) == Sign::negative) continue;
                    ++inside_total;  // on the sphere, too
                    ASSERT_TRUE(visited.contains(q)) << key;
                }
            }
        }
    }
    EXPECT_GT(listed, 500U);
    EXPECT_GT(inside_total, 10000U);
    EXPECT_LT(visited_total, 2 * inside_total) << "nothing is told apart";
}

/// With weights up to the square of the points' spread, or far below it, or negative: nothing in conflict is pruned, and depth has its sign.
TEST(BallSearch, FindsEveryVertexInConflict) {
    std::uint64_t in_conflict = 0, visits = 0, cases = 0;
    for (const auto& points : point_sets())
        for (const double scale : {0.1, 1e-3, -0.5}) {
            const double spread = squared_distance(points[0], points[1]);
            std::vector<double> weights;
            for (std::uint64_t v = 0; v < points.size(); ++v) weights.push_back(v % 3 == 0 ? 0 : scale * spread * unit_double(mix64(v, 31)));
            const BallSearch search(points, weights);
            const auto at = [&](std::size_t v) { return WeightedPoint{points[v], weights[v]}; };
            for (std::uint64_t key = 0; key < 100; ++key) {
                std::array<WeightedPoint, 4> p;
                for (std::uint64_t k = 0; k < 4; ++k) p[k] = at(mix64(key, k) % points.size());
                if (orient3d(p[0].point, p[1].point, p[2].point, p[3].point) == Sign::negative) std::swap(p[0], p[1]);
                if (orient3d(p[0].point, p[1].point, p[2].point, p[3].point) != Sign::positive) continue;
                const auto look = [&](const Ball& ball, auto&& test) {
                    std::set<std::uint32_t> visited;
                    search.any_in(ball, [&](std::uint32_t q) { return visited.insert(q), false; });
                    visits += visited.size();
                    ++cases;
                    for (std::uint32_t q = 0; q < points.size(); ++q) {
                        if (test(at(q)) != Sign::positive) continue;
                        ++in_conflict;
                        ASSERT_TRUE(visited.contains(q)) << key;
                        EXPECT_GT(search.depth(ball, q), -1e-8);
                    }
                };
                look(search.circumball(p[0], p[1], p[2], p[3]), [&](const WeightedPoint& q) { return power_test(p[0], p[1], p[2], p[3], q); });
                look(search.equatorial_ball(p[0], p[1], p[2]), [&](const WeightedPoint& q) { return equatorial_power_test(p[0], p[1], p[2], q); });
                look(search.diametral_ball(p[0], p[1]), [&](const WeightedPoint& q) { return diametral_power_test(p[0], p[1], q); });
            }
        }
    EXPECT_GT(in_conflict, 10000U);
    EXPECT_LT(visits, cases * 200) << "the search does not prune";
}

TEST(BallSearch, StopsWhenToldTo) {
    const std::vector<Vec3> points = point_sets()[0];
    const BallSearch search(points);
    int visits = 0;
    EXPECT_TRUE(search.any_in(search.diametral_ball({0, 0, 0}, {1, 1, 1}), [&](std::uint32_t) { return ++visits == 3; }));
    EXPECT_EQ(visits, 3);
    EXPECT_FALSE(BallSearch({}).any_in(search.diametral_ball({0, 0, 0}, {1, 1, 1}), [](std::uint32_t) { return true; }));
}

}  // namespace
}  // namespace wellmesh::certifying
