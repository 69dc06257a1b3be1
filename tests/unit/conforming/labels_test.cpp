// SPDX-License-Identifier: Apache-2.0
// Insertions, removals and their inverses in a labelled mesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "conforming/place_point.hpp"
#include "core/rng.hpp"
#include "support/acute_plcs.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"
#include "workshop.hpp"

namespace wellmesh::testing {
namespace {

/// Everything that the mesh says, without ids of tetrahedra.
struct State {
    std::set<std::pair<std::array<VertexId, 4>, CellId>> tets;
    std::set<std::tuple<std::array<VertexId, 4>, std::array<VertexId, 3>, FacetId>> faces;
    std::set<std::tuple<std::array<VertexId, 4>, std::array<VertexId, 2>, SegmentId>> edges;
    std::size_t vertices = 0;
    friend bool operator==(const State&, const State&) = default;
};

template <std::size_t n>
std::array<VertexId, n> sorted(std::array<VertexId, n> c) {
    std::sort(c.begin(), c.end());
    return c;
}

State state_of(const ConformingMesh& mesh) {
    State s;
    s.vertices = mesh.vertex_count();
    const TetStore& tets = mesh.tets();
    for (std::size_t i = 0; i < tets.slots(); ++i) {
        const TetId t{i};
        if (!tets.is_live(t)) continue;
        const auto& c = tets.corners(t);
        s.tets.insert({sorted(c), mesh.cell(t)});
        for (unsigned f = 0; f < 4; ++f)
            if (const FacetId label = mesh.facet_at(TetFace{t, f}); label.valid()) s.faces.insert({sorted(c), sorted(tets.face_corners(TetFace{t, f})), label});
        for (unsigned e = 0; e < 6; ++e)
            if (const SegmentId label = mesh.segment_at(t, e); label.valid())
                s.edges.insert({sorted(c), sorted(std::array{c[kEdgeCorners[e][0]], c[kEdgeCorners[e][1]]}), label});
    }
    return s;
}

bool lies_between_ends(const ConformingMesh& mesh, const Placement& where, const Vec3& p) {
    if (where.carrier != CarrierKind::segment) return true;
    const Vec3 &a = mesh.point(where.a), &b = mesh.point(where.b);
    return dot(p - a, b - a) > 0 && dot(p - b, a - b) > 0;
}

/// Fine enough that many places encroach nothing.
class Labels : public ::testing::TestWithParam<std::tuple<std::size_t, std::uint64_t, double>> {
protected:
    void SetUp() override {
        const auto [domain, rotation, shift] = GetParam();
        const Plc plc = all_synthetic_plcs()[domain].plc;
        MeshOptions options;
        options.size.edge_length = 0.15 * diagonal(plc);
        staged_.emplace(transformed(plc, rotation, shift, 1), options);
        staged_->conform();
        refiner_.emplace(staged_->mesh, staged_->boundary, staged_->guard, options);
        ASSERT_EQ(refiner_->refine(), RunGuard::Verdict::go_on);
        ASSERT_EQ(staged_->problem(true), "");
    }

    std::optional<StagedMesh> staged_;
    std::optional<Refiner> refiner_;
};

TEST_P(Labels, SurviveInsertionsAndRemovals) {
    StagedMesh& staged = *staged_;
    Workshop workshop(staged, 17);
    Spot spot;
    Cavity cavity;
    Hole hole;
    std::array<std::size_t, 3> inserted{}, removed{}, refused{};
    for (std::size_t step = 0; step < 400; ++step) {
        const std::size_t k = workshop.below(3);
        // The mesh grows first and shrinks then.
        if (workshop.below(400) >= step) {
            if (!workshop.find(kKinds[k], spot, cavity)) continue;
            const VertexId v = workshop.insert(spot, cavity);
            ASSERT_EQ(staged.mesh.point(v), spot.point);
            ++inserted[k];
        } else {
            const VertexId v = workshop.steiner_vertex(kKinds[k]);
            if (!v.valid() || !staged.mesh.triangulation().find_hole(v, hole)) continue;
            const std::size_t before = staged.mesh.vertex_count();
            const bool gone = staged.mesh.remove(hole);
            ASSERT_EQ(staged.mesh.triangulation().is_inserted(v), !gone);
            ASSERT_EQ(staged.mesh.vertex_count() + gone, before);
            ++(gone ? removed : refused)[k];
        }
        ASSERT_FALSE(staged.mesh.has_broken());
        if (step % 10 == 0) { ASSERT_EQ(staged.problem(false), "") << "step " << step; }
    }
    EXPECT_EQ(staged.problem(false), "");
    for (std::size_t k = 0; k < 3; ++k) EXPECT_GT(inserted[k], 5U) << k;
    for (std::size_t k = 0; k < 3; ++k) EXPECT_GT(removed[k], 5U) << k << ", refused " << refused[k];
    EXPECT_GT(removed[2], refused[2]);
}

TEST_P(Labels, UndoneInsertionsLeaveNoTrace) {
    StagedMesh& staged = *staged_;
    Workshop workshop(staged, 23);
    Spot spot;
    Cavity cavity;
    ConformingMesh::Snapshot snapshot;
    std::array<std::size_t, 3> undone{};
    for (std::size_t step = 0; step < 90; ++step) {
        const std::size_t k = step % 3;
        if (!workshop.find(kKinds[k], spot, cavity)) continue;
        if (step % 2 != 0) {  // every second one stays: undo in growing meshes
            workshop.insert(spot, cavity);
            continue;
        }
        const State before = state_of(staged.mesh);
        staged.mesh.save(cavity.tets, snapshot);
        const VertexId v = workshop.insert(spot, cavity);
        ASSERT_FALSE(state_of(staged.mesh) == before);
        staged.mesh.undo_insertion(v, spot.where, snapshot);
        ASSERT_TRUE(state_of(staged.mesh) == before) << "step " << step;
        ++undone[k];
    }
    EXPECT_EQ(staged.problem(false), "");
    for (const std::size_t n : undone) EXPECT_GT(n, 2U);
}

TEST_P(Labels, UndoneRemovalsLeaveNoTrace) {
    StagedMesh& staged = *staged_;
    Workshop workshop(staged, 29);
    Spot spot;
    Cavity cavity;
    Hole hole;
    ConformingMesh::Snapshot snapshot;
    for (std::size_t i = 0; i < 60; ++i)
        if (workshop.find(kKinds[i % 3], spot, cavity)) workshop.insert(spot, cavity);
    std::array<std::size_t, 3> undone{};
    for (std::size_t step = 0; step < 90; ++step) {
        const std::size_t k = step % 3;
        const VertexId v = workshop.steiner_vertex(kKinds[k]);
        if (!v.valid() || !staged.mesh.triangulation().find_hole(v, hole)) continue;
        Placement where;
        ASSERT_TRUE(workshop.placement_of(v, hole.star, where));
        const State before = state_of(staged.mesh);
        staged.mesh.save(hole.star, snapshot);
        if (!staged.mesh.remove(hole)) {
            ASSERT_TRUE(state_of(staged.mesh) == before) << "a refused removal changed something";
            continue;
        }
        ASSERT_EQ(staged.problem(false), "");
        staged.mesh.undo_removal(v, where, snapshot);
        ASSERT_TRUE(state_of(staged.mesh) == before) << "step " << step;
        ++undone[k];
    }
    EXPECT_EQ(staged.problem(false), "");
    for (const std::size_t n : undone) EXPECT_GT(n, 2U);
}

TEST_P(Labels, ReinsertionElsewhereOnTheCarrierKeepsThem) {
    StagedMesh& staged = *staged_;
    Workshop workshop(staged, 31);
    Spot spot;
    Cavity cavity;
    Hole hole;
    for (std::size_t i = 0; i < 60; ++i)
        if (workshop.find(kKinds[i % 3], spot, cavity)) workshop.insert(spot, cavity);
    ConformingMesh& mesh = staged.mesh;
    ConformingMesh::Snapshot snapshot;
    std::size_t moved = 0;
    for (std::size_t step = 0; step < 120; ++step) {
        const VertexId v = workshop.steiner_vertex(kKinds[step % 3]);
        if (!v.valid() || !mesh.triangulation().find_hole(v, hole)) continue;
        Placement where;
        ASSERT_TRUE(workshop.placement_of(v, hole.star, where));
        mesh.save(hole.star, snapshot);
        if (!mesh.remove(hole)) continue;
        const Vec3 home = mesh.point(v), wanted = home + 0.05 * Vec3{1, -0.5, 0.25};
        const Vec3 p = where.carrier == CarrierKind::segment  ? project_to_segment(staged.plc, SegmentId{where.carrier_id}, wanted)
                       : where.carrier == CarrierKind::facet ? project_to_facet(staged.plc.facets[where.carrier_id], wanted)
                                                             : wanted;
        const bool legal = mesh.triangulation().find_conflict_cavity(p, mesh.triangulation().new_tets()[0], cavity) &&
                           (where.carrier != CarrierKind::region || mesh.cell(cavity.tets[0]).value() == where.carrier_id) && mesh.holds_carrier(cavity, where) &&
                           !mesh.would_break(cavity, where) && lies_between_ends(mesh, where, p);
        if (legal) {
            mesh.reinsert(v, cavity, where);
            ++moved;
        } else {
            mesh.undo_removal(v, where, snapshot);
        }
        ASSERT_EQ(staged.problem(false), "") << "step " << step;
    }
    EXPECT_GT(moved, 10U);
}

INSTANTIATE_TEST_SUITE_P(Domains, Labels, ::testing::Combine(::testing::Range<std::size_t>(0, 5), ::testing::Values(0U, 4U), ::testing::Values(0.0, 1e3)));

/// More facets at a vertex than a word has bits.
TEST(FanOfSeventyOne, LosesVerticesOfItsSegmentWithoutATrace) {
    StagedMesh staged(fan(71));
    staged.conform();
    ConformingMesh& mesh = staged.mesh;
    Workshop workshop(staged, 37);
    const auto& segments = staged.plc.segments;
    const auto axis = std::find_if(segments.begin(), segments.end(), [](const auto& s) { return s.facets.size() == 71; });
    ASSERT_NE(axis, segments.end());
    const SegmentId id{static_cast<std::size_t>(axis - segments.begin())};
    Cavity cavity;
    Hole hole;
    std::size_t removed = 0;
    for (std::size_t i = 1; i < mesh.chain_of(id).size(); i += 2) {
        const VertexId a = mesh.chain_of(id)[i - 1], b = mesh.chain_of(id)[i];
        const Vec3 middle = project_to_segment(staged.plc, id, 0.5 * (mesh.point(a) + mesh.point(b)));
        const Spot spot{middle, mesh.triangulation().tet_of(a), Placement::on_segment({a, b, id})};
        const State before = state_of(mesh);
        ASSERT_TRUE(mesh.triangulation().find_conflict_cavity(spot.point, spot.near, cavity));
        if (mesh.would_break(cavity, spot.where)) continue;
        const VertexId v = workshop.insert(spot, cavity);
        ASSERT_EQ(staged.problem(false), "");
        ASSERT_TRUE(mesh.triangulation().find_hole(v, hole));
        ASSERT_TRUE(mesh.remove(hole));
        ASSERT_TRUE(state_of(mesh) == before);
        ++removed;
    }
    EXPECT_GT(removed, 0U);
}

TEST(FindSubface, SaysTheSameWhateverIsSuggested) {
    StagedMesh staged(all_synthetic_plcs().front().plc);
    staged.conform();
    ConformingMesh& mesh = staged.mesh;
    std::vector<Subface> listed;
    const auto list = [&] {
        listed.clear();
        staged.for_domain([&](TetId t) {
            for (unsigned f = 0; f < 4; ++f)
                if (const FacetId facet = mesh.facet_at(TetFace{t, f}); facet.valid()) listed.push_back({mesh.tets().face_corners(TetFace{t, f}), facet, t});
        });
    };
    const auto check = [&] {
        for (const Subface& s : listed) {
            const bool is_there = mesh.find_subface({s.corners, s.facet}).valid();
            std::vector<TetId> suggestions{s.near};
            for (std::size_t i = 0; i < mesh.tets().slots(); ++i) suggestions.emplace_back(i);  // free ones, ghosts, and those that are others by now
            for (const TetId t : suggestions) {
                const TetFace found = mesh.find_subface({s.corners, s.facet, t});
                ASSERT_EQ(found.valid(), is_there);
                if (!is_there) continue;
                auto got = mesh.tets().face_corners(found), wanted = s.corners;
                std::sort(got.begin(), got.end());
                std::sort(wanted.begin(), wanted.end());
                EXPECT_EQ(got, wanted);
                EXPECT_EQ(mesh.facet_at(found), s.facet);
            }
        }
    };
    list();
    check();
    std::size_t gone = 0;
    for (std::size_t k = 0; k < listed.size(); k += 3) (void)staged.boundary.split(listed[k], {InsertionReason::boundary_by_size, VertexId{}});
    staged.boundary.conform();
    for (const Subface& s : listed) gone += !mesh.find_subface(s).valid();
    EXPECT_GT(gone, 0U);
    check();
}

}  // namespace
}  // namespace wellmesh::testing
