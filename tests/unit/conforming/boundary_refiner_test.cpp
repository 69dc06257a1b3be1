// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/error.hpp"

namespace wellmesh::testing {
namespace {

void expect_volumes(const StagedMesh& staged) {
    // A rounded Steiner point moves a wall by about an ulp of the largest coordinate.
    Vec3 lo, hi;
    bounding_box(staged.plc.vertices, lo, hi);
    const double tolerance = 1e-12 + 100 * std::numeric_limits<double>::epsilon() * staged.largest_coordinate() / distance(lo, hi);
    const auto volumes = staged.cell_volumes();
    for (std::size_t c = 1; c < staged.plc.cells.size(); ++c) {
        const ValidCell& cell = staged.plc.cells[c];
        const auto it = volumes.find(CellId{c});
        EXPECT_EQ(it != volumes.end(), cell.filled);
        if (it != volumes.end()) { EXPECT_NEAR(it->second, cell.volume, tolerance * cell.volume); }
    }
}

class Conform : public ::testing::TestWithParam<std::tuple<std::size_t, std::uint64_t>> {};

TEST_P(Conform, SyntheticDomainsBecomeGabrielWhereverTheyAre) {
    const auto [domain, rotation] = GetParam();
    const NamedPlc named = all_synthetic_plcs()[domain];
    for (const double shift : {0.0, 1e3, 1e6})
        for (const double scale : {1.0, 1e-6, 1e6}) {
            SCOPED_TRACE(fmt::format("{} rotation {} shift {} scale {}", named.name, rotation, shift, scale));
            StagedMesh staged(transformed(named.plc, rotation, shift, scale));
            staged.boundary.recover_all();
            ASSERT_EQ(staged.problem(false), "");
            staged.boundary.conform();
            ASSERT_TRUE(staged.boundary.idle());
            ASSERT_EQ(staged.problem(true), "");
            expect_volumes(staged);
            EXPECT_LT(staged.mesh.vertex_count(), 1500U);
        }
}

INSTANTIATE_TEST_SUITE_P(All, Conform, ::testing::Combine(::testing::Range<std::size_t>(0, 5), ::testing::Values(0U, 1U, 2U)));

TEST(BoundaryRefiner, RandomPolycubesConform) {
    std::size_t several_cells = 0, holes = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        SCOPED_TRACE(seed);
        const RandomPolycube random = random_polycube(seed);
        StagedMesh staged(transformed(random.plc, seed % 3 == 0 ? 0 : seed, seed % 4 == 1 ? 1e3 : 0, 1));
        staged.conform();
        ASSERT_EQ(staged.problem(true), "");
        expect_volumes(staged);
        several_cells += staged.plc.cells.size() > 2;
        holes += std::any_of(random.plc.facets.begin(), random.plc.facets.end(), [](const PlcFacet& f) { return !f.holes.empty(); });
    }
    EXPECT_GT(several_cells, 20U);
    EXPECT_GT(holes, 3U);
}

/// A cube with a square that hangs inside, a wire, and a vertex of its own.
Plc cube_with_dangling_parts() {
    Plc plc = cube(4);
    const auto add = [&](double x, double y, double z) {
        plc.vertices.push_back({x, y, z});
        return static_cast<std::uint32_t>(plc.vertices.size() - 1);
    };
    PlcFacet square;
    square.polygons = {{add(1, 1, 1), add(3, 1, 1), add(3, 3, 1), add(1, 3, 1)}};
    plc.facets.push_back(square);
    plc.segments.push_back({{add(1, 1, 2.5), add(3, 2.75, 3)}, 0});
    plc.facets[0].polygons.push_back({add(0, 2, 2)});
    return plc;
}

TEST(BoundaryRefiner, DanglingPartsAreRecovered) {
    for (std::uint64_t rotation = 0; rotation < 4; ++rotation) {
        SCOPED_TRACE(rotation);
        StagedMesh staged(transformed(cube_with_dangling_parts(), rotation, 0, 1));
        ASSERT_EQ(staged.plc.facets.size(), 7U);
        ASSERT_EQ(staged.plc.segments.size(), 17U);
        staged.conform();
        EXPECT_EQ(staged.problem(true), "");
        expect_volumes(staged);
    }
}

TEST(BoundaryRefiner, CheckConformingSeesWhatIsMissing) {
    StagedMesh staged(cube());
    EXPECT_NE(staged.problem(false), "");  // nothing is labelled yet
    staged.conform();
    ASSERT_EQ(staged.problem(true), "");
    const FacetId facet{0};
    for (std::size_t i = 0; i < staged.mesh.tets().slots(); ++i)
        for (unsigned f = 0; f < 4; ++f)
            if (staged.mesh.tets().is_live(TetId{i}) && staged.mesh.facet_at(TetFace{TetId{i}, f}) == facet) {
                staged.mesh.label_face(TetFace{TetId{i}, f}, FacetId{});
                EXPECT_NE(staged.problem(false), "");
                staged.mesh.label_face(TetFace{TetId{i}, f}, facet);
                EXPECT_EQ(staged.problem(false), "");
                return;
            }
    FAIL() << "no subface of facet 0";
}

TEST(BoundaryRefiner, CellsOfAWrongTetrahedronAreSeen) {
    StagedMesh staged(cube_with_internal_facet());
    staged.conform();
    TetId some{};
    staged.for_domain([&](TetId t) { some = t; });
    staged.mesh.set_cell(some, CellId{0});
    EXPECT_NE(staged.problem(true), "");
    classify_cells(staged.mesh);
    EXPECT_EQ(staged.problem(true), "");
}

TEST(BoundaryRefiner, BudgetAndCancellationAreErrors) {
    MeshOptions few;
    few.limits.max_vertices = 18;
    StagedMesh staged(cube_with_cavity(), few);
    try {
        staged.conform();
        FAIL() << "18 vertices were enough";
    } catch (const MeshError& e) {
        EXPECT_EQ(e.code(), ErrorCode::budget_exhausted);
    }
    StagedMesh cancelled(cube_with_cavity());
    std::stop_source stop;
    stop.request_stop();
    cancelled.control.stop = stop.get_token();
    try {
        cancelled.conform();
        FAIL() << "not cancelled";
    } catch (const MeshError& e) {
        EXPECT_EQ(e.code(), ErrorCode::cancelled);
    }
}

}  // namespace
}  // namespace wellmesh::testing
