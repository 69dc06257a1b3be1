// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/vec3_math.hpp"
#include "support/expect_result.hpp"
#include "support/synthetic_plcs.hpp"
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

}  // namespace
}  // namespace wellmesh::testing
