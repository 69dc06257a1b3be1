// SPDX-License-Identifier: Apache-2.0
// Moves in zones: the same mesh for any number of threads, and whatever ends a run ends it there, too.
#include "shape/zone_passes.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <stop_token>
#include <vector>

#include "delaunay/zones.hpp"
#include "support/acute_plcs.hpp"
#include "support/any_threads.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"

namespace wellmesh::testing {
namespace {

/// A refined cube of about 40000 tetrahedra, enough for two zones, with slivers in it.
struct Refined {
    std::unique_ptr<StagedMesh> staged;
    std::unique_ptr<Refiner> refiner;

    explicit Refined(const Plc& plc = cube()) {
        MeshOptions options;
        options.size.edge_length = diagonal(plc) / 30;
        staged = std::make_unique<StagedMesh>(plc, options);
        staged->conform();
        refiner = std::make_unique<Refiner>(staged->mesh, staged->boundary, staged->guard, staged->options);
        EXPECT_EQ(refiner->refine(), RunGuard::Verdict::go_on);
        EXPECT_GT(staged->mesh.tets().live(), 33'000U);
    }
};

struct Outcome {
    std::vector<Vec3> points;
    std::vector<TetStore::Corners> tets;
    std::uint64_t moves = 0;
    friend bool operator==(const Outcome&, const Outcome&) = default;
};

Outcome improved(const Plc& plc, double angle, unsigned threads) {
    Refined r(plc);
    StagedMesh& staged = *r.staged;
    const auto volumes = staged.cell_volumes();
    Workers workers(threads);
    ShapeImprover improver(staged.mesh, staged.boundary, *r.refiner, staged.guard, workers, 0);
    const std::size_t bad = improver.count_bad(angle);
    EXPECT_GT(bad, 500U);
    EXPECT_EQ(improver.improve(angle), RunGuard::Verdict::go_on);
    EXPECT_LT(improver.count_bad(angle), bad / 100);
    EXPECT_EQ(staged.problem(true), "");
    for (const auto& [cell, volume] : staged.cell_volumes()) EXPECT_NEAR(volume, volumes.at(cell), 1e-9);
    Outcome out;
    for (std::size_t v = 0; v < staged.mesh.vertex_slots(); ++v) out.points.push_back(staged.mesh.point(VertexId{v}));
    for (std::size_t t = 0; t < staged.mesh.tets().slots(); ++t) {
        const TetId id{t};
        out.tets.push_back(staged.mesh.tets().is_live(id) ? staged.mesh.tets().corners(id) : TetStore::Corners{});
    }
    out.moves = improver.statistics().moves;
    return out;
}

TEST(ZonePasses, TheSameMeshForAnyNumberOfThreads) {
    same_for_any_threads([](unsigned threads) { return improved(cube(), 30, threads); });
}

TEST(ZonePasses, TheSameMeshBesideAnAcuteAngle) {
    const Plc plc = wedge(40);
    same_for_any_threads([&](unsigned threads) { return improved(plc, 25, threads); }, {1, 2});
}

/// Moves and last resorts in zones: vertices come and go, counted right, and what left its zone waits for the whole.
TEST(ZonePasses, VerticesComeAndGoInThem) {
    same_for_any_threads([](unsigned threads) {
        Refined r;
        StagedMesh& staged = *r.staged;
        const auto volumes = staged.cell_volumes();
        Workers workers(threads);
        TetJudge judge(staged.mesh, r.refiner->sizes(), 2);
        judge.set_goal(std::cos(42 * std::numbers::pi / 180), TetJudge::kNoAspect);  // more than moves reach
        VertexMover mover(staged.mesh, staged.boundary, judge, 0);
        BestInsertion insertion(staged.mesh, staged.boundary, judge, 0);
        Mending mending(staged.mesh, judge, mover);
        mending.badness = [&](TetId t) { return judge.shape_badness(t); };
        ZonePasses zones(staged.mesh, staged.boundary, staged.guard, workers, judge, mover, insertion, mending);
        mending.collect(workers);
        const std::size_t bad = mending.count(), before = staged.mesh.vertex_count();
        mending.begin_pass();
        EXPECT_EQ(zones.mend(2, LastResort::remove_or_insert), RunGuard::Verdict::go_on);
        EXPECT_GT(insertion.count(), 20U);
        EXPECT_GT(mover.statistics().removals, 20U);
        EXPECT_EQ(staged.mesh.vertex_count(), before + insertion.count() - mover.statistics().removals);
        std::size_t inserted = 0;
        for (std::size_t v = 0; v < staged.mesh.vertex_slots(); ++v) inserted += staged.mesh.triangulation().is_inserted(VertexId{v});
        EXPECT_EQ(inserted, staged.mesh.vertex_count());
        EXPECT_FALSE(mending.waiting().empty());
        EXPECT_LT(mending.waiting().size(), bad / 4);
        EXPECT_EQ(staged.problem(true), "");
        for (const auto& [cell, volume] : staged.cell_volumes()) EXPECT_NEAR(volume, volumes.at(cell), 1e-9);
        std::vector<TetStore::Corners> out;
        for (std::size_t t = 0; t < staged.mesh.tets().slots(); ++t) out.push_back(staged.mesh.tets().is_live(TetId{t}) ? staged.mesh.tets().corners(TetId{t}) : TetStore::Corners{});
        return out;
    });
}

/// All vertices inside of a mesh, smoothed in zones.
RunGuard::Verdict smooth_all(Refined& r, unsigned threads) {
    StagedMesh& staged = *r.staged;
    Workers workers(threads);
    TetJudge judge(staged.mesh, r.refiner->sizes(), 2);
    judge.set_goal(0.9, TetJudge::kNoAspect);
    VertexMover mover(staged.mesh, staged.boundary, judge, 0);
    Mending mending(staged.mesh, judge, mover);
    mending.badness = [&](TetId t) { return judge.shape_badness(t); };
    BestInsertion insertion(staged.mesh, staged.boundary, judge, 0);
    ZonePasses zones(staged.mesh, staged.boundary, staged.guard, workers, judge, mover, insertion, mending);
    std::vector<VertexId> vertices;
    for (std::size_t v = 0; v < staged.mesh.vertex_slots(); ++v) vertices.push_back(VertexId{v});
    const std::size_t all = vertices.size();
    const RunGuard::Verdict verdict = zones.smooth(vertices, 0.95);
    EXPECT_EQ(staged.problem(true), "");
    if (verdict == RunGuard::Verdict::go_on) {
        EXPECT_GT(mover.statistics().smoothings, all / 4);
        EXPECT_LT(vertices.size(), all / 2);  // what lay along the limits of all turns
    }
    return verdict;
}

TEST(ZonePasses, VerticesAreSmoothedAndTheMeshStaysWhole) {
    Refined r;
    EXPECT_EQ(smooth_all(r, 3), RunGuard::Verdict::go_on);
}

TEST(ZonePasses, TimeEndsThem) {
    for (const unsigned threads : kSanitized ? std::vector{2U} : std::vector{1U, 2U}) {
        Refined r;
        // Three looks at the clock, then it is late.
        int looks = 0;
        r.staged->control.clock = [&] { return std::chrono::steady_clock::time_point(std::chrono::hours(++looks > 3 ? 1000000 : 0)); };
        Limits limits;
        limits.time = std::chrono::milliseconds(1000);
        r.staged->guard = RunGuard(limits, r.staged->control);
        EXPECT_EQ(smooth_all(r, threads), RunGuard::Verdict::out_of_time);
    }
}

TEST(ZonePasses, CancellingEndsThem) {
    Refined r;
    std::stop_source source;
    r.staged->control.stop = source.get_token();
    source.request_stop();
    EXPECT_EQ(smooth_all(r, 2), RunGuard::Verdict::cancelled);
}

TEST(ZonePasses, WhatTheCallerThrowsComesOut) {
    Refined r;
    r.staged->control.on_progress = [](const Progress&) { throw std::runtime_error("enough"); };
    Workers workers(2);
    EXPECT_THROW((void)ShapeImprover(r.staged->mesh, r.staged->boundary, *r.refiner, r.staged->guard, workers, 0).improve(30), std::runtime_error);
}

TEST(Zones, AViewRefusesWhatLeavesItsZone) {
    Refined r;
    StagedMesh& staged = *r.staged;
    ConformingMesh& mesh = staged.mesh;
    std::vector<Vec3> sample;
    for (std::size_t v = 0; v < mesh.vertex_slots(); ++v) sample.push_back(mesh.point(VertexId{v}));
    const Zones zones(sample, 2, 0);
    ZoneViews parts;
    std::vector<ConformingMesh> views = mesh.split(staged.workers, zones, {}, parts);
    ASSERT_EQ(views.size(), 2U);
    std::size_t whole = 0, left = 0;
    std::vector<TetId> star;
    for (std::size_t i = 0; i < mesh.vertex_slots(); ++i) {
        const VertexId v{i};
        const std::uint8_t zone = parts.zone_of_vertex[i];
        EXPECT_EQ(zone, zones.zone_of(mesh.point(v)));
        Triangulation& view = views[zone].triangulation();
        view.forget_leaving();
        const bool found = view.find_star(v, star);
        EXPECT_EQ(found, !view.left_zone());
        for (const TetId t : star) EXPECT_EQ(parts.zone_of_tet[t.index()], zone);
        ++(found ? whole : left);
    }
    EXPECT_GT(left, 100U);
    EXPECT_GT(whole, 10 * left / 2);
    mesh.join(views);
    EXPECT_EQ(staged.problem(true), "");
}

}  // namespace
}  // namespace wellmesh::testing
