// SPDX-License-Identifier: Apache-2.0
// Laws of single moves, smoothings, removals and insertions, vertex by vertex on small refined meshes.
#include "shape/vertex_mover.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>

#include "conforming/place_point.hpp"
#include "carriers.hpp"
#include "shape/best_insertion.hpp"
#include "shape/thin_out.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"

namespace wellmesh::testing {
namespace {

struct Movable {
    StagedMesh staged;
    Refiner refiner;
    TetJudge judge;
    VertexMover mover;

    explicit Movable(const Plc& plc, const MeshOptions& options = {})
        : staged(plc, options),
          refiner(staged.mesh, staged.boundary, staged.guard, staged.options),
          judge(staged.mesh, refiner.sizes(), refiner.max_radius_edge()),
          mover(staged.mesh, staged.boundary, judge, 1) {
        staged.conform();
        EXPECT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
        judge.set_goal(std::cos(30 * std::numbers::pi / 180), TetJudge::kNoAspect);
    }

    /// Cell and labels of every tetrahedron, by its corners.
    [[nodiscard]] std::map<std::array<std::uint32_t, 4>, std::vector<std::uint32_t>> picture() const {
        const ConformingMesh& mesh = staged.mesh;
        std::map<std::array<std::uint32_t, 4>, std::vector<std::uint32_t>> out;
        for (std::size_t i = 0; i < mesh.tets().slots(); ++i) {
            const TetId t{i};
            if (!mesh.tets().is_finite(t)) continue;
            auto corners = mesh.tets().corners(t);
            std::sort(corners.begin(), corners.end());
            std::vector<std::uint32_t> about{mesh.cell(t).value()};
            for (const VertexId v : corners) about.push_back(mesh.facet_at(TetFace{t, mesh.tets().find_corner(t, v)}).value());
            for (std::size_t a = 0; a < 4; ++a)
                for (std::size_t b = a + 1; b < 4; ++b)
                    about.push_back(mesh.segment_at(t, kEdgeOf[mesh.tets().find_corner(t, corners[a])][mesh.tets().find_corner(t, corners[b])]).value());
            out[{corners[0].value(), corners[1].value(), corners[2].value(), corners[3].value()}] = about;
        }
        return out;
    }
    [[nodiscard]] double star_badness(VertexId v, TetId& worst) {
        std::vector<TetId> star;
        staged.mesh.triangulation().find_star(v, star);
        double badness = -1;
        for (const TetId t : star)
            if (judge.counts(t) && judge.shape_badness(t) > badness) {
                badness = judge.shape_badness(t);
                worst = t;
            }
        return badness;
    }
    [[nodiscard]] double changed_badness(const std::vector<TetId>& tets) const {
        double badness = -1;
        for (const TetId t : tets)
            if (judge.counts(t)) badness = std::max(badness, judge.badness(t));
        return badness;
    }
};

MeshOptions coarse() {
    MeshOptions options;
    options.size.edge_length = 0.4;
    return options;
}

class Moves : public ::testing::TestWithParam<std::tuple<std::size_t, bool>> {};

TEST_P(Moves, EachMakesItsStarBetterOrLeavesEverythingAsItWas) {
    const auto [domain, rotated] = GetParam();
    Movable m(transformed(all_synthetic_plcs()[domain].plc, rotated ? 3 : 0, 0, 1), coarse());
    ConformingMesh& mesh = m.staged.mesh;
    const std::size_t count = mesh.vertex_count();
    std::array<unsigned, 4> moved{};
    unsigned refused = 0;
    for (std::size_t i = 0; i < mesh.vertex_slots(); i += 2) {
        const VertexId v{i};
        TetId worst{};
        const double before = m.star_badness(v, worst);
        const Vec3 home = mesh.point(v);
        const bool look = i % 16 == 0;
        const auto picture = look ? m.picture() : decltype(m.picture()){};
        if (m.mover.move(v, worst, m.judge.goal(), 12)) {
            EXPECT_LT(m.changed_badness(m.mover.changed()), before);
            EXPECT_NE(mesh.point(v), home);
            EXPECT_NE(mesh.info(v).carrier, CarrierKind::input_vertex);
            ++moved[static_cast<std::size_t>(mesh.info(v).carrier)];
        } else {
            EXPECT_EQ(mesh.point(v), home);
            if (look) {
                EXPECT_EQ(m.picture(), picture);
                ++refused;
            }
        }
    }
    EXPECT_EQ(mesh.vertex_count(), count);
    EXPECT_EQ(m.staged.problem(true), "");
    EXPECT_GT(moved[static_cast<std::size_t>(CarrierKind::region)] + moved[static_cast<std::size_t>(CarrierKind::facet)], 3U);
    EXPECT_GT(refused, 0U);
}

TEST_P(Moves, SmoothingRespectsItsFloor) {
    const auto [domain, rotated] = GetParam();
    Movable m(transformed(all_synthetic_plcs()[domain].plc, rotated ? 3 : 0, 0, 1), coarse());
    ConformingMesh& mesh = m.staged.mesh;
    const double floor = std::cos(15 * std::numbers::pi / 180);
    unsigned smoothed = 0;
    for (std::size_t i = 0; i < mesh.vertex_slots(); ++i) {
        TetId worst{};
        const double before = m.star_badness(VertexId{i}, worst);
        if (!m.mover.smooth(VertexId{i}, floor)) continue;
        ++smoothed;
        EXPECT_LE(m.changed_badness(m.mover.changed()), std::max(before, floor));
    }
    EXPECT_GT(smoothed, mesh.vertex_count() / 10);
    EXPECT_EQ(m.staged.problem(true), "");
}

TEST_P(Moves, RemovalsKeepGoalAndConformity) {
    const auto [domain, rotated] = GetParam();
    Movable m(transformed(all_synthetic_plcs()[domain].plc, rotated ? 3 : 0, 0, 1));  // no size: coarser is allowed
    ConformingMesh& mesh = m.staged.mesh;
    const auto volumes = m.staged.cell_volumes();
    const double limit = std::cos(5 * std::numbers::pi / 180);
    const std::size_t count = mesh.vertex_count();
    std::size_t removed = 0;
    for (std::size_t i = 0; i < mesh.vertex_slots(); ++i) {
        TetId worst{};
        const double before = m.star_badness(VertexId{i}, worst);
        if (!m.mover.remove(VertexId{i}, limit)) continue;
        ++removed;
        EXPECT_FALSE(mesh.triangulation().is_inserted(VertexId{i}));
        EXPECT_LE(m.changed_badness(m.mover.changed()), std::max(limit, before));
    }
    EXPECT_EQ(mesh.vertex_count(), count - removed);
    EXPECT_EQ(m.staged.problem(true), "");
    for (const auto& [cell, volume] : volumes) EXPECT_NEAR(m.staged.cell_volumes().at(cell), volume, 1e-9 * volume);
}

TEST_P(Moves, InsertionsAreBetterThanAskedOrLeaveEverythingAsItWas) {
    const auto [domain, rotated] = GetParam();
    Movable m(transformed(all_synthetic_plcs()[domain].plc, rotated ? 3 : 0, 0, 1), coarse());
    ConformingMesh& mesh = m.staged.mesh;
    BestInsertion insertion(mesh, m.staged.boundary, m.judge, 1);
    std::array<unsigned, 4> inserted{};
    for (std::size_t i = 0; i < mesh.tets().slots() && insertion.count() < 40; i += 3) {
        const TetId t{i};
        if (!m.judge.counts(t)) continue;
        const double limit = std::max(m.judge.shape_badness(t), std::cos(10 * std::numbers::pi / 180));
        const std::size_t count = mesh.vertex_count();
        const VertexId v = insertion.insert(t, limit);
        EXPECT_EQ(mesh.vertex_count(), count + v.valid());
        if (!v.valid()) continue;
        ++inserted[static_cast<std::size_t>(mesh.info(v).carrier)];
        EXPECT_LE(m.changed_badness(insertion.changed()), limit);
    }
    EXPECT_EQ(m.staged.problem(true), "");
    EXPECT_GT(inserted[static_cast<std::size_t>(CarrierKind::region)], 0U);
}

TEST_P(Moves, ChainsAreUndoneExactly) {
    const auto [domain, rotated] = GetParam();
    Movable m(transformed(all_synthetic_plcs()[domain].plc, rotated ? 3 : 0, 0, 1), coarse());
    ConformingMesh& mesh = m.staged.mesh;
    const auto before = m.picture();
    std::size_t longest = 0;
    for (std::size_t first = 0; first < mesh.vertex_slots(); first += 17) {
        m.mover.log().begin();
        std::size_t steps = 0;
        for (std::size_t i = first; i < std::min(first + 24, mesh.vertex_slots()); ++i) {
            if (!mesh.triangulation().is_inserted(VertexId{i})) continue;
            TetId worst{};
            const double badness = m.star_badness(VertexId{i}, worst);
            if (i % 3 == 0) steps += m.mover.drop(VertexId{i});
            else if (i % 3 == 1) steps += m.mover.move(VertexId{i}, worst, std::min(m.judge.goal(), badness - 0.2), 10);
            else steps += m.mover.pull(VertexId{i}, mesh.point(VertexId{i - 1}), std::cos(1 * std::numbers::pi / 180));
        }
        longest = std::max(longest, steps);
        m.mover.log().undo(mesh);
        ASSERT_EQ(m.picture(), before) << first;
    }
    EXPECT_GT(longest, 3U);
    EXPECT_EQ(m.staged.problem(true), "");
}

/// Thins a mesh out as far as its worst angle allows. @param taken  how many vertices went, if there were enough to expect some
void thin_out(const Plc& plc, std::uint64_t seed, std::optional<std::size_t>& taken) {
    MeshOptions options;
    options.seed = seed;
    Movable m(plc, options);
    ConformingMesh& mesh = m.staged.mesh;
    const auto volumes = m.staged.cell_volumes();
    double worst = 0;
    for (std::size_t i = 0; i < mesh.tets().slots(); ++i)
        if (m.judge.counts(TetId{i})) worst = std::max(worst, m.judge.shape_badness(TetId{i}));
    m.judge.set_goal(worst, TetJudge::kNoAspect);
    const std::size_t count = mesh.vertex_count();
    Chains chains(mesh, m.staged.boundary, m.judge, m.mover, 1);
    Thinning thinning(mesh, m.staged.guard, chains);
    ASSERT_EQ(thinning.run(mesh.vertex_slots(), count), RunGuard::Verdict::go_on);
    EXPECT_EQ(mesh.vertex_count(), count) << "none is new, and there are not too many";
    const std::size_t enough = count - std::min<std::size_t>(count - mesh.plc().vertices.size(), 10) / 2;
    ASSERT_EQ(thinning.run(mesh.vertex_slots(), enough), RunGuard::Verdict::go_on);
    EXPECT_GE(mesh.vertex_count(), enough);
    ASSERT_EQ(thinning.run(0, enough), RunGuard::Verdict::go_on);
    if (count > mesh.plc().vertices.size() + 20) taken = count - mesh.vertex_count();
    for (std::size_t i = 0; i < mesh.tets().slots(); ++i) {
        if (!m.judge.counts(TetId{i})) continue;
        EXPECT_LE(m.judge.badness(TetId{i}), worst * (1 + 1e-12)) << "up to the rounding of another order of corners";
    }
    EXPECT_EQ(m.staged.problem(true), "");
    EXPECT_EQ(off_carrier(m.staged, 4), "");
    for (const auto& [cell, volume] : volumes) EXPECT_NEAR(m.staged.cell_volumes().at(cell), volume, 1e-9 * volume);
}

TEST_P(Moves, ThinningTakesVerticesOutAndKeepsTheGoal) {
    const auto [domain, rotated] = GetParam();
    const Plc plc = transformed(all_synthetic_plcs()[domain].plc, rotated ? 3 : 0, 0, 1);
    // How many can go is a matter of luck for one mesh.
    constexpr std::uint64_t kSeeds = 8;
    std::size_t taken = 0, cases = 0;
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
        std::optional<std::size_t> here;
        thin_out(plc, seed, here);
        taken += here.value_or(0);
        cases += here.has_value();
    }
    EXPECT_GE(taken, 6 * cases);
}

INSTANTIATE_TEST_SUITE_P(All, Moves, ::testing::Combine(::testing::Range<std::size_t>(0, 5), ::testing::Bool()));

/// The checks above would notice: moves that the mover must refuse, made by hand.
TEST(VertexMover, BrokenMovesAreCaught) {
    for (const bool lifted : {false, true}) {
        Movable m(transformed(cube(), 0, 0, 1), coarse());
        ConformingMesh& mesh = m.staged.mesh;
        ASSERT_EQ(m.staged.problem(true), "");
        bool caught = false;
        for (std::size_t i = 0; i < mesh.vertex_slots() && !caught; ++i) {
            const VertexId v{i};
            if (mesh.info(v).carrier != (lifted ? CarrierKind::facet : CarrierKind::region)) continue;
            // Off the facet by a tenth of the target edge; or towards the nearest facet, where the point encroaches.
            Vec3 p{};
            if (lifted) {
                p = mesh.point(v) + 0.04 * mesh.plc().facets[mesh.info(v).carrier_id].normal;
            } else {
                p = project_to_facet(mesh.plc().facets[0], mesh.point(v));
                p = p + 1e-3 * (mesh.point(v) - p);
            }
            Hole hole;
            Cavity cavity;
            ASSERT_TRUE(mesh.triangulation().find_hole(v, hole));
            if (!mesh.remove(hole)) continue;
            ASSERT_TRUE(mesh.triangulation().find_conflict_cavity(p, mesh.triangulation().new_tets()[0], cavity));
            const Placement where = lifted ? Placement::on_facet(FacetId{mesh.info(v).carrier_id}) : Placement::in_cell(CellId{mesh.info(v).carrier_id});
            mesh.reinsert(v, cavity, where);
            caught = lifted ? off_carrier(m.staged, 4) != "" : m.staged.problem(true) != "";
            break;
        }
        EXPECT_TRUE(caught) << lifted;
    }
}

TEST(TetJudge, AgreesWithTheMeasuresOfAllShapes) {
    Movable m(transformed(l_block(), 4, 0, 1), coarse());
    const double goal = std::cos(30 * std::numbers::pi / 180);
    m.judge.set_goal(goal, 8);
    unsigned thin = 0, pointed = 0, good = 0;
    m.staged.for_domain([&](TetId t) {
        const TetShape s = m.staged.shape(t);
        if (std::abs(s.aspect - 8) < 1e-9 || std::abs(s.min_dihedral_deg - 30) < 1e-9) return;
        const bool bad = s.aspect > 8 || s.min_dihedral_deg < 30;
        EXPECT_EQ(m.judge.shape_badness(t) > goal, bad);
        EXPECT_EQ(m.judge.badness(t) > goal, bad || s.radius_edge > 2);
        (s.min_dihedral_deg < 30 ? thin : s.aspect > 8 ? pointed : good) += 1;
    });
    EXPECT_GT(thin, 0U);
    EXPECT_GT(good, 0U);
    // A needle with fair dihedral angles: the aspect ratio alone condemns it.
    const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0.5, 0.866, 0}, d{0.5, 0.2887, 6};
    ASSERT_GT(min_dihedral_deg(a, b, c, d), 30);
    Movable free(transformed(cube(), 0, 0, 1));
    TetJudge lax(free.staged.mesh, free.refiner.sizes(), 100);
    EXPECT_LT(lax.badness(a, b, c, d, CellId{1}), goal);
    lax.set_goal(goal, 8);
    EXPECT_GT(lax.badness(a, b, c, d, CellId{1}), goal);
    EXPECT_EQ(lax.badness(a, c, b, d, CellId{1}), kNoAngleCosine);
}

}  // namespace
}  // namespace wellmesh::testing
