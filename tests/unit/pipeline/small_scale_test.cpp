// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "core/vec3_math.hpp"
#include "support/expect_result.hpp"
#include "support/gap_plcs.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/error.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh::testing {
namespace {

TEST(GenerateOnce, TinyModelsAreMeshedLikeLargeOnes) {
    for (const NamedPlc& named : all_synthetic_plcs()) {
        SCOPED_TRACE(named.name);
        MeshOptions options;
        options.size.edge_length = 0.125 * diagonal(named.plc);
        const Plc plc = transformed(named.plc, 9, 0, 1);
        const MeshResult reference = generate(plc, options);
        for (const int power : {-60, -30}) {
            const double scale = std::ldexp(1.0, power);
            MeshOptions scaled = options;
            *scaled.size.edge_length *= scale;
            const MeshResult result = generate(transformed(plc, 0, 0, scale), scaled);
            EXPECT_EQ(result.mesh.tets, reference.mesh.tets) << power;
            EXPECT_EQ(result.mesh.subfaces, reference.mesh.subfaces);
            ASSERT_EQ(result.mesh.vertices.size(), reference.mesh.vertices.size());
            for (std::size_t v = 0; v < result.mesh.vertices.size(); ++v) ASSERT_EQ(result.mesh.vertices[v], scale * reference.mesh.vertices[v]);
        }
    }
}

TEST(GenerateOnce, DomainsTooSmallForTheirShapesToBeMeasuredAreRefused) {
    const Plc cube = all_synthetic_plcs().front().plc;
    for (const int power : {-122, -140, -178}) {
        try {
            (void)generate(transformed(cube, 0, 0, std::ldexp(1.0, power)), {});
            ADD_FAILURE() << power;
        } catch (const MeshError& e) {
            EXPECT_EQ(e.code(), ErrorCode::coordinate_range);
            EXPECT_NE(std::string(e.what()).find("across"), std::string::npos) << e.what();
        }
    }
    EXPECT_TRUE(generate(transformed(cube, 0, 0, std::ldexp(1.0, -115)), {}).certificate.all.tets > 0);
}

void add(Plc& plc, const std::vector<Vec3>& points, const std::vector<std::vector<std::uint32_t>>& polygons) {
    const auto first = static_cast<std::uint32_t>(plc.vertices.size());
    plc.vertices.insert(plc.vertices.end(), points.begin(), points.end());
    for (std::vector<std::uint32_t> polygon : polygons) {
        for (std::uint32_t& v : polygon) v += first;
        PlcFacet facet;
        facet.polygons = {polygon};
        plc.facets.push_back(facet);
    }
}

Plc corner_tet_inside(const Vec3& at, double width) {
    Plc plc = cube(2);
    const Vec3 a{width, 0, 0}, b{0, width, 0}, c{0, 0, width};
    add(plc, {at, at + a, at + b, at + c}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}});
    return plc;
}

/// A region's volume is compared with that of the facets around it, however much larger its neighbours are.
TEST(ManyScales, ACellOfAMillionthInsideALargeOne) {
    for (const double width : {1e-4, 1e-6, 1e-8}) {
        SCOPED_TRACE(width);
        expect_valid(generate(corner_tet_inside({1.3, 1.2, 1.1}, width)));
    }
}

/// Features as small as the rounding of the input's text have acute angles all the same.
TEST(ManyScales, FeaturesOfTheSizeOfTheRoundingOfTheirText) {
    for (const double width : {1e-4, 1e-5}) {
        Plc plc = corner_tet_inside({1.3, 1.2, 1.1}, width);
        plc.relative_rounding = width / 4;
        MeshOptions options;
        options.limits.max_vertices = 5000;  // against a cascade
        const MeshResult result = generate(plc, options);
        expect_valid(result);
        EXPECT_LT(result.mesh.vertices.size(), 2000U);
    }
}

/// Between a facet and one that hangs close above it, short edges reach across the domain: needles, which are not flat.
TEST(ManyScales, NeedlesInAGapAreNotFlat) {
    for (const double gap : {3e-5, 1e-5, 3e-6}) {
        SCOPED_TRACE(gap);
        Plc plc = cube();
        const double low = 0.3 - 20 * gap, high = 0.3 + 20 * gap;
        add(plc, {{low, low, gap}, {high, low, gap}, {high, high, gap}, {low, high, gap}}, {{0, 1, 2, 3}});
        MeshOptions options;
        options.limits.max_vertices = 20000;
        const MeshResult result = generate(plc, options);
        expect_valid(result);
        EXPECT_LT(result.mesh.vertices.size(), 5000U);
    }
}

Plc square_over_floor(double gap) {
    Plc plc = cube();
    add(plc, {{0.2, 0.2, gap}, {0.8, 0.2, gap}, {0.8, 0.8, gap}, {0.2, 0.8, gap}}, {{0, 1, 2, 3}});
    return plc;
}

Plc layer(double gap) {
    Plc plc;
    const std::array<double, 4> heights{0, 0.5, 0.5 + gap, 1};
    for (std::uint32_t k = 0; k < 4; ++k) add(plc, {{0, 0, heights[k]}, {1, 0, heights[k]}, {1, 1, heights[k]}, {0, 1, heights[k]}}, {{0, 1, 2, 3}});
    for (std::uint32_t k = 0; k < 3; ++k)
        for (std::uint32_t i = 0; i < 4; ++i) {
            const std::uint32_t j = (i + 1) % 4;
            PlcFacet wall;
            wall.polygons = {{4 * k + i, 4 * k + j, 4 * k + 4 + j, 4 * k + 4 + i}};
            plc.facets.push_back(wall);
        }
    return plc;
}

/// What would take billions of vertices is left as it conforms, and every tetrahedron that this leaves below the goals is listed.
TEST(NarrowGaps, AreLeftAndSaid) {
    for (const auto& [make, least, most] : {std::tuple{&square_over_floor, 0.2, 1.0}, std::tuple{&layer, 0.5, 2.0}})
        for (const double gap : {1e-4, 1e-5, 1e-6, 1e-7})
            for (const std::uint64_t rotation : {0U, 5U}) {
                SCOPED_TRACE(gap);
                const MeshResult result = generate(transformed(make(gap), rotation, 0, 1), {});
                expect_valid(result);
                EXPECT_EQ(result.termination, Termination::goals_unmet);
                EXPECT_LT(result.mesh.vertices.size(), 2000U);
                ASSERT_TRUE(result.statistics.gaps);
                const GapStatistics& gaps = *result.statistics.gaps;
                EXPECT_NEAR(gaps.width, gap, 1e-3 * gap);
                EXPECT_GT(gaps.vertices, least / (gap * gap));
                EXPECT_LT(gaps.vertices, most / (gap * gap));
                EXPECT_EQ(gaps.tets, result.exemptions.size());
                EXPECT_GE(result.certificate.unexempt.min_dihedral_angle_deg, 20);
                EXPECT_LE(result.certificate.unexempt.max_radius_edge_ratio, 2);
                for (const Exemption& e : result.exemptions) EXPECT_EQ(e.angle_deg, 0);
            }
}

/// Wider ones are filled as ever, with about as many vertices as are reckoned with.
TEST(NarrowGaps, AreFilledWhereThatTakesFew) {
    for (const double gap : {0.02, 0.01}) {
        const MeshResult result = generate(square_over_floor(gap), {});
        expect_valid(result);
        EXPECT_EQ(result.termination, Termination::goals_met);
        EXPECT_FALSE(result.statistics.gaps);
        EXPECT_GT(static_cast<double>(result.mesh.vertices.size()), 0.5 * 0.36 / (gap * gap));
        EXPECT_LT(static_cast<double>(result.mesh.vertices.size()), 2 * 0.36 / (gap * gap));
    }
}

/// A limit on the vertices is not spent on what it can't fill.
TEST(NarrowGaps, AreLeftWhereTheyTakeMoreThanIsAllowed) {
    MeshOptions options;
    options.limits.max_vertices = 1000;
    const MeshResult result = generate(square_over_floor(0.01), options);
    expect_valid(result);
    EXPECT_TRUE(result.statistics.gaps);
    EXPECT_LT(result.mesh.vertices.size(), 500U);
    EXPECT_GE(result.certificate.unexempt.min_dihedral_angle_deg, 20);
}

void add_box(Plc& plc, const Vec3& low, const Vec3& high) {
    const auto first = static_cast<std::uint32_t>(plc.vertices.size());
    for (unsigned k = 0; k < 8; ++k) plc.vertices.push_back({(k & 1U) != 0 ? high.x : low.x, (k & 2U) != 0 ? high.y : low.y, (k & 4U) != 0 ? high.z : low.z});
    for (const auto& f : {std::array{0U, 1U, 3U, 2U}, {4U, 5U, 7U, 6U}, {0U, 1U, 5U, 4U}, {2U, 3U, 7U, 6U}, {0U, 2U, 6U, 4U}, {1U, 3U, 7U, 5U}})
        add_facet(plc, {first + f[0], first + f[1], first + f[2], first + f[3]});
}

/// Two long edges near each other, and a cavity as flat: the edges would take most vertices.
TEST(NarrowGaps, BetweenEdgesAreLeftToo) {
    for (const double gap : {1e-5, 1e-6, 1e-7})
        for (const std::uint64_t rotation : {0U, 5U})
            for (const bool is_slit : {false, true}) {
                SCOPED_TRACE(gap);
                Plc plc = cube();
                if (is_slit) {
                    add_box(plc, {0.3, 0.3, 0.5}, {0.7, 0.7, 0.5 + gap});
                    plc.hole_seeds.push_back({0.5, 0.5, 0.5 + gap / 2});
                } else {
                    const auto first = static_cast<std::uint32_t>(plc.vertices.size());
                    for (const Vec3& p : {Vec3{0.2, 0.5, 0.5}, Vec3{0.8, 0.5, 0.5}, Vec3{0.8, 0.5, 0.5 + gap}, Vec3{0.2, 0.5, 0.5 + gap}}) plc.vertices.push_back(p);
                    add_facet(plc, {first, first + 1, first + 2, first + 3});
                }
                const MeshResult result = generate(transformed(plc, rotation, 0, 1), {});
                expect_valid(result);
                EXPECT_LT(result.mesh.vertices.size(), 5000U);
                EXPECT_TRUE(result.statistics.gaps);
                EXPECT_GE(result.certificate.unexempt.min_dihedral_angle_deg, 20);
                EXPECT_LE(result.certificate.unexempt.max_radius_edge_ratio, 2);
            }
}

/// While it is filled the facets on its sides have thousands of vertices, and holes that wait for each other to be mended.
TEST(NarrowGaps, AreFilledAlongTiltedFacets) {
    Plc plc = cube();
    const auto first = static_cast<std::uint32_t>(plc.vertices.size());
    for (const Vec3& p : {Vec3{0.3, 0.3, 0.006}, Vec3{0.7, 0.3, 0.006}, Vec3{0.7, 0.7, 0.008}, Vec3{0.3, 0.7, 0.008}}) plc.vertices.push_back(p);
    add_facet(plc, {first, first + 1, first + 2, first + 3});
    const MeshResult result = generate(plc, {});
    expect_valid(result);
    EXPECT_EQ(result.termination, Termination::goals_met);
    EXPECT_GT(result.mesh.vertices.size(), 1000U);
}

}  // namespace
}  // namespace wellmesh::testing
