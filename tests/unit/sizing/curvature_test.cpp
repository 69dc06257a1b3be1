// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/vec3_math.hpp"
#include "sizing/entity_sizes.hpp"
#include "support/synthetic_plcs.hpp"

namespace wellmesh::testing {
namespace {

constexpr double kPi = std::numbers::pi;

/// A prism over a regular polygon, on its side walls one facet or two triangles a side.
Plc prism(unsigned sides, double radius, double height, bool triangles) {
    Plc plc;
    plc.merge_coplanar = MergeRule::none;
    for (const double z : {0.0, height})
        for (unsigned i = 0; i < sides; ++i) plc.vertices.push_back({radius * std::cos(2 * kPi * i / sides), radius * std::sin(2 * kPi * i / sides), z});
    std::vector<std::uint32_t> bottom, top;
    for (std::uint32_t i = 0; i < sides; ++i) {
        bottom.push_back(i);
        top.push_back(sides + i);
        const std::uint32_t j = (i + 1) % sides;
        if (triangles) {
            plc.facets.push_back({{{i, j, sides + j}}, {}, 1});
            plc.facets.push_back({{{i, sides + j, sides + i}}, {}, 1});
        } else {
            plc.facets.push_back({{{i, j, sides + j, sides + i}}, {}, 1});
        }
    }
    plc.facets.push_back({{bottom}, {}, 2});
    plc.facets.push_back({{top}, {}, 2});
    return plc;
}

/// A sphere: the icosahedron, its edges halved a few times.
Plc sphere(double radius, unsigned halvings) {
    const double g = (1 + std::sqrt(5.0)) / 2;
    Plc plc;
    plc.vertices = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0}, {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g}, {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
    std::vector<std::array<std::uint32_t, 3>> faces{{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                                    {3, 9, 4}, {3, 4, 2}, {3, 2, 6}, {3, 6, 8}, {3, 8, 9}, {4, 9, 5}, {2, 4, 11}, {6, 2, 10}, {8, 6, 7}, {9, 8, 1}};
    for (unsigned h = 0; h < halvings; ++h) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(plc.vertices.size()));
            if (is_new) plc.vertices.push_back(plc.vertices[a] + plc.vertices[b]);
            return at->second;
        };
        std::vector<std::array<std::uint32_t, 3>> finer;
        for (const auto& [a, b, c] : faces) {
            const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            for (const auto& f : {std::array{a, ab, ca}, std::array{b, bc, ab}, std::array{c, ca, bc}, std::array{ab, bc, ca}}) finer.push_back(f);
        }
        faces = finer;
        for (Vec3& p : plc.vertices) p = (1 / norm(p)) * p;
    }
    for (Vec3& p : plc.vertices) p = (radius / norm(p)) * p;
    for (const auto& [a, b, c] : faces) plc.facets.push_back({{{a, b, c}}, {}, 1});
    return plc;
}

EntitySizes curved(const ValidPlc& plc, double elements) {
    EntitySizes sizes = stated_sizes(plc, {});
    add_curvature_sizes(plc, elements, sizes);
    return sizes;
}

TEST(Curvature, OfACylinderIsThatOfItsCircleHoweverItIsCutIntoFacets) {
    for (const bool triangles : {false, true})
        for (const double radius : {1e-5, 1.0, 3e4}) {
            const ValidPlc plc = validate(prism(24, radius, 3 * radius, triangles));
            const EntitySizes sizes = curved(plc, 40);
            const double expected = 2 * kPi * radius / 40;
            for (std::size_t f = 0; f < plc.facets.size(); ++f) {
                if (plc.facets[f].marker == 2) {
                    EXPECT_TRUE(std::isinf(sizes.facets[f]));  // the ends are flat, their outlines sharp
                } else {
                    EXPECT_NEAR(sizes.facets[f], expected, 0.01 * expected);
                }
            }
            std::size_t on_rims = 0;
            for (std::size_t s = 0; s < plc.segments.size(); ++s) {
                if (std::isinf(sizes.segments[s])) continue;
                ++on_rims;
                EXPECT_NEAR(sizes.segments[s], expected, 0.01 * expected);
            }
            EXPECT_EQ(on_rims, 48U);
        }
}

TEST(Curvature, OfASphereIsOneOverItsRadius) {
    const ValidPlc plc = validate(sphere(2, 3));
    const EntitySizes sizes = curved(plc, 30);
    std::vector<double> found = sizes.facets;
    std::sort(found.begin(), found.end());
    const double expected = 2 * kPi * 2 / 30;
    EXPECT_NEAR(found[found.size() / 2], expected, 0.05 * expected);
    EXPECT_GT(found.front(), 0.7 * expected);
    EXPECT_LT(found.back(), 1.3 * expected);
    for (const double h : sizes.segments) EXPECT_TRUE(std::isinf(h));
}

TEST(Curvature, CornersAreNotCurved) {
    for (const Plc& plc : {cube(), l_block(), stepped_shaft()}) {
        const ValidPlc valid = validate(plc);
        const EntitySizes sizes = curved(valid, 100);
        for (const std::vector<double>* of : {&sizes.facets, &sizes.segments})
            for (const double h : *of) EXPECT_TRUE(std::isinf(h));
    }
}

}  // namespace
}  // namespace wellmesh::testing
