// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

#include "conforming/facet_delaunay.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"

namespace wellmesh::testing {
namespace {

/// A box n x n x n whose top is a full lattice of vertices: every four neighbours are cocircular.
Plc box_with_lattice(unsigned n) {
    Plc plc;
    const unsigned m = n + 1;
    for (unsigned j = 0; j < m; ++j)
        for (unsigned i = 0; i < m; ++i) plc.vertices.push_back({static_cast<double>(i), static_cast<double>(j), static_cast<double>(n)});
    const std::uint32_t base = m * m;
    for (const auto& xy : {std::array{0U, 0U}, std::array{n, 0U}, std::array{n, n}, std::array{0U, n}})
        plc.vertices.push_back({static_cast<double>(xy[0]), static_cast<double>(xy[1]), 0});
    std::vector<std::vector<std::uint32_t>> sides(4);
    for (unsigned i = 0; i < n; ++i) {
        sides[0].push_back(i);
        sides[1].push_back(n + m * i);
        sides[2].push_back(n + m * n - i);
        sides[3].push_back(m * (n - i));
    }
    PlcFacet top, bottom;
    top.polygons.emplace_back();
    for (const auto& s : sides) top.polygons[0].insert(top.polygons[0].end(), s.begin(), s.end());
    for (unsigned j = 1; j < n; ++j)
        for (unsigned i = 1; i < n; ++i) top.polygons.push_back({i + m * j});
    bottom.polygons = {{base, base + 3, base + 2, base + 1}};
    plc.facets = {top, bottom};
    for (std::uint32_t k = 0; k < 4; ++k) {
        PlcFacet side;
        side.polygons = {sides[k]};
        side.polygons[0].push_back(sides[(k + 1) % 4][0]);
        side.polygons[0].push_back(base + (k + 1) % 4);
        side.polygons[0].push_back(base + k);
        plc.facets.push_back(side);
    }
    return plc;
}

FacetId facet_with_most_vertices(const ValidPlc& plc) {
    std::size_t best = 0;
    for (std::size_t f = 1; f < plc.facets.size(); ++f)
        if (plc.facets[f].vertices.size() > plc.facets[best].vertices.size()) best = f;
    return FacetId{best};
}

double area_of(const ConformingMesh& mesh, const std::vector<TetFace>& faces) {
    double area = 0;
    for (const TetFace tf : faces) {
        const auto c = mesh.tets().face_corners(tf);
        area += norm(cross(mesh.point(c[1]) - mesh.point(c[0]), mesh.point(c[2]) - mesh.point(c[0]))) / 2;
    }
    return area;
}

TEST(FacetDelaunay, LatticeInACoordinatePlaneNeedsNoPoint) {
    for (const unsigned n : {2U, 3U, 5U, 8U}) {
        SCOPED_TRACE(n);
        StagedMesh staged(box_with_lattice(n));
        const FacetId top = facet_with_most_vertices(staged.plc);
        ASSERT_EQ(staged.plc.facets[top.index()].vertices.size(), (n + 1) * (n + 1));
        FacetDelaunay flat(staged.mesh, top);
        EXPECT_TRUE(flat.match_faces(staged.mesh).empty());
        EXPECT_EQ(flat.faces().size(), 2 * n * n);
        EXPECT_DOUBLE_EQ(area_of(staged.mesh, flat.faces()), n * n);
    }
}

TEST(FacetDelaunay, RotatedLatticesAreCoveredBySomeDiagonals) {
    for (std::uint64_t rotation = 1; rotation <= 12; ++rotation) {
        SCOPED_TRACE(rotation);
        StagedMesh staged(transformed(box_with_lattice(6), rotation, rotation % 3 == 0 ? 1e3 : 0, 1));
        staged.boundary.recover_all();
        ASSERT_EQ(staged.problem(false), "");
        const FacetId top = facet_with_most_vertices(staged.plc);
        FacetDelaunay flat(staged.mesh, top);
        EXPECT_TRUE(flat.match_faces(staged.mesh).empty());
        EXPECT_NEAR(area_of(staged.mesh, flat.faces()), 36, 1e-6);
        EXPECT_TRUE(staged.mesh.steiner_vertices_of(top).empty());
        staged.boundary.conform();
        EXPECT_EQ(staged.problem(true), "");
    }
}

TEST(FacetDelaunay, AgreesWithTheLabelsOfEveryRecoveredFacet) {
    for (const NamedPlc& named : all_synthetic_plcs())
        for (std::uint64_t rotation = 0; rotation < 4; ++rotation) {
            SCOPED_TRACE(named.name);
            StagedMesh staged(transformed(named.plc, rotation, 0, 1));
            staged.conform();
            for (std::size_t f = 0; f < staged.plc.facets.size(); ++f) {
                FacetDelaunay flat(staged.mesh, FacetId{f});
                ASSERT_TRUE(flat.match_faces(staged.mesh).empty());
                double labelled = 0;
                for (std::size_t i = 0; i < staged.mesh.tets().slots(); ++i)
                    for (unsigned k = 0; k < 4; ++k) {
                        const TetFace tf{TetId{i}, k};
                        if (staged.mesh.tets().is_live(TetId{i}) && staged.mesh.facet_at(tf) == FacetId{f}) labelled += area_of(staged.mesh, {tf}) / 2;
                    }
                EXPECT_NEAR(area_of(staged.mesh, flat.faces()), labelled, 1e-9 * labelled);
            }
        }
}

TEST(FacetDelaunay, NamesTrianglesThatTheMeshLacks) {
    // A vertex close above the middle of a large facet: the Delaunay edge to a vertex close below runs through the facet.
    Plc plc = cube(4);
    plc.vertices.push_back({1, 1, 2});
    plc.vertices.push_back({3, 1, 2});
    plc.vertices.push_back({3, 3, 2});
    plc.vertices.push_back({1, 3, 2});
    PlcFacet square;
    square.polygons = {{8, 9, 10, 11}};
    plc.facets.push_back(square);
    plc.vertices.push_back({2.1, 1.9, 2.2});
    plc.vertices.push_back({1.9, 2.1, 1.8});
    StagedMesh staged(plc);
    const FacetId inner{6};
    ASSERT_EQ(staged.plc.facets[6].vertices.size(), 4U);
    FacetDelaunay flat(staged.mesh, inner);
    EXPECT_FALSE(flat.match_faces(staged.mesh).empty());
    staged.conform();
    EXPECT_EQ(staged.problem(true), "");
    EXPECT_FALSE(staged.mesh.steiner_vertices_of(inner).empty());
}

}  // namespace
}  // namespace wellmesh::testing
