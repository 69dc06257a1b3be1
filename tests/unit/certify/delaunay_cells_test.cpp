// SPDX-License-Identifier: Apache-2.0
#include "certify/delaunay_cells.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/rng.hpp"
#include "wellmesh/certificate.hpp"
#include "wellmesh/delaunay.hpp"

namespace wellmesh::certifying {
namespace {

bool disjoint(const TetMesh& mesh) {
    const SuspectMesh suspect(mesh);
    return disjoint_as_delaunay(suspect, BallSearch(suspect.points(), mesh.weights));
}

std::vector<Vec3> cube_corners() {
    std::vector<Vec3> points;
    for (unsigned i = 0; i < 8; ++i) points.push_back({i & 1U ? 1.0 : 0.0, i & 2U ? 1.0 : 0.0, i & 4U ? 1.0 : 0.0});
    return points;
}

TEST(DelaunayCells, ProveTriangulationsOfPoints) {
    std::vector<Vec3> points;
    for (std::uint64_t i = 0; i < 600; i += 3) points.push_back({unit_double(mix64(i)), unit_double(mix64(i + 1)), unit_double(mix64(i + 2))});
    EXPECT_TRUE(disjoint(triangulate_points(points).mesh));
    points.clear();
    for (int i = 0; i < 125; ++i) points.push_back({static_cast<double>(i % 5), static_cast<double>(i / 5 % 5), static_cast<double>(i / 25)});
    EXPECT_TRUE(disjoint(triangulate_points(points).mesh));  // eight vertices on each sphere
}

TEST(DelaunayCells, FindOverlapsOnOneSphere) {
    TetMesh mesh;
    mesh.vertices = cube_corners();
    mesh.tets = {{0, 1, 2, 4}};
    EXPECT_TRUE(disjoint(mesh));
    mesh.tets.push_back({7, 5, 3, 6});  // the opposite corner of the cube: reflected, and positive only with two corners exchanged
    EXPECT_FALSE(disjoint(mesh));
    mesh.tets[1] = {7, 3, 5, 6};
    EXPECT_TRUE(disjoint(mesh));
    mesh.tets[1] = {1, 2, 4, 7};
    ASSERT_EQ(orient3d(mesh.vertices[1], mesh.vertices[2], mesh.vertices[4], mesh.vertices[7]), Sign::positive);
    EXPECT_TRUE(disjoint(mesh));  // on the other side of the first one's face
    mesh.tets.push_back({7, 3, 5, 6});
    EXPECT_FALSE(disjoint(mesh));  // both hold what is near vertex 7
    mesh.tets.pop_back();
    mesh.tets.push_back({0, 1, 2, 7});
    ASSERT_EQ(orient3d(mesh.vertices[0], mesh.vertices[1], mesh.vertices[2], mesh.vertices[7]), Sign::positive);
    EXPECT_FALSE(disjoint(mesh));  // through both of them
}

TEST(DelaunayCells, DemandEmptySpheres) {
    TetMesh mesh;
    mesh.vertices = cube_corners();
    mesh.vertices.push_back({0.6, 0.6, 0.6});
    mesh.tets = {{0, 1, 2, 4}};
    EXPECT_FALSE(disjoint(mesh));
}

/// Vertices in a row along an edge make as many needles, whose boxes all meet. The spacing is far below the square root of a rounding: spheres are tangent to the row as far as doubles can tell.
TEST(DelaunayCells, ARowOfNeedlesIsCertified) {
    std::vector<Vec3> points = cube_corners();
    constexpr int kRow = 500;
    for (int i = 1; i <= kRow; ++i) points.push_back({0, 0, i * 0x1p-30});
    const TetMesh mesh = triangulate_points(points).mesh;
    const Certificate certificate = certify(mesh);
    EXPECT_EQ(certificate.find("disjoint_tets")->state, Claim::State::proven);
    EXPECT_EQ(certificate.find("delaunay")->state, Claim::State::proven);
}

}  // namespace
}  // namespace wellmesh::certifying
