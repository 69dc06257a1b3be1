// SPDX-License-Identifier: Apache-2.0
// How many tetrahedra a pass tries, and what it lists, where hardly a vertex can move: nearly all are the input's.
#include "shape/mending.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "conforming/savepoint.hpp"
#include "core/rng.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"

namespace wellmesh::testing {
namespace {

Plc cube_with_points(std::size_t points) {
    Plc plc = cube();
    for (std::size_t k = 0; k < points; ++k) {
        const auto in_the_middle = [&](std::uint64_t axis) { return 0.2 + 0.6 * static_cast<double>(mix64(k, axis) >> 11) * 0x1p-53; };
        plc.vertices.push_back({in_the_middle(0), in_the_middle(1), in_the_middle(2)});
    }
    return plc;
}

/// Every tetrahedron is bad: none has only angles above 89 degrees.
struct Immovable {
    StagedMesh staged{cube_with_points(700)};
    Refiner refiner{staged.mesh, staged.boundary, staged.guard, staged.options};
    TetJudge judge{staged.mesh, refiner.sizes(), refiner.max_radius_edge()};
    VertexMover mover{staged.mesh, staged.boundary, judge, 1};
    Mending mending{staged.mesh, judge, mover};
    std::size_t bad = 0;

    Immovable() {
        staged.conform();
        judge.set_goal(std::cos(89 * std::numbers::pi / 180), TetJudge::kNoAspect);
        mending.badness = [this](TetId t) { return judge.shape_badness(t); };
        mending.collect(staged.workers);
        bad = mending.left().size();
        EXPECT_EQ(bad, staged.domain_tets());
        EXPECT_GT(bad, 3500U);
    }
    [[nodiscard]] std::size_t most() const { return bad * 99 / 100; }
    /// @return how many were tried
    std::size_t pass(std::size_t one_is_mended_of) {
        std::size_t tried = 0;
        mending.last_resort = [&](const Bad&, const TetStore::Corners&) { return ++tried % one_is_mended_of == 0; };
        mending.begin_pass();
        EXPECT_TRUE(mending.pass(1, [](std::size_t) { return true; }));
        mending.end_pass();
        return tried;
    }
};

TEST(Mending, APassTriesAllAndListsWhatIsLeft) {
    Immovable m;
    EXPECT_GE(m.pass(1'000'000), m.most());
    EXPECT_GE(m.mending.left().size(), m.most());
    EXPECT_TRUE(m.mending.waiting().empty());
}

TEST(Mending, WhatIsMostlyStuckIsNotTriedForEver) {
    Immovable m;
    m.mending.is_mostly_stuck = [](TetId) { return true; };
    const std::size_t tried = m.pass(1'000'000);
    EXPECT_LT(tried, m.bad / 4);
    EXPECT_GT(tried, m.bad / 20) << "also at the end, where it may be better";
    EXPECT_GE(m.mending.left().size(), m.most()) << "nothing is lost by not being tried";
}

TEST(Mending, SuccessKeepsPatience) {
    Immovable m;
    m.mending.is_mostly_stuck = [](TetId) { return true; };
    EXPECT_GE(m.pass(15), m.most());
}

TEST(Mending, OthersAreTriedWhateverIsStuck) {
    Immovable m;
    std::size_t stuck = 0;
    const auto is_stuck = [](TetId t) { return t.value() % 4 != 0; };
    m.staged.for_domain([&](TetId t) { stuck += is_stuck(t) ? 1U : 0U; });
    m.mending.is_mostly_stuck = is_stuck;
    const std::size_t tried = m.pass(1'000'000);
    EXPECT_GE(tried, m.most() - stuck);
    EXPECT_LT(tried, m.bad - stuck + stuck / 4);
}

TEST(Mending, WhatIsTouchedAgainAndAgainIsListedOnce) {
    Immovable m;
    m.mending.is_mostly_stuck = [](TetId) { return true; };
    std::vector<TetId> all;
    m.staged.for_domain([&](TetId t) { all.push_back(t); });
    m.mending.touch(all);
    m.mending.touch(all);
    (void)m.pass(1'000'000);
    std::set<TetStore::Corners> listed;
    for (const Bad& b : m.mending.left()) {
        TetStore::Corners corners = b.corners;
        std::sort(corners.begin(), corners.end());
        EXPECT_TRUE(listed.insert(corners).second);
    }
    EXPECT_GE(listed.size(), m.most());
    // What is good by now goes.
    m.judge.set_goal(2, TetJudge::kNoAspect);
    m.mending.begin_pass();
    EXPECT_TRUE(m.mending.pass(1, [](std::size_t) { return true; }));
    m.mending.end_pass();
    EXPECT_TRUE(m.mending.left().empty());
}

/// A look at what was doubtful, or is new since, finds what a look at everything does: after moves, after vertices were taken out, and when all that is undone.
TEST(Mending, WhatIsCollectedAgainIsAllThatIsBad) {
    MeshOptions options;
    options.size.edge_length = 0.08;
    StagedMesh staged(cube(), options);
    staged.conform();
    Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
    ASSERT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
    TetJudge judge{staged.mesh, refiner.sizes(), refiner.max_radius_edge()};
    VertexMover mover{staged.mesh, staged.boundary, judge, 1};
    Mending mending{staged.mesh, judge, mover};
    judge.set_goal(std::cos(20 * std::numbers::pi / 180), TetJudge::kNoAspect);
    mending.badness = [&](TetId t) { return judge.shape_badness(t); };
    mending.collect(staged.workers);
    const std::size_t at_first = mending.left().size();
    ASSERT_GT(at_first, 100U);
    using Listed = std::vector<std::pair<std::uint32_t, double>>;
    const auto listed = [&] {
        Listed out;
        for (const Bad& b : mending.left()) out.emplace_back(b.last.value(), b.badness);
        return out;
    };
    const auto found_again = [&] {
        mending.collect_again(staged.workers);
        const Listed again = listed();
        Mending anew{staged.mesh, judge, mover};
        anew.badness = mending.badness;
        anew.collect(staged.workers);
        Listed all;
        for (const Bad& b : anew.left()) all.emplace_back(b.last.value(), b.badness);
        EXPECT_EQ(again, all);
        return again.size();
    };
    EXPECT_EQ(found_again(), at_first);
    std::set<TetStore::Corners> before_moves;
    for (const Bad& b : mending.left()) before_moves.insert(b.corners);
    std::size_t after_moves = 0;
    {
        Savepoint before(staged.mesh);
        for (std::uint64_t pass = 0; pass < 3; ++pass) {
            mending.begin_pass();
            ASSERT_TRUE(mending.pass(4, [](std::size_t) { return true; }));
            mending.end_pass();
            // Vertices at random, so that much is bad that was not.
            for (std::uint64_t k = 0; k < 40; ++k) {
                const auto in_the_middle = [&](std::uint64_t axis) { return 0.3 + 0.4 * unit_double(mix64(40 * pass + k, axis)); };
                Cavity cavity;
                ASSERT_TRUE(staged.mesh.triangulation().find_conflict_cavity({in_the_middle(0), in_the_middle(1), in_the_middle(2)}, staged.mesh.triangulation().tet_of(VertexId{0}), cavity));
                (void)staged.mesh.insert(cavity, Placement::in_cell(staged.mesh.cell(cavity.tets[0])), {});
                mending.touch(staged.mesh.triangulation().new_tets());
            }
            after_moves = found_again();
        }
        EXPECT_NE(after_moves, at_first);
        std::size_t new_ones = 0;
        for (const Bad& b : mending.left()) new_ones += before_moves.count(b.corners) == 0;
        EXPECT_GT(new_ones, 10U);
        before.go_back();
    }
    EXPECT_EQ(mending.collections(), 1U) << "who looked at all in between would know nothing of the mesh that is back";
    EXPECT_EQ(found_again(), at_first);
}

TEST(Mending, WhatWasTouchedIsCollectedOnce) {
    Immovable m;
    m.mending.left().clear();
    std::vector<TetId> some;
    m.staged.for_domain([&](TetId t) {
        if (t.value() % 3 == 0) some.push_back(t);
    });
    m.mending.touch(some);
    m.mending.touch(some);
    m.mending.collect_touched();
    std::set<TetStore::Corners> listed;
    for (const Bad& b : m.mending.left()) listed.insert(b.corners);
    EXPECT_EQ(listed.size(), some.size());
    EXPECT_EQ(m.mending.left().size(), some.size());
    EXPECT_TRUE(m.mending.waiting().empty());
}

}  // namespace
}  // namespace wellmesh::testing
