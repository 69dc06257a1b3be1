// SPDX-License-Identifier: Apache-2.0
// A mesh that went back to a savepoint is the one that was there, and behaves like it.
#include "conforming/savepoint.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "support/acute_plcs.hpp"
#include "support/mesh_difference.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"
#include "workshop.hpp"
#include "wellmesh/error.hpp"

namespace wellmesh::testing {
namespace {

struct Refined {
    StagedMesh staged;
    Refiner refiner;

    Refined(const Plc& plc, double edge)
        : staged(plc, with_edge(edge * diagonal(plc))), refiner((staged.conform(), staged.mesh), staged.boundary, staged.guard, staged.options) {
        EXPECT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
        EXPECT_EQ(staged.problem(true), "");
    }
    static MeshOptions with_edge(double edge_length) {
        MeshOptions options;
        options.size.edge_length = edge_length;
        return options;
    }
};

/// Vertices come, go and move, all kinds of them. @return how many did
std::size_t work(StagedMesh& staged, std::uint64_t seed, std::size_t steps) {
    ConformingMesh& mesh = staged.mesh;
    Workshop workshop(staged, seed);
    Spot spot;
    Cavity cavity;
    Hole hole;
    ConformingMesh::Snapshot star;
    std::size_t changes = 0;
    for (std::size_t step = 0; step < steps; ++step) {
        const CarrierKind kind = kKinds[workshop.below(3)];
        if (workshop.below(2) == 0) {
            if (!workshop.find(kind, spot, cavity)) continue;
            (void)workshop.insert(spot, cavity);
            ++changes;
            continue;
        }
        const VertexId v = workshop.steiner_vertex(kind);
        Placement where;
        if (!v.valid() || !mesh.triangulation().find_hole(v, hole) || !workshop.placement_of(v, hole.star, where)) continue;
        mesh.save(hole.star, star);
        if (!mesh.remove(hole)) continue;
        ++changes;
        if (workshop.below(3) == 0) continue;
        const Vec3 near = mesh.point(v) + 0.01 * Vec3{1, -0.5, 0.25};
        const bool fits = kind == CarrierKind::region && mesh.triangulation().find_conflict_cavity(near, mesh.triangulation().new_tets()[0], cavity) &&
                          mesh.cell(cavity.tets[0]).value() == where.carrier_id && !mesh.would_break(cavity, where);
        if (fits) mesh.reinsert(v, cavity, where);
        else mesh.undo_removal(v, where, star);
    }
    return changes;
}

class SavepointOf : public ::testing::TestWithParam<std::tuple<std::size_t, std::uint64_t>> {
protected:
    static Plc plc() { return transformed(all_synthetic_plcs()[std::get<0>(GetParam())].plc, std::get<1>(GetParam()), 0, 1); }
};

TEST_P(SavepointOf, BringsTheVeryMeshBackAndWhatFollowsIsTheSame) {
    Refined a(plc(), 0.15), b(plc(), 0.15);
    ASSERT_EQ(difference(a.staged.mesh, b.staged.mesh), "");
    {
        Savepoint savepoint(a.staged.mesh);
        for (std::uint64_t turn = 0; turn < 3; ++turn) {
            ASSERT_GT(work(a.staged, 17 + turn, 150), 30U);
            ASSERT_NE(difference(a.staged.mesh, b.staged.mesh), "");
            savepoint.go_back();
            ASSERT_EQ(difference(a.staged.mesh, b.staged.mesh), "") << "turn " << turn;
            ASSERT_EQ(a.staged.problem(true), "");
        }
    }
    EXPECT_EQ(a.staged.mesh.savepoints(), 0U);
    EXPECT_EQ(work(a.staged, 5, 200), work(b.staged, 5, 200));
    EXPECT_EQ(difference(a.staged.mesh, b.staged.mesh), "");
    EXPECT_EQ(a.staged.problem(false), "");
}

TEST_P(SavepointOf, Nests) {
    Refined a(plc(), 0.15);
    ConformingMesh& mesh = a.staged.mesh;
    const ConformingMesh first = mesh;
    Savepoint outer(mesh);
    ASSERT_GT(work(a.staged, 3, 60), 10U);
    const ConformingMesh second = mesh;
    {
        Savepoint inner(mesh);
        EXPECT_THROW(outer.go_back(), MeshError);
        ASSERT_GT(work(a.staged, 4, 60), 10U);
        inner.go_back();
        ASSERT_EQ(difference(mesh, second), "");
        ASSERT_GT(work(a.staged, 5, 60), 10U);
    }
    // What the inner one has kept, the outer one has now.
    const ConformingMesh third = mesh;
    {
        Savepoint inner(mesh);
        ASSERT_GT(work(a.staged, 6, 60), 10U);
        inner.go_back();
    }
    ASSERT_EQ(difference(mesh, third), "");
    outer.go_back();
    EXPECT_EQ(difference(mesh, first), "");
    EXPECT_EQ(a.staged.problem(true), "");
}

INSTANTIATE_TEST_SUITE_P(Domains, SavepointOf, ::testing::Combine(::testing::Range<std::size_t>(0, 5), ::testing::Values(0U, 4U)));

/// Splits with all that they set off: surfaces are broken and healed, cells forgotten and found again.
TEST(Savepoint, UndoesCascades) {
    for (const Plc& plc : {cube_with_internal_facet(), wedge(40), wedge(15)}) {
        Refined a(plc, 0.1);
        ConformingMesh& mesh = a.staged.mesh;
        const ConformingMesh before = mesh;
        Savepoint savepoint(mesh);
        for (unsigned turn = 0; turn < 2; ++turn) {
            for (std::size_t i = turn; i < before.tets().slots(); i += 3)
                if (mesh.tets().is_finite(TetId{i}) && mesh.in_domain(TetId{i})) (void)a.refiner.split(TetId{i}, InsertionReason::sliver);
            ASSERT_GT(mesh.vertex_count(), before.vertex_count() + 20);
            savepoint.go_back();
            a.refiner.forget_waiting();
            ASSERT_EQ(difference(mesh, before), "");
        }
        EXPECT_EQ(a.staged.problem(true), "");
    }
}

/// Views keep what they change, too.
TEST(Savepoint, UndoesRefinementInZones) {
    const Plc plc = cube();
    StagedMesh staged(plc, Refined::with_edge(diagonal(plc) / 26)), other(plc, staged.options);
    for (StagedMesh* s : {&staged, &other}) {
        s->conform();
        EXPECT_EQ(Refiner(s->mesh, s->boundary, s->guard, s->options).refine(), RunGuard::Verdict::go_on);
    }
    MeshOptions finer = staged.options;
    finer.size.edge_length = diagonal(plc) / 36;
    Workers workers(2);
    {
        Savepoint savepoint(staged.mesh);
        EXPECT_EQ(Refiner(staged.mesh, staged.boundary, staged.guard, finer, &workers).refine(), RunGuard::Verdict::go_on);
        EXPECT_GT(staged.mesh.vertex_count(), 2 * other.mesh.vertex_count());
        EXPECT_GT(staged.mesh.vertex_slots(), staged.mesh.vertex_count());  // zones left some that they did not need
        savepoint.go_back();
    }
    ASSERT_EQ(difference(staged.mesh, other.mesh), "");
    for (StagedMesh* s : {&staged, &other}) EXPECT_EQ(Refiner(s->mesh, s->boundary, s->guard, finer, &workers).refine(), RunGuard::Verdict::go_on);
    EXPECT_EQ(difference(staged.mesh, other.mesh), "");
    EXPECT_EQ(staged.problem(true), "");
}

}  // namespace
}  // namespace wellmesh::testing
