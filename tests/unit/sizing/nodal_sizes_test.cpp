// SPDX-License-Identifier: Apache-2.0
#include "sizing/nodal_sizes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/vec3_math.hpp"
#include "random_points.hpp"
#include "wellmesh/error.hpp"

namespace wellmesh::testing {
namespace {

double linear(const Vec3& p) { return 1 + p.x + 2 * p.y + 3 * p.z; }

TEST(NodalSizes, AreLinearBetweenPoints) {
    RandomPoints random(3);
    for (const double scale : {1.0, 1e-6, 1e6}) {
        std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
        while (points.size() < 200) points.push_back(random.point());
        std::vector<double> sizes;
        for (Vec3& p : points) {
            sizes.push_back(scale * linear(p));
            p = scale * p + Vec3{3 * scale, 0, 0};
        }
        const BackgroundMesh background = triangulate_sizes(points, sizes);
        const NodalSizes field(background);
        for (int i = 0; i < 500; ++i) {
            const Vec3 p = random.point();
            ASSERT_NEAR(field(scale * p + Vec3{3 * scale, 0, 0}), scale * linear(p), 1e-9 * scale);
        }
        EXPECT_TRUE(std::isinf(field({-scale, 0, 0})));
    }
}

TEST(NodalSizes, TetrahedraWithACornerThatAsksForNothingAskForNothing) {
    const BackgroundMesh background{{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}, .tets = {{0, 1, 2, 3}, {1, 2, 3, 4}}}, {1, 1, 1, 1, 0}};
    const NodalSizes field(background);
    EXPECT_DOUBLE_EQ(field({0.1, 0.1, 0.1}), 1);
    EXPECT_TRUE(std::isinf(field({0.6, 0.6, 0.6})));
}

TEST(NodalSizes, PointsInOnePlaneHaveNoTetrahedra) {
    const BackgroundMesh flat = triangulate_sizes({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {1, 1, 1, 1});
    EXPECT_TRUE(flat.mesh.tets.empty());
    EXPECT_TRUE(std::isinf(NodalSizes(flat)({0.5, 0.5, 0})));
}

TEST(NodalSizes, ArraysThatDoNotFitAreRefused) {
    const TetMesh mesh{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .tets = {{0, 1, 2, 3}}};
    TetMesh wrong = mesh;
    wrong.tets[0][3] = 4;
    for (const BackgroundMesh& bad : {BackgroundMesh{mesh, {1, 1, 1}}, BackgroundMesh{mesh, {1, 1, 1, -1}}, BackgroundMesh{mesh, {1, 1, 1, std::nan("")}}, BackgroundMesh{wrong, {1, 1, 1, 1}}})
        EXPECT_THROW(NodalSizes field(bad), MeshError);
}

}  // namespace
}  // namespace wellmesh::testing
