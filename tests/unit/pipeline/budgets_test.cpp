// SPDX-License-Identifier: Apache-2.0
// Always an end, wherever a budget is spent: a typed error before the mesh conforms, a valid mesh from then on. Clocks and memory are the test's
// own, so that every run is repeatable.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "support/acute_plcs.hpp"
#include "support/expect_result.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh::testing {
namespace {

/// One millisecond passes whenever somebody looks at the clock.
RunControl ticking() {
    RunControl control;
    control.clock = [time = std::chrono::steady_clock::time_point{}]() mutable { return time += std::chrono::milliseconds(1); };
    return control;
}

struct Outcome {
    std::optional<MeshResult> result{};
    std::optional<MeshError> error{};
};

Outcome run(const Plc& plc, const MeshOptions& options, const RunControl& control) {
    try {
        return {.result = generate(plc, options, control)};
    } catch (const MeshError& e) {
        return {.error = e};
    }
}

void expect_typed(const Outcome& outcome) {
    ASSERT_TRUE(outcome.error.has_value());
    EXPECT_EQ(outcome.error->code(), ErrorCode::budget_exhausted) << outcome.error->what();
    EXPECT_LE(outcome.error->stage(), Stage::conform) << outcome.error->what();
}

TEST(Budgets, ATimeLimitOfAnyLengthEndsInATypedErrorOrAMesh) {
    for (const NamedPlc& named : all_synthetic_plcs()) {
        const Plc plc = transformed(named.plc, 1, 0, 1);
        MeshOptions options;
        options.size.edge_length = 0.12 * diagonal(plc);
        options.quality.min_dihedral_angle_deg = 30;
        std::size_t errors = 0, cut_short = 0;
        bool finished = false;
        for (int limit = 1; !finished; limit += 1 + limit / 2) {
            SCOPED_TRACE(fmt::format("{}, {} ms", named.name, limit));
            ASSERT_LT(limit, 1'000'000);
            options.limits.time = std::chrono::milliseconds(limit);
            const Outcome outcome = run(plc, options, ticking());
            if (!outcome.result) {
                expect_typed(outcome);
                EXPECT_EQ(cut_short, 0U) << "a longer limit gave less";
                ++errors;
                continue;
            }
            expect_valid(*outcome.result);
            finished = outcome.result->termination != Termination::time_budget_reached;
            cut_short += !finished;
        }
        EXPECT_GT(errors, 0U);
        EXPECT_GT(cut_short, 1U) << named.name;
    }
}

/// Encroached pieces that wait in a zone when it is told to stop go on waiting in the whole.
TEST(Budgets, ATimeLimitThatEndsInZonesOfTheBoundaryLeavesNothingEncroached) {
    const Plc plc = bumpy_ball(12);
    MeshOptions options;
    options.size.edge_length = 0.06;
    options.quality.min_dihedral_angle_deg = 0;
    options.threads = 1;
    std::size_t cut_short = 0;
    bool finished = false;
    for (int limit = 40; !finished; limit += 1 + limit / 12) {
        SCOPED_TRACE(fmt::format("{} ms", limit));
        ASSERT_LT(limit, 1'000'000);
        options.limits.time = std::chrono::milliseconds(limit);
        const Outcome outcome = run(plc, options, ticking());
        if (!outcome.result) {
            expect_typed(outcome);
            continue;
        }
        expect_valid(*outcome.result);
        finished = outcome.result->termination != Termination::time_budget_reached;
        cut_short += !finished;
    }
    EXPECT_GT(cut_short, 20U);
}

TEST(Budgets, ALimitByARepeatableClockGivesTheSameMeshTwice) {
    const Plc plc = transformed(stepped_shaft(), 1, 0, 1);
    MeshOptions options;
    options.size.edge_length = 0.1 * diagonal(plc);
    options.limits.time = std::chrono::milliseconds(150);
    const MeshResult first = generate(plc, options, ticking()), second = generate(plc, options, ticking());
    EXPECT_EQ(first.termination, Termination::time_budget_reached);
    EXPECT_EQ(first.mesh.vertices, second.mesh.vertices);
    EXPECT_EQ(first.mesh.tets, second.mesh.tets);
}

TEST(Budgets, EveryVertexBudgetIsKept) {
    const Plc plc = transformed(cube_with_internal_facet(), 2, 0, 1);
    for (const Seeding seeding : {Seeding::off, Seeding::automatic}) {
        std::size_t meshes = 0;
        for (std::uint64_t most = 4; most < 150; ++most) {
            SCOPED_TRACE(fmt::format("{} vertices, {}", most, seeding == Seeding::off ? "no lattice" : "a lattice"));
            MeshOptions options;
            options.size.edge_length = 0.1 * diagonal(plc);
            options.seeding = seeding;
            options.limits.max_vertices = most;
            const Outcome outcome = run(plc, options, {});
            if (!outcome.result) {
                expect_typed(outcome);
                EXPECT_EQ(meshes, 0U);
                continue;
            }
            ++meshes;
            expect_valid(*outcome.result);
            EXPECT_EQ(outcome.result->termination, Termination::vertex_budget_reached);
            EXPECT_LE(outcome.result->mesh.vertices.size(), most);
        }
        EXPECT_GT(meshes, 100U);
    }
}

/// The boundary is split for the lattice's sake, with cascades, before refinement begins to count.
TEST(Budgets, AreKeptWhileTheBoundaryIsSplitForTheLattice) {
    std::size_t meshes = 0;
    for (std::uint64_t rotation = 0; rotation < 2; ++rotation) {
        const Plc plc = transformed(stepped_shaft(), rotation, 0, 1);
        for (std::uint64_t most = 36; most < 60; ++most) {
            SCOPED_TRACE(fmt::format("{} vertices, rotation {}", most, rotation));
            MeshOptions options;
            options.size.edge_length = 0.05 * diagonal(plc);
            options.limits.max_vertices = most;
            const Outcome outcome = run(plc, options, {});
            if (!outcome.result) continue;
            ++meshes;
            expect_valid(*outcome.result);
            EXPECT_LE(outcome.result->mesh.vertices.size(), most);
        }
    }
    EXPECT_GT(meshes, 24U);
}

/// Also where facets ask for splits that others have made superfluous by then.
TEST(Budgets, AsManyVerticesAsConformityTakesAreEnough) {
    std::size_t split = 0;
    for (const Plc& plc : {bundle(1, 7), bundle(2, 7), bundle(3, 7), tip_to_tip(1, 10, 0.5), two_blades(0.1)}) {
        MeshOptions options;
        options.slivers = SliverStrategy::none;
        options.quality = {.max_radius_edge_ratio = 1e300, .min_dihedral_angle_deg = 0};
        const Outcome free = run(plc, options, {});
        ASSERT_TRUE(free.result);
        options.limits.max_vertices = free.result->mesh.vertices.size();
        split += *options.limits.max_vertices - plc.vertices.size();
        const Outcome enough = run(plc, options, {});
        ASSERT_TRUE(enough.result) << enough.error->what();
        EXPECT_EQ(enough.result->mesh.vertices, free.result->mesh.vertices);
    }
    EXPECT_GT(split, 300U);
}

TEST(Budgets, FewerVerticesThanTheInputHasAreTooFew) {
    MeshOptions options;
    options.limits.max_vertices = 7;
    const Outcome outcome = run(cube(), options, {});
    expect_typed(outcome);
    EXPECT_NE(std::string(outcome.error->what()).find("at most 7"), std::string::npos) << outcome.error->what();
    options.limits.max_vertices = 8;
    options.quality.min_dihedral_angle_deg = 0;
    EXPECT_TRUE(run(cube(), options, {}).result.has_value());
}

TEST(Budgets, AMemoryLimitEndsTheRunWithAMesh) {
    // Memory grows by a MiB each time it is looked at, and is looked at each time the clock is.
    RunControl control = ticking();
    control.resident_bytes = [held = std::uint64_t{16} << 20]() mutable { return held += std::uint64_t{1} << 20; };
    MeshOptions options;
    options.size.edge_length = 0.05;
    options.limits.memory_bytes = std::uint64_t{200} << 20;
    const Outcome outcome = run(transformed(cube(), 1, 0, 1), options, control);
    ASSERT_TRUE(outcome.result.has_value()) << outcome.error->what();
    EXPECT_EQ(outcome.result->termination, Termination::memory_budget_reached);
    expect_valid(*outcome.result);

    options.limits.memory_bytes = std::uint64_t{18} << 20;
    expect_typed(run(transformed(cube(), 1, 0, 1), options, control));
}

TEST(Budgets, ASizeThatCanNotFitIntoMemoryIsRefusedAtOnce) {
    MeshOptions options;
    options.size.edge_length = 0.003;
    options.limits.memory_bytes = std::uint64_t{4} << 30;
    const Outcome outcome = run(cube(), options, {});
    ASSERT_TRUE(outcome.error.has_value());
    EXPECT_EQ(outcome.error->code(), ErrorCode::mesh_too_large) << outcome.error->what();
    EXPECT_NE(std::string(outcome.error->what()).find("GiB"), std::string::npos) << outcome.error->what();
}

TEST(Budgets, ValidationAndDelaunayStopWhenAsked) {
    std::stop_source source;
    source.request_stop();
    RunControl stopped;
    stopped.stop = source.get_token();
    const Outcome cancelled = run(stepped_shaft(), {}, stopped);
    ASSERT_TRUE(cancelled.error.has_value());
    EXPECT_EQ(cancelled.error->code(), ErrorCode::cancelled);
    EXPECT_EQ(cancelled.error->stage(), Stage::validate);

    // Many points in a box: the triangulation looks at the clock on its way, too.
    Plc crowd = cube(100);
    for (int i = 0; i < 4000; ++i) crowd.vertices.push_back({1.0 + 98.0 * ((i * 7919) % 4001) / 4001, 1.0 + 98.0 * ((i * 104729) % 3989) / 3989, 1.0 + 98.0 * i / 4000});
    MeshOptions options;
    bool in_delaunay = false;
    for (int limit = 1; limit < 200 && !in_delaunay; ++limit) {
        options.limits.time = std::chrono::milliseconds(limit);
        const Outcome outcome = run(crowd, options, ticking());
        in_delaunay = outcome.error && outcome.error->stage() == Stage::delaunay;
    }
    EXPECT_TRUE(in_delaunay);
}

TEST(Budgets, AskingForMoreThanCanBeReachedGivesNoLess) {
    const Plc plc = transformed(cube(), 1, 0, 1);
    MeshOptions options;
    options.size.edge_length = 0.25;
    options.quality.min_dihedral_angle_deg = 35;
    EXPECT_EQ(generate(plc, options).termination, Termination::goals_met);
    options.quality.min_dihedral_angle_deg = 65;
    options.limits.time = std::chrono::seconds(8);
    const MeshResult more = generate(plc, options, ticking());
    EXPECT_NE(more.termination, Termination::goals_met);
    EXPECT_GE(more.certificate.all.min_dihedral_angle_deg, 35);
}

}  // namespace
}  // namespace wellmesh::testing
