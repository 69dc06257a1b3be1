// SPDX-License-Identifier: Apache-2.0
// Boundary splitting, seeding and refinement in zones: the same mesh for any number of threads, and whatever ends a run ends it there, too.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <vector>

#include "core/vec3_math.hpp"
#include "delaunay/zones.hpp"
#include "refinement/lattice_seeding.hpp"
#include "refinement/refine.hpp"
#include "support/acute_plcs.hpp"
#include "support/any_threads.hpp"
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
    /// Vertices that were put aside for zones and not needed: nothing else leaves any where none is taken out and nothing was seeded.
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

/// Into how many zones refinement will cut the mesh first.
std::size_t zones_for(const ConformingMesh& mesh, const Refiner& refiner) {
    constexpr std::size_t kLeastAZone = 256;
    std::size_t waiting = 0;
    double badness = 0;
    for (std::size_t t = 0; t < mesh.tets().slots(); ++t)
        waiting += mesh.tets().is_finite(TetId{t}) && mesh.in_domain(TetId{t}) && refiner.classify(TetId{t}, badness) != Refiner::Fault::none;
    return Zones::worth(mesh.tets().live(), waiting, kLeastAZone, 0);
}

Outcome seeded_and_refined(const Plc& plc, double edges_per_diagonal, unsigned threads) {
    const Staged s(plc, edges_per_diagonal, threads);
    const auto volumes = s.staged->cell_volumes();
    LatticeSeeder(s.mesh(), s.staged->boundary, s.staged->guard, s.refiner->sizes(), *s.workers).seed();
    EXPECT_TRUE(s.staged->boundary.idle());
    if (!kSanitized) { EXPECT_EQ(s.staged->problem(true), ""); }
    EXPECT_GE(zones_for(s.mesh(), *s.refiner), 2U);
    EXPECT_EQ(s.refiner->refine(), RunGuard::Verdict::go_on);
    EXPECT_EQ(s.staged->problem(true), "");
    for (const auto& [cell, volume] : s.staged->cell_volumes()) EXPECT_NEAR(volume, volumes.at(cell), 1e-9);
    s.staged->for_domain([&](TetId t) {
        double badness = 0;
        EXPECT_TRUE(s.refiner->classify(t, badness) == Refiner::Fault::none || s.refiner->forced_by(t).has_value());
    });
    return outcome_of(s.mesh());
}

TEST(RefineInZones, TheSameMeshForAnyNumberOfThreads) {
    for (const NamedPlc& named : all_synthetic_plcs()) {
        if (kSanitized && named.name != "two_regions" && named.name != "shaft") continue;
        SCOPED_TRACE(named.name);
        const Plc plc = transformed(named.plc, 3, 0, 1);
        same_for_any_threads([&](unsigned threads) { return seeded_and_refined(plc, kSanitized ? 50 : 70, threads); }, {1, 2, 3});
    }
}

/// The boundary, of which this has much, is split in zones as well before it is seeded.
TEST(RefineInZones, TheSameMeshBesideAnAcuteAngle) {
    same_for_any_threads([](unsigned threads) { return seeded_and_refined(wedge(40), kSanitized ? 70 : 90, threads); }, {1, 3});
}

/// A cube that was refined, and what refines it once more, finer: enough of it waits for zones then.
struct Finer {
    Staged s{cube(), kSanitized ? 26.0 : 40.0, 1};
    Workers workers;
    std::unique_ptr<Refiner> refiner;

    explicit Finer(unsigned threads) : workers(threads) {
        EXPECT_EQ(s.refiner->refine(), RunGuard::Verdict::go_on);
        MeshOptions options = s.staged->options;
        options.size.edge_length = 0.7 * *options.size.edge_length;
        refiner = std::make_unique<Refiner>(s.mesh(), s.staged->boundary, s.staged->guard, options, &workers);
        EXPECT_GE(zones_for(s.mesh(), *refiner), 2U);
    }
};

/// Without a lattice nearly all is left to refinement.
TEST(RefineInZones, TheSameMeshWithoutSeeds) {
    same_for_any_threads(
        [](unsigned threads) {
            const Finer f(threads);
            EXPECT_EQ(f.refiner->refine(), RunGuard::Verdict::go_on);
            EXPECT_GT(f.s.spare(), 0U);
            EXPECT_GT(f.refiner->statistics().insertions, 5000U);
            EXPECT_EQ(f.s.staged->problem(true), "");
            return outcome_of(f.s.mesh());
        },
        {1, 3});
}

TEST(RefineInZones, TimeEndsItWithAMeshThatConforms) {
    for (const unsigned threads : kSanitized ? std::vector{2U} : std::vector{1U, 2U}) {
        const Finer f(threads);
        StagedMesh& staged = *f.s.staged;
        int looks = 0;
        staged.control.clock = [&] { return std::chrono::steady_clock::time_point(std::chrono::hours(++looks > 5 ? 1000000 : 0)); };
        Limits limits;
        limits.time = std::chrono::milliseconds(1000);
        staged.guard = RunGuard(limits, staged.control);
        staged.guard.set_conforming();
        EXPECT_EQ(f.refiner->refine(), RunGuard::Verdict::out_of_time);
        EXPECT_GT(f.refiner->statistics().insertions, 0U);
        EXPECT_LT(f.refiner->statistics().insertions, 5000U);  // zones do not go on to their end
        EXPECT_TRUE(staged.boundary.idle());
        EXPECT_EQ(staged.problem(true), "");
    }
}

/// With a limit on vertices it matters who comes first: no zones.
TEST(RefineInZones, LimitedVerticesAreForOneThread) {
    MeshOptions options;
    const std::uint64_t most = kSanitized ? 18'000 : 60'000;
    options.size.edge_length = kSanitized ? 0.03 : 0.02;
    options.limits.max_vertices = most;
    StagedMesh staged(cube(), options);
    staged.conform();
    Workers workers(2);
    Refiner refiner(staged.mesh, staged.boundary, staged.guard, options, &workers);
    LatticeSeeder(staged.mesh, staged.boundary, staged.guard, refiner.sizes(), workers).seed();
    EXPECT_EQ(refiner.refine(), RunGuard::Verdict::out_of_vertices);
    EXPECT_LE(staged.mesh.vertex_count(), most);
}

/// Views of two zones, and a circumcentre inside of one to insert.
struct Views {
    Staged s;
    ZoneViews parts;
    std::vector<ConformingMesh> views;
    explicit Views(const ConformingMesh::ZoneRoom& room, const Plc& plc = cube()) : s(plc, kSanitized ? 20.0 : 40.0, 1) {
        EXPECT_EQ(s.refiner->refine(), RunGuard::Verdict::go_on);
        std::vector<Vec3> sample;
        for (std::size_t v = 0; v < s.mesh().vertex_slots(); ++v) sample.push_back(s.mesh().point(VertexId{v}));
        views = s.mesh().split(*s.workers, Zones(sample, 2, 1), room, parts);  // oblique: no facet is between them
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

/// The cavities of points just beside the facet between two cells reach through it.
TEST(Views, LeaveWhatWouldBreakTheBoundary) {
    Views v({1000, 100}, cube_with_internal_facet());
    std::size_t refused = 0;
    for (std::size_t i = 0; i < v.parts.zone_of_tet.size(); ++i) {
        const TetId t{i};
        if (v.parts.zone_of_tet[i] == ZoneViews::kNone) continue;
        ConformingMesh& view = v.views[v.parts.zone_of_tet[i]];
        if (!view.tets().is_finite(t) || !view.in_domain(t) || !view.has_labels(t)) continue;
        for (unsigned f = 0; f < 4; ++f) {
            if (!view.labels(t).facets[f].valid()) continue;
            const auto c = view.tets().face_corners(TetFace{t, f});
            const Vec3 centre = (1.0 / 3) * (view.point(c[0]) + view.point(c[1]) + view.point(c[2]));
            Triangulation& tri = view.triangulation();
            tri.forget_leaving();
            Cavity cavity;
            if (!tri.find_conflict_cavity(centre + 0.01 * (view.point(view.tets().corner(t, f)) - centre), t, cavity) || tri.left_zone()) continue;
            if (std::none_of(cavity.tets.begin(), cavity.tets.end(), [&](TetId u) { return view.in_domain(u) && view.cell(u) != view.cell(t); })) continue;
            EXPECT_FALSE(view.may_insert(cavity, Placement::in_cell(view.cell(t))));
            EXPECT_TRUE(tri.left_zone());
            ++refused;
        }
    }
    EXPECT_GT(refused, 20U);
    v.s.mesh().join(v.views);
    EXPECT_EQ(v.s.staged->problem(false), "");
}

}  // namespace
}  // namespace wellmesh::testing
