// SPDX-License-Identifier: Apache-2.0
// Boundary splitting, seeding and refinement in zones: the same mesh for any number of threads, and whatever ends a run ends it there, too.
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <stop_token>
#include <vector>

#include "core/vec3_math.hpp"
#include "delaunay/zones.hpp"
#include "refinement/lattice_seeding.hpp"
#include "refinement/refine.hpp"
#include "support/acute_plcs.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"

namespace wellmesh::testing {
namespace {

/// A domain cut fine enough for several zones, with what is to be refined in it.
struct Staged {
    std::unique_ptr<StagedMesh> staged;
    std::unique_ptr<Workers> workers;
    std::unique_ptr<Refiner> refiner;

    Staged(const Plc& plc, double edges_per_diagonal, unsigned threads) {
        MeshOptions options;
        options.size.edge_length = diagonal(plc) / edges_per_diagonal;
        staged = std::make_unique<StagedMesh>(plc, options);
        staged->conform();
        workers = std::make_unique<Workers>(threads);
        refiner = std::make_unique<Refiner>(staged->mesh, staged->boundary, staged->guard, staged->options, workers.get());
    }
    [[nodiscard]] ConformingMesh& mesh() const { return staged->mesh; }
    /// Vertices that were put aside for zones and not needed: nothing else leaves any where none is taken out.
    [[nodiscard]] std::size_t spare() const { return mesh().vertex_slots() - mesh().vertex_count(); }
};

struct Outcome {
    std::vector<Vec3> points;
    std::vector<TetStore::Corners> tets;
    std::vector<CellId> cells;
    friend bool operator==(const Outcome&, const Outcome&) = default;
};

Outcome outcome_of(const ConformingMesh& mesh) {
    Outcome out;
    for (std::size_t v = 0; v < mesh.vertex_slots(); ++v) out.points.push_back(mesh.point(VertexId{v}));
    for (std::size_t t = 0; t < mesh.tets().slots(); ++t) {
        const bool live = mesh.tets().is_live(TetId{t});
        out.tets.push_back(live ? mesh.tets().corners(TetId{t}) : TetStore::Corners{});
        out.cells.push_back(live ? mesh.cell(TetId{t}) : CellId{});
    }
    return out;
}

Outcome seeded_and_refined(const Plc& plc, double edges_per_diagonal, unsigned threads) {
    const Staged s(plc, edges_per_diagonal, threads);
    const auto volumes = s.staged->cell_volumes();
    LatticeSeeder(s.mesh(), s.staged->boundary, s.staged->guard, s.refiner->sizes(), *s.workers).seed();
    EXPECT_TRUE(s.staged->boundary.idle());
    EXPECT_EQ(s.staged->problem(true), "");
    EXPECT_EQ(s.refiner->refine(), RunGuard::Verdict::go_on);
    EXPECT_EQ(s.staged->problem(true), "");
    EXPECT_GT(s.spare(), 0U);
    for (const auto& [cell, volume] : s.staged->cell_volumes()) EXPECT_NEAR(volume, volumes.at(cell), 1e-9);
    s.staged->for_domain([&](TetId t) {
        double badness = 0;
        EXPECT_TRUE(s.refiner->classify(t, badness) == Refiner::Fault::none || s.refiner->forced_by(t).has_value());
    });
    return outcome_of(s.mesh());
}

TEST(RefineInZones, TheSameMeshForAnyNumberOfThreads) {
    for (const NamedPlc& named : all_synthetic_plcs()) {
        SCOPED_TRACE(named.name);
        const Plc plc = transformed(named.plc, 3, 0, 1);
        const Outcome alone = seeded_and_refined(plc, 70, 1);
        for (const unsigned threads : {2U, 3U}) EXPECT_TRUE(alone == seeded_and_refined(plc, 70, threads)) << threads << " threads";
    }
}

TEST(RefineInZones, TheSameMeshBesideAnAcuteAngle) {
    const Plc plc = wedge(40);
    const Outcome alone = seeded_and_refined(plc, 90, 1);
    EXPECT_TRUE(alone == seeded_and_refined(plc, 90, 3));
}

/// Without a lattice nearly all is left to refinement.
TEST(RefineInZones, TheSameMeshWithoutSeeds) {
    std::vector<Outcome> outcomes;
    for (const unsigned threads : {1U, 3U}) {
        const Staged s(cube(), 40, 1);
        EXPECT_EQ(s.refiner->refine(), RunGuard::Verdict::go_on);
        // The same once more from there, finer: now there is enough of it.
        MeshOptions options = s.staged->options;
        options.size.edge_length = 0.7 * *options.size.edge_length;
        Workers workers(threads);
        Refiner finer(s.mesh(), s.staged->boundary, s.staged->guard, options, &workers);
        EXPECT_EQ(finer.refine(), RunGuard::Verdict::go_on);
        EXPECT_GT(s.spare(), 0U);
        EXPECT_GT(finer.statistics().insertions, 5000U);
        EXPECT_EQ(s.staged->problem(true), "");
        outcomes.push_back(outcome_of(s.mesh()));
    }
    EXPECT_TRUE(outcomes[0] == outcomes[1]);
}

TEST(RefineInZones, TimeEndsItWithAMeshThatConforms) {
    for (const unsigned threads : {1U, 2U}) {
        const Staged s(cube(), 40, 1);
        ASSERT_EQ(s.refiner->refine(), RunGuard::Verdict::go_on);
        MeshOptions options = s.staged->options;
        options.size.edge_length = 0.7 * *options.size.edge_length;
        Workers workers(threads);
        Refiner finer(s.mesh(), s.staged->boundary, s.staged->guard, options, &workers);
        int looks = 0;
        s.staged->control.clock = [&] { return std::chrono::steady_clock::time_point(std::chrono::hours(++looks > 5 ? 1000000 : 0)); };
        Limits limits;
        limits.time = std::chrono::milliseconds(1000);
        s.staged->guard = RunGuard(limits, s.staged->control);
        s.staged->guard.set_conforming();
        EXPECT_EQ(finer.refine(), RunGuard::Verdict::out_of_time);
        EXPECT_TRUE(s.staged->boundary.idle());
        EXPECT_EQ(s.staged->problem(true), "");
    }
}

/// With a limit on vertices it matters who comes first: no zones.
TEST(RefineInZones, LimitedVerticesAreForOneThread) {
    MeshOptions options;
    options.size.edge_length = 0.02;
    options.limits.max_vertices = 60'000;
    StagedMesh staged(cube(), options);
    staged.conform();
    Workers workers(2);
    Refiner refiner(staged.mesh, staged.boundary, staged.guard, options, &workers);
    LatticeSeeder(staged.mesh, staged.boundary, staged.guard, refiner.sizes(), workers).seed();
    EXPECT_EQ(refiner.refine(), RunGuard::Verdict::out_of_vertices);
    EXPECT_LE(staged.mesh.vertex_count(), 60'000U);
}

/// Views of two zones, and a circumcentre inside of one to insert.
struct Views {
    Staged s{cube(), 40, 1};
    ZoneViews parts;
    std::vector<ConformingMesh> views;
    explicit Views(const ConformingMesh::ZoneRoom& room) {
        EXPECT_EQ(s.refiner->refine(), RunGuard::Verdict::go_on);
        std::vector<Vec3> sample;
        for (std::size_t v = 0; v < s.mesh().vertex_slots(); ++v) sample.push_back(s.mesh().point(VertexId{v}));
        views = s.mesh().split(*s.workers, Zones(sample, 2, 0), room, parts);
    }
    /// Inserts circumcentres in a zone, as many as it takes. @return how many it took
    std::size_t insert(std::size_t zone, std::size_t most) {
        ConformingMesh& view = views[zone];
        Triangulation& tri = view.triangulation();
        Cavity cavity;
        std::size_t count = 0;
        for (std::size_t i = 0; i < parts.zone_of_tet.size() && count < most; ++i) {
            const TetId t{i};
            if (parts.zone_of_tet[i] != zone || !view.tets().is_finite(t) || !view.in_domain(t)) continue;
            const auto& c = view.tets().corners(t);
            const Vec3 p = 0.25 * (view.point(c[0]) + view.point(c[1]) + view.point(c[2]) + view.point(c[3]));
            tri.forget_leaving();
            const Placement where = Placement::in_cell(view.cell(t));
            if (!tri.find_conflict_cavity(p, t, cavity)) continue;
            if (!view.may_insert(cavity, where)) {
                EXPECT_TRUE(tri.left_zone());
                continue;
            }
            (void)view.insert(cavity, where, {});
            ++count;
        }
        return count;
    }
};

TEST(Views, InsertUntilTheirRoomIsUsedUp) {
    Views v({1000, 5});
    EXPECT_EQ(v.insert(0, 100), 5U);  // vertices
    EXPECT_EQ(v.insert(1, 3), 3U);
    const std::size_t before = v.s.mesh().vertex_count();
    v.s.mesh().join(v.views);
    EXPECT_EQ(v.s.mesh().vertex_count(), before + 8);
    EXPECT_EQ(v.s.staged->problem(false), "");
}

TEST(Views, HaveNoRoomWithoutTetrahedra) {
    Views v({60, 100});
    const std::size_t count = v.insert(0, 100);
    EXPECT_GT(count, 0U);
    EXPECT_LT(count, 20U);
    v.s.mesh().join(v.views);
    EXPECT_EQ(v.s.staged->problem(false), "");
}

}  // namespace
}  // namespace wellmesh::testing
