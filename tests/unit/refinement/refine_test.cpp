// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/rng.hpp"
#include "pipeline/extract_mesh.hpp"
#include "quality/shape_lanes.hpp"
#include "support/acute_plcs.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"

namespace wellmesh::testing {
namespace {

bool same(const TetMesh& a, const TetMesh& b) {
    const auto carrier_equal = [](const VertexCarrier& x, const VertexCarrier& y) { return x.kind == y.kind && x.id == y.id; };
    return a.vertices == b.vertices && a.tets == b.tets && a.tet_regions == b.tet_regions && a.subfaces == b.subfaces && a.subface_facets == b.subface_facets &&
           a.subface_markers == b.subface_markers && a.subsegments == b.subsegments && a.subsegment_segments == b.subsegment_segments &&
           std::equal(a.vertex_carriers.begin(), a.vertex_carriers.end(), b.vertex_carriers.begin(), b.vertex_carriers.end(), carrier_equal);
}

class RadiusEdge : public ::testing::TestWithParam<std::tuple<std::size_t, std::uint64_t>> {};

TEST_P(RadiusEdge, BoundIsMetOnEveryDomain) {
    const auto [domain, rotation] = GetParam();
    const NamedPlc named = all_synthetic_plcs()[domain];
    for (const double shift : {0.0, 1e3, 1e6})
        for (const double scale : {1.0, 1e-6, 1e6})
            for (const double bound : {2.0, 1.4}) {
                SCOPED_TRACE(fmt::format("{} rotation {} shift {} scale {} bound {}", named.name, rotation, shift, scale, bound));
                MeshOptions options;
                options.quality.max_radius_edge_ratio = bound;
                StagedMesh staged(transformed(named.plc, rotation, shift, scale), options);
                staged.conform();
                Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
                ASSERT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
                double worst = 0;
                staged.for_domain([&](TetId t) { worst = std::max(worst, staged.shape(t).radius_edge); });
                EXPECT_LE(worst, bound * (1 + 1e-12));
                EXPECT_EQ(staged.problem(true), "");
                EXPECT_LT(staged.mesh.vertex_count(), 3000U);
            }
}

INSTANTIATE_TEST_SUITE_P(All, RadiusEdge, ::testing::Combine(::testing::Range<std::size_t>(0, 5), ::testing::Values(0U, 2U, 3U)));

/// Reason, parent and e_v of every vertex against the vertices before it. Nothing has been removed or moved, so ids count insertions.
void expect_sane_records(const StagedMesh& staged) {
    const ConformingMesh& mesh = staged.mesh;
    for (std::size_t i = 0; i < mesh.vertex_slots(); ++i) {
        const VertexId v{i};
        const VertexInfo& info = mesh.info(v);
        ASSERT_TRUE(mesh.triangulation().is_inserted(v));
        if (i < staged.plc.vertices.size()) {
            EXPECT_EQ(info.reason, InsertionReason::input);
            EXPECT_EQ(info.carrier, CarrierKind::input_vertex);
            EXPECT_EQ(info.carrier_id, i);
            continue;
        }
        EXPECT_NE(info.reason, InsertionReason::input);
        EXPECT_NE(info.carrier, CarrierKind::input_vertex);
        const bool on_boundary = info.carrier != CarrierKind::region;
        const bool by_quality = info.reason == InsertionReason::size || info.reason == InsertionReason::radius_edge || info.reason == InsertionReason::sliver;
        EXPECT_NE(on_boundary, by_quality);
        if (info.parent.valid()) { EXPECT_LT(info.parent.value(), i); }
        else { EXPECT_EQ(info.reason, InsertionReason::recovery); }
        // The nearest vertex is a Delaunay neighbour, so e_v is the distance to the vertices before.
        double shortest = 1e300;
        for (std::size_t j = 0; j < i; ++j) shortest = std::min(shortest, squared_distance(mesh.point(v), mesh.point(VertexId{j})));
        EXPECT_EQ(info.insertion_length, std::sqrt(shortest)) << i;
    }
}

TEST(Refine, EveryVertexKnowsWhyAndThroughWhomItCame) {
    for (const NamedPlc& named : all_synthetic_plcs())
        for (std::uint64_t rotation = 0; rotation < 2; ++rotation) {
            SCOPED_TRACE(named.name);
            MeshOptions options;
            options.size.edge_length = 0.12 * diagonal(named.plc);
            StagedMesh staged(transformed(named.plc, rotation, 0, 1), options);
            staged.conform();
            Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
            ASSERT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
            expect_sane_records(staged);
            std::size_t interior = 0;
            for (std::size_t i = 0; i < staged.mesh.vertex_slots(); ++i) interior += staged.mesh.info(VertexId{i}).carrier == CarrierKind::region;
            EXPECT_EQ(refiner.statistics().insertions, interior);
        }
}

TEST(Refine, NothingIsLeftToDo) {
    MeshOptions options;
    options.size.edge_length = 0.3;
    StagedMesh staged(transformed(cube_with_internal_facet(), 5, 0, 1), options);
    staged.conform();
    Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
    ASSERT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
    const std::size_t vertices = staged.mesh.vertex_count();
    double badness = 0;
    staged.for_domain([&](TetId t) { EXPECT_EQ(refiner.classify(t, badness), Refiner::Fault::none); });
    EXPECT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
    EXPECT_EQ(staged.mesh.vertex_count(), vertices);
}

/// Of coarse meshes with flat tetrahedra, and of refined ones, where it is to be said of nearly all.
TEST(Refine, WhatIsSurelyFaultlessHasNoFault) {
    for (const NamedPlc& named : all_synthetic_plcs())
        for (const std::uint64_t rotation : {0U, 3U}) {
            MeshOptions options;
            options.size.edge_length = 0.2;
            options.size.max_volume = 5e-4;
            options.quality.max_radius_edge_ratio = 1.6;
            StagedMesh staged(transformed(named.plc, rotation, 0, 1), options);
            staged.conform();
            Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
            std::size_t sure = 0, all = 0;
            const auto look_at_all = [&] {
                sure = all = 0;
                ShapeBatch<TetId> batch;
                const auto look = [&](TetId t, const SquaredShapes& shapes, std::size_t lane) {
                    double badness = 0;
                    ++all;
                    if (!refiner.is_surely_faultless(t, shapes, lane)) return;
                    ++sure;
                    ASSERT_EQ(refiner.classify(t, badness), Refiner::Fault::none) << named.name;
                };
                staged.for_domain([&](TetId t) {
                    const auto& c = staged.mesh.tets().corners(t);
                    batch.add(t, staged.mesh.point(c[0]), staged.mesh.point(c[1]), staged.mesh.point(c[2]), staged.mesh.point(c[3]), look);
                });
                batch.finish(look);
            };
            look_at_all();
            ASSERT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
            look_at_all();
            EXPECT_GT(static_cast<double>(sure), 0.9 * static_cast<double>(all)) << named.name;
        }
}

/// Points of one oblique line, but for rounding: the circumradius is noise, and comes out as nothing.
TEST(Refine, NothingIsSureOfAFlatTetrahedron) {
    MeshOptions options;
    options.size.edge_length = 0.3;
    StagedMesh staged(cube(), options);
    staged.conform();
    Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
    TetId any{};
    staged.for_domain([&](TetId t) { any = t; });
    std::size_t positive = 0;
    const auto look = [&](TetId t, const SquaredShapes& shapes, std::size_t lane) {
        positive += shapes.six_volumes[lane] > 0;
        EXPECT_FALSE(refiner.is_surely_faultless(t, shapes, lane));
    };
    ShapeBatch<TetId> batch;
    for (std::uint64_t k = 0; k < 200'000; ++k) {
        const auto draw = [&](std::uint64_t i) { return unit_double(mix64(k, i)); };
        const Vec3 from{0.1 + 0.5 * draw(0), 0.1 + 0.5 * draw(1), 0.1 + 0.5 * draw(2)}, along = 0.05 * Vec3{draw(3), draw(4), draw(5)};
        std::array<Vec3, 4> p;
        for (std::size_t i = 0; i < 4; ++i) p[i] = from + (0.25 * std::floor(4 * draw(6 + i)) + static_cast<double>(i)) * along;
        batch.add(any, p[0], p[1], p[2], p[3], look);
    }
    batch.finish(look);
    EXPECT_GT(positive, 1000U);
}

/// Of all tetrahedra beside an acute angle.
TEST(Refine, NothingExcusesWhatMayNotBeExcused) {
    MeshOptions options;
    options.size.edge_length = 0.15;
    StagedMesh staged(transformed(wedge(15), 2, 0, 1), options);
    staged.conform();
    Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
    ASSERT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
    std::size_t excused = 0, inside = 0;
    staged.for_domain([&](TetId t) {
        const bool is_excused = refiner.excuses(t), may_be = Refiner::may_be_excused(staged.mesh, t);
        EXPECT_TRUE(may_be || !is_excused);
        excused += is_excused;
        inside += !may_be;
    });
    EXPECT_GT(excused, 0U);
    EXPECT_GT(inside, 0U);
}

TEST(Refine, SplitRemovesItsTetrahedronAndRestoresTheGoals) {
    MeshOptions options;
    options.size.edge_length = 0.3;
    StagedMesh staged(transformed(cube(), 5, 0, 1), options);
    staged.conform();
    Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
    ASSERT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
    for (std::size_t round = 0; round < 10; ++round) {
        TetId worst{};
        double angle = 90;
        staged.for_domain([&](TetId t) {
            if (const double a = staged.shape(t).min_dihedral_deg; a < angle) {
                angle = a;
                worst = t;
            }
        });
        const auto corners = staged.mesh.tets().corners(worst);
        ASSERT_EQ(refiner.split(worst, InsertionReason::sliver), RunGuard::Verdict::go_on);
        const TetFace face = staged.mesh.triangulation().find_face(corners[0], corners[1], corners[2]);
        if (face.valid())
            for (const TetFace side : {face, staged.mesh.tets().across(face)}) { EXPECT_NE(staged.mesh.tets().corner(side.tet(), side.face()), corners[3]); }
        double badness = 0;
        staged.for_domain([&](TetId t) { EXPECT_EQ(refiner.classify(t, badness), Refiner::Fault::none); });
        EXPECT_EQ(staged.problem(true), "");
    }
}

TetMesh refined(const Plc& plc, std::uint64_t seed) {
    MeshOptions options;
    options.seed = seed;
    options.size.edge_length = 0.08 * diagonal(plc);
    StagedMesh staged(plc, options);
    staged.conform();
    Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
    EXPECT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
    return extract_mesh(staged.mesh);
}

TEST(Refine, SeedsDecideTheBytes) {
    for (const Plc& plc : {stepped_shaft(), transformed(cube_with_internal_facet(), 3, 1e3, 1e-6)}) {
        const TetMesh first = refined(plc, 1), again = refined(plc, 1), other = refined(plc, 2);
        EXPECT_TRUE(same(first, again));
        EXPECT_FALSE(same(first, other));
        EXPECT_NEAR(static_cast<double>(other.tets.size()), static_cast<double>(first.tets.size()), 0.1 * static_cast<double>(first.tets.size()));
    }
}

TEST(Refine, VertexBudgetLeavesAConformingMesh) {
    MeshOptions options;
    options.size.edge_length = 0.05;
    options.limits.max_vertices = 700;
    StagedMesh staged(transformed(cube_with_internal_facet(), 2, 0, 1), options);
    staged.conform();
    Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
    EXPECT_EQ(refiner.refine(), RunGuard::Verdict::out_of_vertices);
    EXPECT_GE(staged.mesh.vertex_count(), 700U);
    EXPECT_LT(staged.mesh.vertex_count(), 760U);
    EXPECT_EQ(staged.problem(true), "");
}

}  // namespace
}  // namespace wellmesh::testing
