// SPDX-License-Identifier: Apache-2.0
#include "refinement/lattice_seeding.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/infinity.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "support/acute_plcs.hpp"
#include "support/expect_result.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"
#include "validation/closest_points.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh::testing {
namespace {

MeshOptions sized(double edge_length, Seeding seeding = Seeding::automatic) {
    MeshOptions options;
    options.size.edge_length = edge_length;
    options.seeding = seeding;
    return options;
}

TEST(LatticeSeeding, MeshConformsAndKeepsItsBoundsWithFewerVertices) {
    for (const NamedPlc& named : all_synthetic_plcs())
        for (std::uint64_t rotation = 0; rotation < 2; ++rotation) {
            SCOPED_TRACE(fmt::format("{} rotation {}", named.name, rotation));
            const Plc plc = transformed(named.plc, rotation, 0, 1);
            const MeshOptions options = sized(0.03 * diagonal(named.plc));
            StagedMesh staged(plc, options);
            staged.conform();
            Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
            EXPECT_GT(LatticeSeeder(staged.mesh, staged.boundary, staged.guard, refiner.sizes(), staged.workers).seed(), 100U);
            EXPECT_EQ(staged.problem(false), "");
            ASSERT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
            EXPECT_EQ(staged.problem(true), "");

            const MeshResult seeded = generate(plc, options), plain = generate(plc, sized(*options.size.edge_length, Seeding::off));
            expect_goals_met(seeded);
            EXPECT_LT(static_cast<double>(seeded.mesh.vertices.size()), 0.9 * static_cast<double>(plain.mesh.vertices.size()));
        }
}

/// Sixty degrees inside, unlike what refinement alone makes: the lattice survives.
TEST(LatticeSeeding, InsideIsTheLattice) {
    const MeshOptions options = sized(0.04);
    StagedMesh staged(cube(), options);
    staged.conform();
    Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
    LatticeSeeder(staged.mesh, staged.boundary, staged.guard, refiner.sizes(), staged.workers).seed();
    ASSERT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
    std::size_t inner = 0;
    staged.for_domain([&](TetId t) {
        for (const VertexId v : staged.mesh.tets().corners(t)) {
            const Vec3& p = staged.mesh.point(v);
            if (std::min({p.x, p.y, p.z, 1 - p.x, 1 - p.y, 1 - p.z}) < 0.15) return;
        }
        ++inner;
        EXPECT_NEAR(staged.shape(t).min_dihedral_deg, 60, 0.1);
    });
    EXPECT_GT(inner, 5000U);
}

/// Sizes at which a point of the lattice falls beside a corner of the cavity, where no subface is near in the mesh.
TEST(LatticeSeeding, KeepsClearOfCornersThatPointInwards) {
    for (double edge_length = 0.2; edge_length < 0.36; edge_length += 0.002) {
        const MeshOptions options = sized(edge_length);
        StagedMesh staged(cube_with_cavity(), options);
        staged.conform();
        Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
        LatticeSeeder(staged.mesh, staged.boundary, staged.guard, refiner.sizes(), staged.workers).seed();
        const double clearance = 0.4 * kCircumradiusPerEdgeLength * edge_length;  // 0.5, but for places beside an edge
        for (std::size_t i = 0; i < staged.mesh.vertex_slots(); ++i) {
            if (staged.mesh.info(VertexId{i}).reason != InsertionReason::lattice || !staged.mesh.triangulation().is_inserted(VertexId{i})) continue;
            const Vec3& p = staged.mesh.point(VertexId{i});
            // The cavity is the middle one of 3 x 3 x 3 unit cells.
            const Vec3 nearest{std::clamp(p.x, 1.0, 2.0), std::clamp(p.y, 1.0, 2.0), std::clamp(p.z, 1.0, 2.0)};
            ASSERT_GE(distance(p, nearest), clearance) << edge_length;
            ASSERT_GE(std::min({p.x, p.y, p.z, 3 - p.x, 3 - p.y, 3 - p.z}), clearance) << edge_length;
        }
    }
}

/// Nowhere nearer to the boundary than they may be, everywhere else no farther from each other than the lattice's points are.
TEST(LatticeSeeding, SeedsAreClearOfTheBoundaryAndFillTheRest) {
    for (const NamedPlc& named : all_synthetic_plcs())
        for (const bool varies : {false, true}) {
            SCOPED_TRACE(fmt::format("{} {}", named.name, varies ? "graded" : "even"));
            MeshOptions options = sized(0.03 * diagonal(named.plc));
            const double length = *options.size.edge_length, radius = kCircumradiusPerEdgeLength * length;
            const Plc plc = transformed(named.plc, 1, 0, 1);
            if (varies) options.size.at = [&plc, length](const Vec3& p) { return 0.5 * length + 0.05 * distance(p, plc.vertices[0]); };
            StagedMesh staged(plc, options);
            staged.conform();
            Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
            LatticeSeeder(staged.mesh, staged.boundary, staged.guard, refiner.sizes(), staged.workers).seed();
            const ConformingMesh& mesh = staged.mesh;
            const auto to_boundary = [&](const Vec3& p) {
                double least = kInfinity;
                for (const ValidFacet& f : staged.plc.facets)
                    for (const auto& t : f.triangles)
                        least = std::min(least, distance_to_triangle(p, staged.plc.vertices[t[0].index()], staged.plc.vertices[t[1].index()],
                                                                     staged.plc.vertices[t[2].index()]));
                return least;
            };
            std::vector<Vec3> seeds;
            for (std::size_t i = 0; i < mesh.vertex_slots(); ++i)
                if (mesh.info(VertexId{i}).reason == InsertionReason::lattice && mesh.triangulation().is_inserted(VertexId{i}))
                    seeds.push_back(mesh.point(VertexId{i}));
            ASSERT_GT(seeds.size(), 500U);
            for (const Vec3& p : seeds) {
                const CellId cell = mesh.cell(mesh.triangulation().locate(p, TetId{}));
                ASSERT_GE(to_boundary(p), 0.4 * kCircumradiusPerEdgeLength * refiner.sizes().edge_length(p, cell));  // 0.5, but for places beside an edge
            }
            std::size_t looked_at = 0;
            for (std::uint64_t k = 0; k < 4000; ++k) {
                const Vec3 offset{unit_double(mix64(k, 1)) - 0.5, unit_double(mix64(k, 2)) - 0.5, unit_double(mix64(k, 3)) - 0.5};
                const Vec3 p = seeds[mix64(k) % seeds.size()] + radius * offset;
                if (to_boundary(p) < 2.5 * radius) continue;
                ++looked_at;
                double nearest = kInfinity;
                for (const Vec3& s : seeds) nearest = std::min(nearest, distance(p, s));
                ASSERT_LE(nearest, 1.001 * kLatticeScale * radius);
            }
            EXPECT_GT(looked_at, 20U);
        }
}

struct Seeded {
    std::uint64_t seeds = 0, known = 0;
    bool at_once = false;
    std::vector<Vec3> points;
    std::vector<TetStore::Corners> tets;
};

Seeded seeded(const Plc& plc, const MeshOptions& options, unsigned threads, const RunControl& control = {}) {
    StagedMesh staged(plc, options);
    Workers workers(threads);
    staged.conform();
    staged.guard = RunGuard(options.limits, control);
    staged.guard.set_conforming();
    Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
    LatticeSeeder seeder(staged.mesh, staged.boundary, staged.guard, refiner.sizes(), workers);
    Seeded out;
    out.seeds = seeder.seed();
    out.known = seeder.known();
    out.at_once = seeder.went_at_once();
    EXPECT_EQ(staged.problem(false), "");
    for (std::size_t v = 0; v < staged.mesh.vertex_slots(); ++v) out.points.push_back(staged.mesh.point(VertexId{v}));
    for (std::size_t t = 0; t < staged.mesh.tets().slots(); ++t) out.tets.push_back(staged.mesh.tets().corners(TetId{t}));
    return out;
}

/// Inside each of them the lattice's tetrahedra are put in as they are known to be.
TEST(LatticeSeeding, SeparatePartsAreFilledEach) {
    Plc plc = cube();
    const Plc other = cube();
    const auto first = static_cast<std::uint32_t>(plc.vertices.size());
    for (const Vec3& p : other.vertices) plc.vertices.push_back(0.7 * p + Vec3{1.5, 0.2, 0.1});
    for (PlcFacet facet : other.facets) {
        for (auto& polygon : facet.polygons)
            for (auto& v : polygon) v += first;
        plc.facets.push_back(facet);
    }
    const Seeded one = seeded(plc, sized(0.06), 1);
    EXPECT_GT(one.seeds, 5000U);
    EXPECT_GT(one.known, one.seeds / 4);
    for (const unsigned threads : {2U, 3U}) {
        const Seeded several = seeded(plc, sized(0.06), threads);
        EXPECT_EQ(several.known, one.known);
        EXPECT_TRUE(several.points == one.points);
        EXPECT_TRUE(several.tets == one.tets);
    }
}

TEST(LatticeSeeding, KnownTetrahedraKeepAwayFromAllThatIsInside) {
    Plc with_wire = cube();
    with_wire.vertices.insert(with_wire.vertices.end(), {{0.3, 0.35, 0.4}, {0.7, 0.6, 0.55}, {0.5, 0.2, 0.7}});
    with_wire.segments.push_back({{8, 9}});
    EXPECT_GT(seeded(with_wire, sized(0.05), 1).known, 500U);

    Plc two_cells = cube_with_internal_facet();
    two_cells.region_seeds[0].max_volume = 1e-4;
    two_cells.region_seeds[1].max_volume = 1e-4 / 64;
    MeshOptions options;
    EXPECT_GT(seeded(two_cells, options, 1).known, 500U);

    // A size is asked for in one half only, and nothing makes it grow beyond.
    options.size.gradation = 0;
    options.size.at = [](const Vec3& p) { return p.x < 0.6 ? 0.04 : kInfinity; };
    EXPECT_GT(seeded(cube(), options, 1).known, 100U);
}

/// Two plates so near to each other that each facet would be split for the sake of the other's points: they are made from coarse to fine, on any number of threads.
TEST(LatticeSeeding, FacetsTooNearToEachOtherAreNotMadeAtOnce) {
    Plc plc = cube();
    const auto first = static_cast<std::uint32_t>(plc.vertices.size());
    for (const double z : {0.5, 0.508})
        for (const auto& [x, y] : {std::pair{0.05, 0.05}, {0.95, 0.05}, {0.95, 0.95}, {0.05, 0.95}}) plc.vertices.push_back({x, y, z});
    for (std::uint32_t k = 0; k < 2; ++k) {
        PlcFacet facet = plc.facets[0];
        facet.polygons = {{first + 4 * k, first + 4 * k + 1, first + 4 * k + 2, first + 4 * k + 3}};
        plc.facets.push_back(facet);
    }
    const Seeded one = seeded(plc, sized(0.05), 1), several = seeded(plc, sized(0.05), 2);
    EXPECT_GT(one.seeds, 1000U);
    EXPECT_FALSE(one.at_once);
    EXPECT_TRUE(several.points == one.points);
    EXPECT_TRUE(several.tets == one.tets);
}

TEST(LatticeSeeding, AllIsMadeAtOnceWhereNothingSpeaksAgainstIt) {
    for (const NamedPlc& named : all_synthetic_plcs()) EXPECT_TRUE(seeded(named.plc, sized(0.04 * diagonal(named.plc)), 2).at_once) << named.name;
    // Whoever asks for the size.
    MeshOptions by_field;
    by_field.size.at = [](const Vec3& p) { return 0.04 + 0.02 * p.x; };
    EXPECT_TRUE(seeded(cube(), by_field, 1).at_once);
    // A few vertices beside acute angles are no matter, many are.
    EXPECT_TRUE(seeded(wedge(45), sized(0.05), 1).at_once);
    EXPECT_FALSE(seeded(wedge(20), sized(0.05), 1).at_once);
    MeshOptions limited = sized(0.04);
    limited.limits.max_vertices = 10'000'000;
    EXPECT_FALSE(seeded(cube(), limited, 1).at_once);
}

/// A layer too thin for a lattice, but not for two sides that know nothing of each other.
TEST(LatticeSeeding, ALayerBesideThickGroundIsNoObstacle) {
    Plc plc = cube_with_internal_facet();
    for (Vec3& p : plc.vertices)
        if (p.x > 1) p.x = 1 + 0.05 * (p.x - 1);
    plc.region_seeds[1].point.x = 1.025;
    const Seeded one = seeded(plc, sized(0.05), 1);
    EXPECT_TRUE(one.at_once);
    EXPECT_GT(one.seeds, 3000U);
    // Its far side is as fine as the others: without that there were no vertices but those of its outline.
    const auto beyond = std::count_if(one.points.begin(), one.points.end(), [](const Vec3& p) { return p.x > 1.049 && p.y > 0.01 && p.y < 0.99 && p.z > 0.01 && p.z < 0.99; });
    EXPECT_GT(beyond, 200);
}

/// Pieces of segments that end in a larger ball would all have to be split one by one.
TEST(LatticeSeeding, BallsAreNoLargerThanWhatIsAskedFor) {
    const MeshOptions options = sized(0.04);
    StagedMesh staged(wedge(60), options);
    const std::vector<double> before = staged.boundary.acute().balls();
    ASSERT_GT(*std::max_element(before.begin(), before.end()), 0.1);
    staged.conform();
    Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
    LatticeSeeder seeder(staged.mesh, staged.boundary, staged.guard, refiner.sizes(), staged.workers);
    EXPECT_GT(seeder.seed(), 1000U);
    EXPECT_TRUE(seeder.went_at_once());
    EXPECT_EQ(staged.problem(false), "");
    const double radius = kCircumradiusPerEdgeLength * 0.04;
    for (std::size_t v = 0; v < before.size(); ++v) {
        const double ball = staged.boundary.acute().ball_radius(VertexId{v});
        EXPECT_LE(ball, 1.1 * radius);
        EXPECT_EQ(ball > 0, before[v] > 0);
        if (before[v] > 0) { EXPECT_EQ(std::ldexp(1, std::ilogb(before[v] / ball)), before[v] / ball) << "halved"; }
    }
}

/// What is known would be there at once: a limit on memory is kept by insertion.
TEST(LatticeSeeding, KnownTetrahedraKeepTheLimitOnMemory) {
    MeshOptions options = sized(0.05);
    EXPECT_GT(seeded(cube(), options, 1).known, 0U);
    options.limits.memory_bytes = std::uint64_t{1} << 30;
    RunControl control;
    control.resident_bytes = [] { return static_cast<std::uint64_t>((std::uint64_t{1} << 30) / 1.5) - 1000; };
    const Seeded limited = seeded(cube(), options, 1, control);
    EXPECT_EQ(limited.known, 0U);
    EXPECT_GT(limited.seeds, 1000U);
}

TEST(LatticeSeeding, WhereNothingIsAskedNothingChanges) {
    for (const Seeding seeding : {Seeding::automatic, Seeding::off}) {
        MeshOptions options;
        options.seeding = seeding;
        const MeshResult result = generate(l_block(), options);
        expect_goals_met(result);
        EXPECT_LT(result.mesh.vertices.size(), 100U);
    }
}

TEST(LatticeSeeding, TooThinCellsAreLeftAlone) {
    // A plate one lattice constant thick.
    Plc plate = cube();
    for (Vec3& p : plate.vertices) p.z *= 0.06;
    const MeshOptions automatic = sized(0.05);
    EXPECT_EQ(generate(plate, automatic).mesh.vertices, generate(plate, sized(0.05, Seeding::off)).mesh.vertices);
}

TEST(LatticeSeeding, RegionsOfDifferentSizesGradeOverTheOctree) {
    Plc plc = cube_with_internal_facet();
    ASSERT_EQ(plc.region_seeds.size(), 2U);
    plc.region_seeds[0].max_volume = 2e-3;
    plc.region_seeds[1].max_volume = 2e-3 / 512;  // eight times finer
    const MeshResult result = generate(plc, {});
    expect_goals_met(result);
    MeshOptions off;
    off.seeding = Seeding::off;
    EXPECT_LT(result.mesh.vertices.size(), generate(plc, off).mesh.vertices.size());
}

TEST(LatticeSeeding, BudgetsHold) {
    for (const std::uint64_t budget : {50U, 400U, 3000U}) {
        MeshOptions options = sized(0.02);
        options.limits.max_vertices = budget;
        const MeshResult result = generate(cube(), options);
        expect_valid(result);
        EXPECT_EQ(result.termination, Termination::vertex_budget_reached);
        EXPECT_LE(result.mesh.vertices.size(), budget + 64);
    }
}

}  // namespace
}  // namespace wellmesh::testing
