// SPDX-License-Identifier: Apache-2.0
// The account of real runs: nothing is violated, unless the events are tampered with on their way; and the picks against oracles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "quality/tet_shape.hpp"
#include "refinement/circumsphere.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"
#include "theory/run_recorder.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh::testing {
namespace {

const TheoryConstants kRecorded{0.05, 4.5, 20, 0.06};

/// Passes events on, changed.
class Tamper final : public InsertionRecorder {
public:
    RunRecorder* inner = nullptr;
    std::function<void(PickEvent&)> change;
    std::function<void(Milestone)> at_milestone;
    std::uint32_t on_pick(const PickEvent& event) override {
        PickEvent changed = event;
        if (change) change(changed);
        return inner->on_pick(changed);
    }
    void on_milestone(Milestone reached) override {
        if (at_milestone) at_milestone(reached);
        inner->on_milestone(reached);
    }
};

/// A certified run by hand.
InvariantReport run(const Plc& plc, const std::function<void(Tamper&, StagedMesh&)>& meddle = {}) {
    MeshOptions options = certified_options();
    StagedMesh staged(plc, options);
    RunRecorder recorder(staged.mesh, kRecorded, false);
    Tamper tamper;
    tamper.inner = &recorder;
    staged.boundary.recorder = &tamper;
    staged.boundary.rules = {kRecorded.delta, 0, true};
    staged.conform();
    if (meddle) meddle(tamper, staged);
    Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
    refiner.guard_edges();
    SliverRule rule;
    rule.inside = rule.at_boundary = kRecorded.sigma0;
    rule.b = kRecorded.b;
    rule.candidates = 400;
    refiner.set_sliver_rule(rule);
    EXPECT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
    EXPECT_EQ(refiner.refused(), 0U);
    EXPECT_EQ(staged.problem(true), "");
    return recorder.finish();
}

/// Two wires that cross at a hundredth of their length: nothing is encroached at first, and the sliver that they span is an original one. Its centre
/// splits one wire, that vertex encroaches the other, whose new vertex is a hundredth of l_org away: Theorem 4.2 as the paper states it fails.
Plc crossing_wires() {
    Plc plc = cube(6);
    for (Vec3& p : plc.vertices) p = p - Vec3{3, 3, 3};
    const auto first = static_cast<std::uint32_t>(plc.vertices.size());
    for (const Vec3& p : {Vec3{-1, 0, 0}, Vec3{1, 0, 0}, Vec3{0, -1, 0.01}, Vec3{0, 1, 0.01}}) plc.vertices.push_back(p);
    plc.segments = {{{first, first + 1}, 0}, {{first + 2, first + 3}, 0}};
    return plc;
}

/// Domains whose runs remove slivers and split boundaries for them.
Plc eventful() { return transformed(random_polycube(5).plc, 1, 0, 1); }

std::uint64_t violations_of_all_but_existence(const InvariantReport& report) { return report.violations() - report.find("theorem_4_1")->violations; }

TEST(RunRecorder, NoClaimIsViolated) {
    std::uint64_t slivers = 0, boundary = 0;
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
        const InvariantReport report = run(transformed(random_polycube(seed).plc, seed % 3, 0, 1));
        for (const InvariantClaim& c : report.claims)
            if (c.name != "theorem_4_1") { EXPECT_EQ(c.violations, 0U) << seed << ' ' << c.name << ": " << c.witness; }
        EXPECT_EQ(report.find("lemma_5_1_input")->events, report.find("theorem_5_2")->events - (report.final_vertices - report.find("lemma_5_1_input")->events));
        slivers += report.find("lemma_5_1_case_2")->events;
        boundary += report.find("lemma_5_1_case_7")->events;
    }
    EXPECT_GT(slivers, 40U);  // or the test shows nothing
    EXPECT_GT(boundary, 20U);
}

TEST(RunRecorder, CrossingWiresRefuteTheoremFourTwoAsStatedButNotAsCorrected) {
    const InvariantReport report = run(crossing_wires());
    for (const InvariantClaim& c : report.claims)
        if (c.name != "theorem_4_1") { EXPECT_EQ(c.violations, 0U) << c.name << ": " << c.witness; }
    EXPECT_GE(report.find("encroaching_vertex")->events, 1U);
    EXPECT_NEAR(report.original_edge, std::sqrt(2.0), 1e-3);
    EXPECT_LT(report.shortest_edge, 0.02);  // (1 - delta) / 4 of l_org would be 0.336
}

TEST(RunRecorder, TamperedRunsAreRefuted) {
    const Plc plc = eventful();
    ASSERT_EQ(violations_of_all_but_existence(run(plc)), 0U);
    const auto violated = [&](const char* claim, const std::function<void(PickEvent&)>& change) {
        return run(plc, [&](Tamper& t, StagedMesh&) { t.change = change; }).find(claim)->violations;
    };
    EXPECT_GT(violated("picking_region", [](PickEvent& e) { e.element.centre = e.element.centre + Vec3{0.11 * e.element.radius, 0, 0}; }), 0U);
    EXPECT_GT(violated("parent", [](PickEvent& e) { if (e.parent.valid()) e.parent = *std::min_element(e.element.corners.begin(), e.element.corners.begin() + e.element.size); }), 0U);
    EXPECT_GT(violated("order", [](PickEvent& e) { e.more_urgent = e.reason == InsertionReason::sliver ? 1 : 0; }), 0U);
    EXPECT_GT(violated("empty_sphere", [](PickEvent& e) { e.nearest *= 0.5; }), 0U);
    EXPECT_GT(violated("lemma_2_5", [](PickEvent& e) { if (e.element.size < 4) e.element.radius *= 0.5; }), 0U);
    EXPECT_GT(violated("lemma_5_1_case_7", [](PickEvent& e) { if (e.element.size < 4) e.nearest *= 0.4; }), 0U);
    EXPECT_GT(violated("theorem_4_2", [](PickEvent& e) { e.nearest *= 0.05; }), 0U);
}

/// The queues keep the paper's order: before a sliver is split the whole mesh conforms and is almost good.
TEST(RunRecorder, TheMeshIsAlmostGoodWheneverTheRunSaysSo) {
    std::size_t looks = 0;
    (void)run(eventful(), [&](Tamper& t, StagedMesh& staged) {
        t.at_milestone = [&](InsertionRecorder::Milestone reached) {
            if (reached != InsertionRecorder::Milestone::almost_good) return;
            ++looks;
            EXPECT_EQ(check_conforming(staged.mesh, true), "");
            staged.for_domain([&](TetId t2) { EXPECT_LE(staged.shape(t2).radius_edge, 20 * (1 + 1e-9)); });
        };
    });
    EXPECT_GT(looks, 3U);
}

TEST(RunRecorder, FinalMeshHasNoSliver) {
    MeshOptions options = certified_options();
    for (const NamedPlc& named : all_synthetic_plcs())
        for (const bool sized : {false, true}) {
            SCOPED_TRACE(named.name);
            const Plc plc = transformed(named.plc, 1, 0, 1);
            options.size.edge_length.reset();
            if (sized) options.size.edge_length = 0.1 * diagonal(plc);
            const MeshResult result = generate(plc, options);
            ASSERT_TRUE(result.invariants.has_value());
            EXPECT_EQ(violations_of_all_but_existence(*result.invariants), 0U);
            EXPECT_GE(result.certificate.all.min_sigma, kCertifiedSigma);
            EXPECT_LE(result.certificate.all.max_radius_edge_ratio, kCertifiedRadiusEdgeRatio);
            EXPECT_TRUE(result.certificate.proven());
        }
}

/// Keeping account changes nothing.
TEST(RunRecorder, PracticalRunsAreTheSameWithAndWithout) {
    MeshOptions options;
    const Plc plc = transformed(cube_with_internal_facet(), 3, 0, 1);
    options.size.edge_length = 0.15 * diagonal(plc);
    const MeshResult plain = generate(plc, options);
    options.invariants = true;
    const MeshResult counted = generate(plc, options);
    EXPECT_FALSE(plain.invariants.has_value());
    ASSERT_TRUE(counted.invariants.has_value());
    EXPECT_EQ(plain.mesh.vertices, counted.mesh.vertices);
    EXPECT_EQ(plain.mesh.tets, counted.mesh.tets);
    for (const char* name : {"picking_region", "empty_sphere", "parent", "order", "lemma_5_1_case_1", "lemma_5_1_case_7", "lemma_2_1"}) EXPECT_EQ(counted.invariants->find(name)->violations, 0U) << name;
}

/// Spheres of flat tetrahedra: the corners are as far from the centre as the radius says.
TEST(Circumsphere, OfTetrahedraHoweverFlat) {
    for (const double height : {1.0, 1e-4, 1e-9, 1e-13, 0x1p-52}) {
        const Vec3 a{1, 0, 0}, b{0, 1, 0}, c{-1, 0, height}, d{0.1, -0.9, 0.25};
        for (const Circumsphere& s : {exact_circumsphere(a, b, c, {0, -1, 0.5 * height}), careful_circumsphere(a, b, c, d)}) {
            EXPECT_NEAR(norm(a - s.centre) / s.radius, 1, 1e-9) << height;
            EXPECT_NEAR(norm(b - s.centre) / s.radius, 1, 1e-9) << height;
        }
    }
    EXPECT_TRUE(std::isinf(exact_circumsphere({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}).radius));
}

}  // namespace
}  // namespace wellmesh::testing
