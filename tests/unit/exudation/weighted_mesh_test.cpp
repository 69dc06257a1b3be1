// SPDX-License-Identifier: Apache-2.0
#include "exudation/weighted_mesh.hpp"

#include "support/synthetic_plcs.hpp"
#include "weighted_checks.hpp"

namespace wellmesh::testing {
namespace {

std::vector<std::array<std::uint32_t, 4>> sorted_tets(const TetMesh& mesh) {
    auto tets = mesh.tets;
    for (auto& t : tets) std::sort(t.begin(), t.end());
    std::sort(tets.begin(), tets.end());
    return tets;
}

TEST(WeightedMesh, NeighboursAndConstraintsAreThoseOfTheMesh) {
    const TetMesh mesh = almost_good_mesh(cube_with_internal_facet(), 0.4);
    const WeightedMesh weighted_mesh(mesh);
    const TetStore& tets = weighted_mesh.tets();
    std::size_t constrained = 0, hull = 0;
    for (std::size_t i = 0; i < tets.slots(); ++i)
        for (unsigned f = 0; f < 4; ++f) {
            const TetFace face{TetId{i}, f}, other = tets.across(face);
            constrained += weighted_mesh.is_constrained(face);
            if (!other.valid()) {
                ++hull;
                EXPECT_TRUE(weighted_mesh.is_constrained(face));
                continue;
            }
            ASSERT_EQ(tets.across(other), face);
            EXPECT_EQ(weighted_mesh.is_constrained(face), weighted_mesh.is_constrained(other));
            auto a = tets.face_corners(face), b = tets.face_corners(other);
            std::sort(a.begin(), a.end());
            std::sort(b.begin(), b.end());
            ASSERT_EQ(a, b);
        }
    EXPECT_EQ(weighted_mesh.constraint_faces().size(), mesh.subfaces.size());
    EXPECT_GT(hull, 0U);
    EXPECT_EQ(constrained, 2 * mesh.subfaces.size() - hull);
    for (const auto& [a, b] : mesh.subsegments) EXPECT_TRUE(weighted_mesh.is_subsegment(VertexId{b}, VertexId{a}));
    TetMesh out = mesh;
    weighted_mesh.write_to(out);
    EXPECT_EQ(out.tets, mesh.tets);
    EXPECT_EQ(out.tet_regions, mesh.tet_regions);
    EXPECT_TRUE(out.weights.empty());
}

/// Replacing a star by itself changes nothing but the weight, also on the boundary and between two regions.
TEST(WeightedMesh, StarReplacedByItselfIsTheSameMesh) {
    const TetMesh mesh = almost_good_mesh(cube_with_internal_facet(), 0.5);
    WeightedMesh changed(mesh);
    std::vector<TetId> star, created;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        ASSERT_TRUE(changed.find_star(VertexId{v}, star));
        std::vector<BoundaryFace> link;
        for (const TetId t : star) {
            const TetFace f{t, changed.tets().find_corner(t, VertexId{v})};
            link.push_back({f, changed.tets().across(f)});
        }
        changed.replace_star(VertexId{v}, 1, star, link, created);
        EXPECT_EQ(created.size(), star.size());
    }
    TetMesh out = mesh;
    changed.write_to(out);
    EXPECT_EQ(sorted_tets(out), sorted_tets(mesh));
    EXPECT_EQ(out.weights, std::vector<double>(mesh.vertices.size(), 1));
    out.weights.clear();
    const WeightedMesh again(out);
    EXPECT_EQ(again.constraint_faces().size(), mesh.subfaces.size());
    std::size_t constrained = 0;
    for (std::size_t i = 0; i < changed.tets().slots(); ++i)
        for (unsigned f = 0; f < 4; ++f) constrained += changed.tets().is_live(TetId{i}) && changed.is_constrained(TetFace{TetId{i}, f});
    std::size_t expected = 0;
    for (std::size_t i = 0; i < again.tets().slots(); ++i)
        for (unsigned f = 0; f < 4; ++f) expected += again.is_constrained(TetFace{TetId{i}, f});
    EXPECT_EQ(constrained, expected);
}

TEST(WeightedMesh, StarsThatTouchInAVertexOnlyAreNotBalls) {
    TetMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    mesh.tets = {{0, 1, 2, 3}, {0, 5, 4, 6}};
    mesh.tet_regions = {1, 1};
    const WeightedMesh weighted_mesh(mesh);
    std::vector<TetId> star;
    EXPECT_FALSE(weighted_mesh.find_star(VertexId{0}, star));
    EXPECT_TRUE(weighted_mesh.find_star(VertexId{1}, star));
}

}  // namespace
}  // namespace wellmesh::testing
