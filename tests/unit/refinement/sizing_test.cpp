// SPDX-License-Identifier: Apache-2.0
#include "sizing/size_field.hpp"

#include <gtest/gtest.h>

#include "pipeline/extract_mesh.hpp"
#include "refinement/lattice_seeding.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/certificate.hpp"

namespace wellmesh::testing {
namespace {

struct SizeCase {
    double edge_length;
    std::size_t least_tets, most_tets;
    bool seeded = false;
};

void PrintTo(const SizeCase& c, std::ostream* out) { *out << c.edge_length << (c.seeded ? " seeded" : ""); }

class EdgeLength : public ::testing::TestWithParam<SizeCase> {};

TEST_P(EdgeLength, IsTheMeanEdgeOfACubeWithinTenPercent) {
    MeshOptions options;
    options.size.edge_length = GetParam().edge_length;
    StagedMesh staged(cube(), options);
    staged.conform();
    Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
    if (GetParam().seeded) LatticeSeeder(staged.mesh, staged.boundary, staged.guard, refiner.sizes(), staged.workers).seed();
    ASSERT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
    EXPECT_EQ(staged.problem(true), "");
    Certificate measured;
    measure_shape(extract_mesh(staged.mesh), measured);
    EXPECT_NEAR(measured.all.mean_edge, GetParam().edge_length, 0.1 * GetParam().edge_length);
    EXPECT_GE(measured.all.tets, GetParam().least_tets);
    EXPECT_LE(measured.all.tets, GetParam().most_tets);
    const double bound = kCircumradiusPerEdgeLength * GetParam().edge_length;
    staged.for_domain([&](TetId t) { ASSERT_LE(staged.shape(t).circumradius, bound * (1 + 1e-9)); });
}

INSTANTIATE_TEST_SUITE_P(Sizes, EdgeLength, ::testing::Values(SizeCase{0.2, 700, 2500}, SizeCase{0.1, 6000, 16000}, SizeCase{0.052, 45000, 110000}, SizeCase{0.1, 4000, 12000, true},
                                                            SizeCase{0.052, 30000, 75000, true}, SizeCase{0.026, 200000, 600000, true}));

TEST(Sizing, MaxVolumeIsRespected) {
    for (const NamedPlc& named : all_synthetic_plcs())
        for (std::uint64_t rotation = 0; rotation < 3; ++rotation) {
            SCOPED_TRACE(named.name);
            MeshOptions options;
            const double d = diagonal(named.plc);
            options.size.max_volume = 1e-4 * d * d * d;
            StagedMesh staged(transformed(named.plc, rotation, 0, 1), options);
            staged.conform();
            Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
            ASSERT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
            EXPECT_EQ(staged.problem(true), "");
            double largest = 0;
            staged.for_domain([&](TetId t) { largest = std::max(largest, staged.shape(t).volume); });
            EXPECT_LE(largest, *options.size.max_volume * (1 + 1e-12));
            EXPECT_GT(largest, 0.3 * *options.size.max_volume);
        }
}

TEST(Sizing, MaxVolumeOfARegionRefinesThatRegion) {
    Plc plc = cube_with_internal_facet();
    plc.region_seeds[1].max_volume = 2e-4;
    for (const double scale : {1.0, 1e-6}) {
        StagedMesh staged(transformed(plc, 7, 0, scale));
        const double unit = scale * scale * scale;
        staged.conform();
        Refiner refiner(staged.mesh, staged.boundary, staged.guard, staged.options);
        ASSERT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
        std::map<std::int32_t, std::size_t> tets;
        std::map<std::int32_t, double> largest;
        staged.for_domain([&](TetId t) {
            const std::int32_t region = staged.plc.cells[staged.mesh.cell(t).index()].region;
            ++tets[region];
            largest[region] = std::max(largest[region], staged.shape(t).volume);
        });
        EXPECT_LE(largest.at(2), 2e-4 * unit * (1 + 1e-12));
        EXPECT_GT(largest.at(1), 4e-4 * unit);
        EXPECT_GT(tets.at(2), 2 * tets.at(1));
    }
}

TEST(Sizing, TheTightestBoundCounts) {
    Plc plc = cube_with_internal_facet();
    plc.region_seeds[1].max_volume = 0.5;
    const ValidPlc valid = validate(plc);
    SizeGoals goals;
    goals.max_volume = 0.75;
    goals.edge_length = 2;
    goals.gradation = 0;
    const SizeField sizes(valid, goals);
    EXPECT_FALSE(sizes.varies());
    for (std::size_t c = 1; c < valid.cells.size(); ++c) {
        EXPECT_EQ(sizes.of_cell(CellId{c}).max_volume, valid.cells[c].region == 2 ? 0.5 : 0.75);
        EXPECT_DOUBLE_EQ(sizes.of_cell(CellId{c}).max_squared_circumradius, 4 * kCircumradiusPerEdgeLength * kCircumradiusPerEdgeLength);
    }
    const ValidPlc plain = validate(cube());
    const SizeField nothing(plain, {});
    EXPECT_FALSE(nothing.asks());
    for (std::size_t c = 0; c < plain.cells.size(); ++c)
        EXPECT_TRUE(std::isinf(nothing.of_cell(CellId{c}).max_volume) && std::isinf(nothing.of_cell(CellId{c}).max_squared_circumradius));
}

}  // namespace
}  // namespace wellmesh::testing
