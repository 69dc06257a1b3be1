// SPDX-License-Identifier: Apache-2.0
#include "wellmesh/generate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <thread>

#include <fmt/format.h>

#include "core/vec3_math.hpp"
#include "support/expect_result.hpp"
#include "support/synthetic_plcs.hpp"

namespace wellmesh::testing {
namespace {

bool same(const TetMesh& a, const TetMesh& b) {
    return a.vertices == b.vertices && a.tets == b.tets && a.tet_regions == b.tet_regions && a.subfaces == b.subfaces && a.subface_facets == b.subface_facets &&
           a.subsegments == b.subsegments && a.subsegment_segments == b.subsegment_segments;
}

class Generate : public ::testing::TestWithParam<std::tuple<std::size_t, std::uint64_t>> {};

TEST_P(Generate, GoalsAreMetWhereverTheDomainIs) {
    const auto [domain, rotation] = GetParam();
    const NamedPlc named = all_synthetic_plcs()[domain];
    for (const double shift : {0.0, 1e3, 1e6})
        for (const double scale : {1.0, 1e-6, 1e6}) {
            if (shift != 0 && scale != 1 && rotation == 0) continue;
            SCOPED_TRACE(fmt::format("{} rotation {} shift {} scale {}", named.name, rotation, shift, scale));
            const Plc plc = transformed(named.plc, rotation, shift, scale);
            MeshOptions options;
            options.seed = rotation + static_cast<std::uint64_t>(shift);
            const MeshResult result = generate(plc, options);
            expect_goals_met(result);
            EXPECT_GE(result.certificate.all.min_dihedral_angle_deg, 20);
            EXPECT_LE(result.certificate.all.max_radius_edge_ratio, 2);
        }
}

INSTANTIATE_TEST_SUITE_P(All, Generate, ::testing::Combine(::testing::Range<std::size_t>(0, 5), ::testing::Values(0U, 1U)));

TEST(GenerateOnce, SeedsAndSizes) {
    for (const NamedPlc& named : all_synthetic_plcs())
        for (std::uint64_t seed = 1; seed <= 5; ++seed) {
            SCOPED_TRACE(fmt::format("{} seed {}", named.name, seed));
            MeshOptions options;
            options.seed = seed;
            options.size.edge_length = 0.09 * diagonal(named.plc);
            const MeshResult result = generate(transformed(named.plc, seed - 1, 0, 1), options);
            expect_goals_met(result);
            EXPECT_EQ(result.goals.size(), 3U);
            EXPECT_NEAR(result.certificate.all.mean_edge, *options.size.edge_length, 0.2 * *options.size.edge_length);
        }
}

TEST(GenerateOnce, NumberingKeepsTheInputFirstAndNeighboursClose) {
    const Plc plc = l_block();
    MeshOptions options;
    options.size.edge_length = 0.05 * diagonal(plc);
    const TetMesh mesh = generate(plc, options).mesh;
    for (std::size_t v = 0; v < plc.vertices.size(); ++v) EXPECT_EQ(mesh.vertices[v], plc.vertices[v]);
    double tour = 0;
    for (std::size_t v = plc.vertices.size() + 1; v < mesh.vertices.size(); ++v) tour += distance(mesh.vertices[v - 1], mesh.vertices[v]);
    // Along a Hilbert curve a step is about as long as an edge; in the order of insertion it is a good part of the diagonal.
    EXPECT_LT(tour / static_cast<double>(mesh.vertices.size()), 3 * *options.size.edge_length);
    const auto lowest = [](const auto& tet) { return *std::min_element(tet.begin(), tet.end()); };
    EXPECT_TRUE(std::is_sorted(mesh.tets.begin(), mesh.tets.end(), [&](const auto& a, const auto& b) { return lowest(a) < lowest(b); }));
}

TEST(GenerateOnce, RegionsKeepTheirVolumesAndBounds) {
    Plc plc = cube_with_internal_facet();
    plc.region_seeds[0].max_volume = 1e-3;
    const MeshResult result = generate(transformed(plc, 2, 0, 10));
    expect_goals_met(result);
    ASSERT_EQ(result.certificate.regions.size(), 2U);
    for (const RegionVolume& r : result.certificate.regions) {
        EXPECT_NEAR(r.volume, 1000, 1e-6);
        ASSERT_TRUE(r.plc_volume.has_value());
        EXPECT_NEAR(*r.plc_volume, 1000, 1e-6);
    }
    for (std::size_t t = 0; t < result.mesh.tets.size(); ++t) {
        const auto& c = result.mesh.tets[t];
        const Vec3& a = result.mesh.vertices[c[0]];
        const double volume = determinant(result.mesh.vertices[c[1]] - a, result.mesh.vertices[c[2]] - a, result.mesh.vertices[c[3]] - a) / 6;
        if (result.mesh.tet_regions[t] == 1) { EXPECT_LE(volume, 1 + 1e-9); }
    }
}

TEST(GenerateOnce, NeighboursOfFiftyfoldSizeGradeIntoEachOther) {
    // The fine cell's boundary gives the coarse one edges far below its own bound: the guard against short edges must let it grade from there.
    Plc plc = cube();
    const Plc inner = transformed(cube(0.1), 0, 0, 1);
    const auto first = static_cast<std::uint32_t>(plc.vertices.size());
    for (const Vec3& v : inner.vertices) plc.vertices.push_back(v + Vec3{0.45, 0.45, 0.45});
    for (PlcFacet facet : inner.facets) {
        for (auto& polygon : facet.polygons)
            for (auto& v : polygon) v += first;
        plc.facets.push_back(facet);
    }
    plc.region_seeds = {{{0.5, 0.5, 0.5}, 1, 1.2e-7}, {{0.01, 0.02, 0.03}, 2, 1.5e-2}};
    for (const auto seeding : {Seeding::automatic, Seeding::off}) {
        MeshOptions options;
        options.seeding = seeding;
        const MeshResult result = generate(transformed(plc, 5, 0, 1), options);
        expect_goals_met(result);
    }
}

TEST(GenerateOnce, SliversAreIgnoredWhenAskedSo) {
    MeshOptions options;
    options.quality.min_dihedral_angle_deg = 0;
    options.size.edge_length = 0.15;
    const MeshResult result = generate(transformed(cube(), 3, 0, 1), options);
    expect_goals_met(result);
    EXPECT_LT(result.certificate.all.min_dihedral_angle_deg, 15);
    EXPECT_EQ(result.goals.size(), 2U);
    EXPECT_EQ(result.statistics.moved_vertices, 0U);
}

TEST(GenerateOnce, SameSeedSameBytesAlsoInThreads) {
    const Plc plc = transformed(stepped_shaft(), 4, 0, 1);
    MeshOptions options;
    options.seed = 11;
    options.size.edge_length = 0.4;
    const MeshResult first = generate(plc, options);
    std::array<MeshResult, 2> others;
    {
        std::jthread a([&] { others[0] = generate(plc, options); });
        std::jthread b([&] { others[1] = generate(plc, options); });
    }
    for (const MeshResult& other : others) EXPECT_TRUE(same(first.mesh, other.mesh));
    options.seed = 12;
    EXPECT_FALSE(same(first.mesh, generate(plc, options).mesh));
}

TEST(GenerateOnce, PowersOfTwoScaleTheMeshExactly) {
    for (const NamedPlc& named : all_synthetic_plcs()) {
        SCOPED_TRACE(named.name);
        MeshOptions options;
        options.size.edge_length = 0.125 * diagonal(named.plc);
        const Plc plc = transformed(named.plc, 9, 0, 1);
        const MeshResult reference = generate(plc, options);
        for (const int power : {-7, 12}) {
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

TEST(GenerateOnce, ReportsWhatItDid) {
    MeshOptions options;
    options.size.edge_length = 0.2;
    const MeshResult result = generate(transformed(cube_with_internal_facet(), 4, 0, 1), options);
    const MeshStatistics& s = result.statistics;
    EXPECT_EQ(s.input_vertices, 12U);
    EXPECT_GT(s.segment_vertices, 0U);
    EXPECT_GT(s.facet_vertices, 0U);
    EXPECT_GT(s.interior_vertices, 0U);
    EXPECT_EQ(s.input_vertices + s.segment_vertices + s.facet_vertices + s.interior_vertices, result.mesh.vertices.size());
    std::set<Stage> stages;
    for (const StageTime& t : s.stages) {
        EXPECT_GE(t.seconds, 0);
        stages.insert(t.stage);
    }
    EXPECT_EQ(stages, (std::set<Stage>{Stage::validate, Stage::delaunay, Stage::conform, Stage::refine, Stage::shape, Stage::extract, Stage::certify}));
    // Carriers are those of the input.
    const Plc plc = transformed(cube_with_internal_facet(), 4, 0, 1);
    for (std::size_t v = 0; v < result.mesh.vertices.size(); ++v)
        if (result.mesh.vertex_carriers[v].kind == CarrierKind::input_vertex) { EXPECT_EQ(result.mesh.vertices[v], plc.vertices[result.mesh.vertex_carriers[v].id]); }
}

TEST(GenerateOnce, UnreachableAnglesAreListed) {
    MeshOptions options;
    options.quality.min_dihedral_angle_deg = 60;
    options.size.edge_length = 1;
    const MeshResult result = generate(cube(), options);
    EXPECT_EQ(result.termination, Termination::goals_unmet);
    expect_valid(result);
    bool listed = false;
    for (const AskedAchieved& g : result.goals)
        if (!g.met) {
            listed = true;
            EXPECT_GT(g.elements_missed, 0U);
            EXPECT_FALSE(g.worst.empty());
            EXPECT_LT(g.achieved, g.asked);
        }
    EXPECT_TRUE(listed);
}

}  // namespace
}  // namespace wellmesh::testing
