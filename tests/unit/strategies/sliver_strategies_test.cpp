// SPDX-License-Identifier: Apache-2.0
#include "strategies/sliver_strategies.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "support/acute_plcs.hpp"
#include "support/expect_result.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh::testing {
namespace {

bool same(const TetMesh& a, const TetMesh& b) {
    return a.vertices == b.vertices && a.tets == b.tets && a.tet_regions == b.tet_regions && a.subfaces == b.subfaces && a.subsegments == b.subsegments;
}

Plc rotated_l_block() { return transformed(l_block(), 3, 0, 1); }

/// About 1500 tetrahedra of a cube, 1000 of an L-block.
MeshOptions with(SliverStrategy strategy, double angle, double edge_length = 0.2) {
    MeshOptions options;
    options.slivers = strategy;
    options.size.edge_length = edge_length;
    options.quality.min_dihedral_angle_deg = angle;
    return options;
}

const std::vector<SliverStrategy> kHere{SliverStrategy::none, SliverStrategy::refine, SliverStrategy::improve, SliverStrategy::chew, SliverStrategy::perturb, SliverStrategy::best};

/// Everything but the goals is proven, and every goal that is missed is listed.
void expect_honest(const MeshResult& result) {
    expect_valid(result);
    bool missed = false;
    for (const AskedAchieved& goal : result.goals) {
        EXPECT_EQ(goal.met, goal.elements_missed == 0) << goal.goal;
        missed |= !goal.met;
    }
    EXPECT_EQ(result.termination, missed ? Termination::goals_unmet : Termination::goals_met);
}

double volume_per_region(const MeshResult& result) { return result.certificate.regions.at(0).volume; }

TEST(SliverStrategies, MeshIsProvenWhateverTheStrategyAndAlwaysTheSame) {
    const std::vector<std::pair<Plc, double>> domains{{cube(), 1.0}, {rotated_l_block(), 3.0}};
    for (const auto& [plc, volume] : domains)
        for (const SliverStrategy strategy : kHere) {
            SCOPED_TRACE(to_string(strategy));
            const MeshOptions options = with(strategy, 15, 0.2 * std::cbrt(volume));
            const MeshResult result = generate(plc, options);
            expect_honest(result);
            EXPECT_GT(result.mesh.tets.size(), 400U);
            EXPECT_NEAR(volume_per_region(result), volume, 1e-9);
            EXPECT_TRUE(same(result.mesh, generate(plc, options).mesh));
        }
}

TEST(SliverStrategies, WithoutASizeTooOrItIsRefused) {
    for (const SliverStrategy strategy : kHere) {
        SCOPED_TRACE(to_string(strategy));
        MeshOptions options = with(strategy, 12);
        options.size.edge_length.reset();
        if (strategy == SliverStrategy::chew) {
            EXPECT_EQ(check(options).size(), 1U);
            continue;
        }
        expect_honest(generate(rotated_l_block(), options));
    }
}

TEST(SliverStrategies, NoneIsDelaunayRefinement) {
    MeshOptions plain = with(SliverStrategy::best, 0);
    plain.seeding = Seeding::off;
    const MeshResult none = generate(cube(), with(SliverStrategy::none, 20));
    EXPECT_TRUE(same(none.mesh, generate(cube(), plain).mesh));
    EXPECT_EQ(none.termination, Termination::goals_unmet);
}

TEST(SliverStrategies, RefineReachesItsAngleWithinTheGrowthThatWasMeasured) {
    for (const Plc& plc : {cube(), rotated_l_block()}) {
        const MeshResult none = generate(plc, with(SliverStrategy::none, 18, 0.15)), refined = generate(plc, with(SliverStrategy::refine, 18, 0.15));
        expect_goals_met(refined);
        EXPECT_GT(refined.mesh.vertices.size(), none.mesh.vertices.size());
        EXPECT_LT(static_cast<double>(refined.mesh.vertices.size()), 1.35 * static_cast<double>(none.mesh.vertices.size()));
        EXPECT_LT(none.certificate.all.min_dihedral_angle_deg, 10);
    }
}

TEST(SliverStrategies, SigmaIsACriterionToo) {
    for (const SliverStrategy strategy : {SliverStrategy::refine, SliverStrategy::improve}) {
        MeshOptions options = with(strategy, 0, 0.15);
        options.paper.sigma0 = 0.03;
        const MeshResult result = generate(rotated_l_block(), options);
        expect_goals_met(result);
        EXPECT_GE(result.certificate.all.min_sigma, 0.03);
        EXPECT_NE(result.certificate.find("sigma")->state, Claim::State::not_checked);
    }
}

/// Looks at every point that is picked.
struct Watcher final : InsertionRecorder {
    std::function<void(const PickEvent&)> look;
    explicit Watcher(std::function<void(const PickEvent&)> f) : look(std::move(f)) {}
    std::uint32_t on_pick(const PickEvent& event) override {
        look(event);
        return 0;
    }
    void on_milestone(Milestone) override {}
};

TEST(SliverStrategies, PicksOfRefineMakeNoNewSmallSlivers) {
    constexpr double kAngle = 20, kB = 2;
    StagedMesh staged(rotated_l_block(), with(SliverStrategy::refine, kAngle, 0.25));
    staged.conform();
    Refiner refiner(staged.mesh, staged.boundary, staged.guard, staged.options);
    refiner.refine();
    std::size_t inside = 0, on_boundary = 0, last_resorts = 0;
    Watcher watcher([&](const PickEvent& event) {
        if (!event.vertex.valid()) return;
        last_resorts += !event.sliver_free;
        if (!event.sliver_free) return;
        ++(event.element.size == 4 ? inside : on_boundary);
        if (event.element.size == 4) {
            // The picking region is kept to.
            EXPECT_LE(distance(event.point, event.element.centre), kPracticalDelta * event.element.radius * (1 + 1e-9));
        }
        std::vector<TetId> star;
        staged.mesh.triangulation().find_star(event.vertex, star);
        for (const TetId t : star) {
            if (!staged.mesh.tets().is_finite(t) || !staged.mesh.in_domain(t)) continue;
            const TetShape s = staged.shape(t);
            EXPECT_FALSE(s.min_dihedral_deg < kAngle * (1 - 1e-9) && s.circumradius < kB * event.element.radius * (1 - 1e-9) && s.radius_edge <= 2)
                << s.min_dihedral_deg << " degrees, " << s.circumradius / event.element.radius << " radii";
        }
    });
    staged.boundary.recorder = &watcher;
    const SliverOutcome outcome = remove_slivers(staged.mesh, staged.boundary, refiner, staged.guard, staged.workers, staged.options);
    EXPECT_EQ(outcome.note, "");
    EXPECT_GT(inside, 20U);
    EXPECT_GT(on_boundary, 5U);
    EXPECT_LT(last_resorts, inside);
    EXPECT_EQ(staged.problem(true), "");
}

TEST(SliverStrategies, HopelessAnglesEndWithWhatIsMissed) {
    for (const SliverStrategy strategy : {SliverStrategy::refine, SliverStrategy::improve, SliverStrategy::perturb, SliverStrategy::chew}) {
        SCOPED_TRACE(to_string(strategy));
        const MeshOptions options = with(strategy, 50, 0.3);
        const std::size_t almost_good = generate(cube(), with(SliverStrategy::none, 0, 0.3)).mesh.vertices.size();
        const MeshResult result = generate(cube(), options);
        expect_honest(result);
        EXPECT_EQ(result.termination, Termination::goals_unmet);
        EXPECT_LE(result.certificate.all.max_radius_edge_ratio, 2);
        if (strategy == SliverStrategy::perturb) { EXPECT_EQ(result.mesh.vertices.size(), almost_good); }
        if (strategy == SliverStrategy::refine) {
            ASSERT_FALSE(result.statistics.notes.empty());
            EXPECT_NE(result.statistics.notes.back().find("refine stopped at"), std::string::npos);
        }
        // The bound, and what its last cascade may add.
        if (strategy != SliverStrategy::chew) { EXPECT_LE(static_cast<double>(result.mesh.vertices.size()), kGrowthLimit * static_cast<double>(almost_good) + kGrowthAllowance + 100); }
    }
}

TEST(SliverStrategies, RefineEndsWhereAnAngleIsAcute) {
    Plc wedge = cube();  // the wall at y = 1 moved in: an edge of 25 degrees
    for (Vec3& v : wedge.vertices)
        if (v.y > 0.5) v = v.x < 0.5 ? Vec3{0.9, 0.42, v.z} : Vec3{1, 0.47, v.z};
    MeshOptions options = with(SliverStrategy::refine, 20);
    options.size.edge_length.reset();
    const MeshResult refined = generate(wedge, options);
    expect_honest(refined);
    EXPECT_TRUE(refined.termination == Termination::goals_met || refined.termination == Termination::goals_unmet);
}

TEST(SliverStrategies, ExudationNumbersExemptTetrahedraAnew) {
    const Plc plc = testing::wedge(5);
    const MeshOptions none = with(SliverStrategy::none, 20, 0.3), exude = with(SliverStrategy::exude, 20, 0.3);
    const MeshResult before = generate(plc, none), after = generate(plc, exude);
    ASSERT_FALSE(after.exemptions.empty());
    ASSERT_NE(before.mesh.tets, after.mesh.tets);
    const auto corners = [](const MeshResult& result, const Exemption& e) {
        auto c = result.mesh.tets.at(e.tet);
        std::sort(c.begin(), c.end());
        return c;
    };
    // Exudation moves no vertex, so what is exempt afterwards was exempt before.
    std::set<std::array<std::uint32_t, 4>> exempt;
    for (const Exemption& e : before.exemptions) exempt.insert(corners(before, e));
    for (const Exemption& e : after.exemptions) EXPECT_TRUE(exempt.contains(corners(after, e))) << e.tet;
    EXPECT_TRUE(std::is_sorted(after.exemptions.begin(), after.exemptions.end(), [](const Exemption& a, const Exemption& b) { return a.tet < b.tet; }));
    EXPECT_EQ(after.certificate.find("exemptions")->state, Claim::State::proven);
}

TEST(SliverStrategies, LimitsOfTheUserHold) {
    for (const SliverStrategy strategy : {SliverStrategy::refine, SliverStrategy::improve}) {
        SCOPED_TRACE(to_string(strategy));
        MeshOptions options = with(strategy, 25, 0.15);
        const std::size_t almost_good = generate(cube(), with(SliverStrategy::none, 0, 0.15)).mesh.vertices.size();
        options.limits.max_vertices = almost_good + 5;
        const MeshResult result = generate(cube(), options);
        EXPECT_EQ(result.termination, Termination::vertex_budget_reached);
        EXPECT_LE(result.mesh.vertices.size(), almost_good + 15);
        expect_valid(result);
        RunControl stopped;
        std::stop_source source;
        stopped.stop = source.get_token();
        stopped.on_progress = [&](const Progress& p) {
            if (p.stage == Stage::shape) source.request_stop();
        };
        options = with(strategy, 50, 0.04);
        EXPECT_EQ(generate(cube(), options, stopped).termination, Termination::cancelled);
    }
}

TEST(SliverStrategies, PerturbMovesVerticesAndNothingElse) {
    for (const Plc& plc : {cube(), rotated_l_block()}) {
        const MeshResult none = generate(plc, with(SliverStrategy::none, 0, 0.15)), moved = generate(plc, with(SliverStrategy::perturb, 20, 0.15));
        expect_goals_met(moved);
        EXPECT_EQ(moved.mesh.vertices.size(), none.mesh.vertices.size());
        EXPECT_EQ(moved.statistics.segment_vertices, none.statistics.segment_vertices);
        EXPECT_EQ(moved.statistics.facet_vertices, none.statistics.facet_vertices);
        EXPECT_GT(moved.statistics.moved_vertices, 0U);
        EXPECT_LT(none.certificate.all.min_dihedral_angle_deg, 10);
    }
}

TEST(SliverStrategies, ChewKeepsHalfAUnitAndMakesNoSliverBelowAUnit) {
    MeshOptions options = with(SliverStrategy::chew, 15, 0.2);
    const double unit = kCircumradiusPerEdgeLength * *options.size.edge_length;
    StagedMesh staged(rotated_l_block(), options);
    staged.conform();
    Refiner refiner(staged.mesh, staged.boundary, staged.guard, staged.options);
    prepare_refinement(refiner, staged.boundary, options);
    std::size_t inside = 0, off_centre = 0;
    Watcher watcher([&](const PickEvent& event) {
        if (!event.vertex.valid() || event.element.size != 4 || event.reason != InsertionReason::size) return;
        ++inside;
        EXPECT_GE(event.nearest, unit / 2 * (1 - 1e-9));
        EXPECT_LE(distance(event.point, event.element.centre), unit / 2 * (1 + 1e-9));
        off_centre += distance(event.point, event.element.centre) > 0.01 * unit;
        if (!event.sliver_free) return;
        std::vector<TetId> star;
        staged.mesh.triangulation().find_star(event.vertex, star);
        for (const TetId t : star) {
            if (!staged.mesh.tets().is_finite(t) || !staged.mesh.in_domain(t)) continue;
            const TetShape s = staged.shape(t);
            EXPECT_FALSE(s.min_dihedral_deg < 15 * (1 - 1e-9) && s.circumradius < unit * (1 - 1e-9) && s.radius_edge <= 2);
        }
    });
    staged.boundary.recorder = &watcher;
    EXPECT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
    EXPECT_GT(inside, 50U);
    EXPECT_GT(off_centre, inside * 9 / 10);
    EXPECT_EQ(staged.problem(true), "");
    staged.for_domain([&](TetId t) { EXPECT_LE(staged.shape(t).circumradius, unit * (1 + 1e-9)); });
}

TEST(SliverStrategies, OptionsThatMakeNoSenseTogetherAreRefused) {
    const auto problems = [](auto&& change) {
        MeshOptions options;
        change(options);
        return fmt::format("{}", fmt::join(check(options), "; "));
    };
    const auto refused = [&](auto&& change, const char* because) {
        const std::string said = problems(change);
        EXPECT_NE(said.find(because), std::string::npos) << said;
    };
    using S = SliverStrategy;
    refused([](MeshOptions& o) { o.slivers = S::chew; }, "needs a size");
    refused([](MeshOptions& o) { o.slivers = S::chew; o.paper.delta = 0.2; }, "not for the slivers chew");
    refused([](MeshOptions& o) { o.slivers = S::perturb; o.paper.sigma0 = 0.02; }, "belongs to certified mode and to the slivers refine and improve, not to perturb");
    refused([](MeshOptions& o) { o.slivers = S::none; o.paper.b = 2; }, "not to none");
    refused([](MeshOptions& o) { o.slivers = S::refine; o.paper.b = 0; }, "b must be a finite number above 0");
    refused([](MeshOptions& o) { o.slivers = S::refine; o.paper.b = std::nan(""); }, "b must be a finite number above 0");
    refused([](MeshOptions& o) { o.slivers = S::refine; o.paper.sigma0 = -0.1; }, "sigma0 must be a finite number above 0, not -0.1");
    refused([](MeshOptions& o) { o.slivers = S::refine; o.paper.sigma0 = 0.02; }, "min dihedral angle must be 0");
    refused([](MeshOptions& o) { o.slivers = S::refine; o.paper.sigma0_boundary = 0.02; }, "needs sigma0");
    refused([](MeshOptions& o) { o.quality.min_dihedral_boundary_deg = 5; }, "refine and improve");
    refused([](MeshOptions& o) { o.slivers = S::improve; o.quality.min_dihedral_boundary_deg = 71; }, "70.52");
    refused([](MeshOptions& o) { o.slivers = S::improve; o.quality.min_dihedral_boundary_deg = std::nan(""); }, "70.52");
    for (const S strategy : kSliverStrategies) {
        const std::string said = problems([&](MeshOptions& o) { o = certified_options(), o.slivers = strategy; });
        EXPECT_EQ(said.empty(), strategy == S::best || strategy == S::refine) << said;
    }
    EXPECT_EQ(problems([](MeshOptions& o) { o.slivers = S::improve, o.quality.min_dihedral_boundary_deg = 5, o.paper.b = 3; }), "");
}

TEST(SliverStrategies, NamesAreReadAsTheyAreWritten) {
    for (const SliverStrategy strategy : kSliverStrategies) EXPECT_EQ(parse_sliver_strategy(to_string(strategy)), strategy);
    EXPECT_EQ(parse_sliver_strategy("Best"), std::nullopt);
    EXPECT_EQ(parse_sliver_strategy(""), std::nullopt);
}

}  // namespace
}  // namespace wellmesh::testing
