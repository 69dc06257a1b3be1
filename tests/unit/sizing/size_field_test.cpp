// SPDX-License-Identifier: Apache-2.0
#include "sizing/size_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/infinity.hpp"
#include "core/vec3_math.hpp"
#include "random_points.hpp"
#include "support/synthetic_plcs.hpp"

namespace wellmesh::testing {
namespace {

/// The largest excess of |F(p) - F(q)| over g |p - q| and the interpolation's error, over F; pairs near and far.
double steepest(const SizeField& field, double gradation, std::uint64_t seed) {
    RandomPoints random(seed);
    double worst = -kInfinity;
    for (int i = 0; i < 20'000; ++i) {
        const Vec3 p = random.point(), d = random.point() - Vec3{0.5, 0.5, 0.5};
        Vec3 q = p + std::exp2(-10 * random.number()) * d;
        q = {std::clamp(q.x, 0.0, 1.0), std::clamp(q.y, 0.0, 1.0), std::clamp(q.z, 0.0, 1.0)};
        const double fp = field.edge_length(p, CellId{1}), fq = field.edge_length(q, CellId{1});
        worst = std::max(worst, (std::abs(fp - fq) - gradation * distance(p, q)) / std::min(fp, fq));
    }
    return worst;
}

TEST(SizeField, OneSizeIsAConstant) {
    const ValidPlc plc = validate(cube());
    SizeGoals goals;
    EXPECT_FALSE(SizeField(plc, goals).asks());
    goals.edge_length = 0.1;
    const SizeField field(plc, goals);
    EXPECT_FALSE(field.varies());
    EXPECT_EQ(field.edge_length({0.5, 0.5, 0.5}, CellId{1}), 0.1);
    EXPECT_EQ(field.smallest(), 0.1);
    EXPECT_NEAR(field.of({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, CellId{1}).max_squared_circumradius, 0.07 * 0.07, 1e-15);
}

TEST(SizeField, SizesGrowByTheGradationFromEverySource) {
    Plc input = cube();
    input.vertex_markers.assign(8, 0);
    input.vertex_markers[0] = 1;
    input.facets[0].marker = 2;
    const ValidPlc plc = validate(input);
    const ValidFacet& facet = *std::find_if(plc.facets.begin(), plc.facets.end(), [](const ValidFacet& f) { return f.marker == 2; });
    for (const double g : {0.1, 0.3, 1.0}) {
        SizeGoals goals;
        goals.gradation = g;
        goals.entities = {{EntityKind::vertex, 1, 0.01}, {EntityKind::facet, 2, 0.1}};
        goals.edge_length = 0.4;
        const SizeField field(plc, goals);
        ASSERT_TRUE(field.varies());
        RandomPoints random(2);
        for (int i = 0; i < 5000; ++i) {
            const Vec3 p = random.point();
            const double exact = std::min({0.4, 0.01 + g * distance(p, plc.vertices[0]), 0.1 + g * std::abs(dot(p - facet.origin, facet.normal))});
            ASSERT_NEAR(field.edge_length(p, CellId{1}), exact, 0.12 * exact);
        }
        EXPECT_LT(steepest(field, g, 1), 0.15);
        EXPECT_NEAR(field.smallest(), 0.01, 1e-12);
    }
}

TEST(SizeField, CallbacksThatGrowFasterAreLimited) {
    const ValidPlc plc = validate(cube());
    const std::vector<std::function<double(const Vec3&)>> fields{
        [](const Vec3& p) { return norm(p - Vec3{0.5, 0.5, 0.5}) < 0.15 ? 0.08 : 1.0; },
        [](const Vec3& p) { return p.x < 0.1 ? 0.15 : kInfinity; },
        [](const Vec3& p) { return 0.1 + 0.5 * (1 + std::sin(9 * p.x) * std::sin(7 * p.y)); },
        [](const Vec3& p) { return 0.05 + 2 * norm(p - Vec3{1, 1, 1}); },
    };
    for (std::size_t k = 0; k < fields.size(); ++k) {
        SCOPED_TRACE(k);
        SizeGoals goals;
        goals.at = fields[k];
        const SizeField field(plc, goals);
        EXPECT_LT(steepest(field, goals.gradation, k), 0.15);
        RandomPoints random(k);
        for (int i = 0; i < 3000; ++i) {
            const Vec3 p = random.point();
            EXPECT_LE(field.edge_length(p, CellId{1}), 1.6 * fields[k](p));  // within a leaf of a jump it lies between
        }
    }
}

TEST(SizeField, TheSmallestOfAllCounts) {
    const ValidPlc plc = validate(cube());
    SizeGoals goals;
    goals.at = [](const Vec3& p) { return 0.2 + 0.1 * p.x; };
    goals.background = std::make_shared<const BackgroundMesh>(
        BackgroundMesh{{.vertices = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 0, 3}}, .tets = {{0, 1, 2, 3}}}, {0.3, 0.3, 0.0001, 0.3}});
    goals.edge_length = 0.28;
    goals.min_edge_length = 0.22;
    const SizeField field(plc, goals);
    RandomPoints random(4);
    for (int i = 0; i < 2000; ++i) {
        const Vec3 p = random.point();
        const double exact = std::max(0.22, std::min({0.2 + 0.1 * p.x, 0.28, 0.3 - (0.3 - 0.0001) * p.y / 3}));
        ASSERT_NEAR(field.edge_length(p, CellId{1}), exact, 0.06 * exact);
        ASSERT_GE(field.edge_length(p, CellId{1}), 0.22 * (1 - 1e-12));
    }
    EXPECT_NEAR(field.smallest(), 0.22, 1e-12);
}

TEST(SizeField, RegionsGradeIntoTheirNeighbours) {
    const ValidPlc plc = validate(cube_with_internal_facet());
    std::size_t fine = 0, coarse = 0, wall = 0;
    for (std::size_t c = 0; c < plc.cells.size(); ++c)
        if (plc.cells[c].filled) (plc.cells[c].region == 2 ? fine : coarse) = c;
    for (std::size_t f = 0; f < plc.facets.size(); ++f)
        if (plc.cells[plc.facets[f].cells[0].index()].filled && plc.cells[plc.facets[f].cells[1].index()].filled) wall = f;
    const auto from_wall = [&](const Vec3& p) { return std::abs(dot(p - plc.facets[wall].origin, plc.facets[wall].normal)); };
    SizeGoals goals;
    goals.entities = {{EntityKind::region, 2, 0.05}};
    const SizeField field(plc, goals);
    const Vec3 a = plc.cells[fine].inside, b = plc.cells[coarse].inside;
    EXPECT_EQ(field.edge_length(a, CellId{fine}), 0.05);
    EXPECT_NEAR(field.edge_length(b, CellId{coarse}), 0.05 + 0.3 * from_wall(b), 0.03);
    goals.gradation = 0;
    const SizeField steps(plc, goals);
    EXPECT_FALSE(steps.varies());
    EXPECT_EQ(steps.edge_length(a, CellId{fine}), 0.05);
    EXPECT_EQ(steps.edge_length(b, CellId{coarse}), kInfinity);
}

TEST(SizeField, WithoutGradationFacetsAndSegmentsKeepTheirSizesToThemselves) {
    Plc input = cube();
    input.facets[0].marker = 2;
    const ValidPlc plc = validate(input);
    SizeGoals goals;
    goals.gradation = 0;
    goals.entities = {{EntityKind::facet, 2, 0.1}};
    const SizeField field(plc, goals);
    EXPECT_FALSE(field.varies());
    ASSERT_TRUE(field.has_bare_entities());
    for (std::size_t f = 0; f < plc.facets.size(); ++f) EXPECT_EQ(field.of_facet(FacetId{f}), plc.facets[f].marker == 2 ? 0.1 : kInfinity);
    EXPECT_EQ(field.smallest(), 0.1);
}

TEST(SizeField, TheLocalFeatureSizeScales) {
    SizeGoals goals;
    goals.per_local_feature_size = 0.5;
    const ValidPlc plc = validate(cube());
    const SizeField field(plc, goals);
    // In the middle opposite facets are half a side away; at the middle of an edge the next features are its ends, no common point with each other.
    EXPECT_NEAR(field.edge_length({0.5, 0.5, 0.5}, CellId{1}), 0.25, 0.02);
    EXPECT_NEAR(field.edge_length({0.5, 0, 0}, CellId{1}), 0.25, 0.02);
    EXPECT_LT(steepest(field, 0.3, 8), 0.15);
}

TEST(SizeField, SizesAtAllVerticesMeanThoseBetweenThemToo) {
    Plc input = cube();
    for (const Vec3& p : input.vertices) input.vertex_sizes.push_back(0.1 + 0.2 * p.z);
    const ValidPlc plc = validate(input);
    const SizeField field(plc, {});
    RandomPoints random(6);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 p = random.point();
        ASSERT_NEAR(field.edge_length(p, CellId{1}), 0.1 + 0.2 * p.z, 1e-9);
    }
}

TEST(SizeField, IsTheSameAtEveryScaleAndPlace) {
    SizeGoals goals;
    goals.at = [](const Vec3& p) { return 0.05 + 0.2 * p.x * p.y; };
    const ValidPlc unit = validate(cube());
    const SizeField reference(unit, goals);
    for (const double scale : {1e-6, 1e6}) {
        const double shift = scale > 1 ? 1000 * scale : 0;
        const Vec3 origin{shift, -shift, shift};
        Plc input = cube();
        for (Vec3& p : input.vertices) p = origin + scale * p;
        SizeGoals scaled;
        scaled.at = [&](const Vec3& p) { return scale * goals.at((1 / scale) * (p - origin)); };
        const ValidPlc plc = validate(input);
        const SizeField field(plc, scaled);
        RandomPoints random(7);
        for (int i = 0; i < 500; ++i) {
            const Vec3 p = random.point();
            ASSERT_NEAR(field.edge_length(origin + scale * p, CellId{1}) / scale, reference.edge_length(p, CellId{1}), 1e-3);
        }
    }
}

TEST(SizeField, AnswersThatAreNoLengthAreErrorsAndExceptionsPass) {
    const ValidPlc plc = validate(cube());
    for (const double bad : {0.0, -1.0, std::nan("")}) {
        SizeGoals goals;
        goals.at = [bad](const Vec3&) { return bad; };
        EXPECT_THROW(SizeField(plc, goals), MeshError);
        goals.min_edge_length = 0.1;
        if (bad == 0) {
            EXPECT_NEAR(SizeField(plc, goals).edge_length({0.5, 0.5, 0.5}, CellId{1}), 0.1, 1e-12);
        } else {
            EXPECT_THROW(SizeField(plc, goals), MeshError);
        }
    }
    SizeGoals goals;
    goals.at = [](const Vec3&) -> double { throw 7; };
    EXPECT_THROW(SizeField(plc, goals), int);
}

}  // namespace
}  // namespace wellmesh::testing
