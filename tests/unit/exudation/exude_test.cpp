// SPDX-License-Identifier: Apache-2.0
#include "exudation/exude.hpp"

#include <fmt/format.h>

#include <map>
#include <set>

#include "core/vec3_math.hpp"
#include "quality/tet_shape.hpp"
#include "support/synthetic_plcs.hpp"
#include "weighted_checks.hpp"
#include "wellmesh/certificate.hpp"

namespace wellmesh::testing {
namespace {

ExudationReport run(TetMesh& mesh, double goal) {
    const RunControl control;
    RunGuard guard({}, control);
    return exude(mesh, goal, {}, guard);
}

double min_angle(const TetMesh& mesh) {
    double angle = 180;
    for (const auto& [a, b, c, d] : mesh.tets)
        angle = std::min(angle, min_dihedral_deg(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], mesh.vertices[d]));
    return angle;
}

std::map<std::int32_t, double> volumes(const TetMesh& mesh) {
    std::map<std::int32_t, double> sums;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const auto& [a, b, c, d] = mesh.tets[t];
        sums[mesh.tet_regions[t]] += six_volumes(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], mesh.vertices[d]) / 6;
    }
    return sums;
}

void expect_claims(const TetMesh& mesh, const Plc& plc) {
    const Certificate certificate = certify(mesh, {}, &plc);
    for (const Claim& c : certificate.claims) EXPECT_NE(c.state, Claim::State::refuted) << c.name << ": " << c.violations << " violations, " << c.detail;
    for (const char* name : {"weighted_delaunay", "weighted_gabriel_subfaces", "weighted_gabriel_subsegments"}) {
        ASSERT_NE(certificate.find(name), nullptr) << name;
        EXPECT_EQ(certificate.find(name)->state, Claim::State::proven) << name;
    }
    for (const char* name : {"delaunay", "gabriel_subfaces", "gabriel_subsegments"}) EXPECT_EQ(certificate.find(name), nullptr) << name;
}

/// Four vertices of a slightly bent square in the middle of a cube.
struct CubeWithSliver {
    Plc plc = cube(12);
    std::set<std::uint32_t> corners;
    CubeWithSliver() {
        const auto first = static_cast<std::uint32_t>(plc.vertices.size());
        for (const Vec3& p : {Vec3{1, 0, 0.02}, Vec3{-1, 0, 0.02}, Vec3{0, 1, -0.02}, Vec3{0, -1, -0.02}})
            plc.vertices.push_back(Vec3{6.1, 6.2, 6.3} + p);
        if (!plc.vertex_markers.empty()) plc.vertex_markers.resize(plc.vertices.size());
        for (std::uint32_t v = first; v < first + 4; ++v) corners.insert(v);
    }
    [[nodiscard]] bool is_in(const TetMesh& mesh) const {
        return std::any_of(mesh.tets.begin(), mesh.tets.end(), [&](const auto& t) { return std::set<std::uint32_t>(t.begin(), t.end()) == corners; });
    }
};

TEST(Exude, CuresAKnownSliver) {
    const CubeWithSliver input;
    MeshOptions options;
    options.slivers = SliverStrategy::none;
    options.quality.min_dihedral_angle_deg = 0;
    TetMesh mesh = generate(input.plc, options).mesh;
    ASSERT_TRUE(input.is_in(mesh));
    const TetMesh before = mesh;
    const ExudationReport report = run(mesh, 5);
    EXPECT_GT(report.slivers_before, 0U);
    EXPECT_EQ(report.slivers_after, 0U);
    EXPECT_GT(report.weighted_vertices, 0U);
    EXPECT_FALSE(input.is_in(mesh));
    EXPECT_GE(min_angle(mesh), 5);
    EXPECT_EQ(mesh.vertices, before.vertices);
    EXPECT_EQ(count_conflicts(mesh), 0U);
    expect_claims(mesh, input.plc);
}

TEST(Exude, LeavesAMeshWithoutSliversAlone) {
    TetMesh mesh = almost_good_mesh(cube(), 0.4);
    const TetMesh before = mesh;
    const ExudationReport report = run(mesh, min_angle(mesh) * (1 - 1e-9));
    EXPECT_EQ(report.changes, 0U);
    EXPECT_TRUE(mesh.weights.empty());
    EXPECT_EQ(mesh.tets, before.tets);
}

/// Domain, rotation.
class ExudeDomains : public ::testing::TestWithParam<std::tuple<std::size_t, std::uint64_t>> {};

TEST_P(ExudeDomains, SliversGoAndEverythingElseStays) {
    const auto [domain, rotation] = GetParam();
    const NamedPlc named = all_synthetic_plcs()[domain];
    SCOPED_TRACE(named.name);
    const Plc plc = rotation == 0 ? named.plc : transformed(named.plc, rotation, 0, 1);
    TetMesh mesh = almost_good_mesh(plc, 0.09 * diagonal(plc), rotation);
    const TetMesh before = mesh;
    const ExudationReport report = run(mesh, 15);
    EXPECT_GT(report.slivers_before, 4U);
    EXPECT_LT(report.slivers_after, report.slivers_before);
    EXPECT_GT(report.weighted_vertices, 0U);
    EXPECT_GE(min_angle(mesh), min_angle(before));
    EXPECT_EQ(mesh.vertices, before.vertices);
    EXPECT_EQ(mesh.subfaces, before.subfaces);
    EXPECT_EQ(mesh.subsegments, before.subsegments);
    EXPECT_EQ(mesh.tet_regions.size(), mesh.tets.size());
    const auto now = volumes(mesh), then = volumes(before);
    ASSERT_EQ(now.size(), then.size());
    for (const auto& [region, volume] : then) EXPECT_NEAR(now.at(region), volume, 1e-12 * volume);
    EXPECT_EQ(count_conflicts(mesh), 0U);
    EXPECT_EQ(count_encroached(mesh), 0U);
    expect_claims(mesh, plc);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        ASSERT_GE(mesh.weights[v], 0);
        for (std::size_t q = 0; q < mesh.vertices.size(); ++q)
            if (q != v && mesh.weights[v] > 0) {
                ASSERT_LE(std::sqrt(mesh.weights[v]), kMaxWeightRatio * distance(mesh.vertices[v], mesh.vertices[q]) * (1 + 1e-15));
            }
    }
    // the same again: the same bytes
    TetMesh again = before;
    run(again, 15);
    EXPECT_EQ(again.tets, mesh.tets);
    EXPECT_EQ(again.weights, mesh.weights);
    EXPECT_EQ(again.tet_regions, mesh.tet_regions);
}

INSTANTIATE_TEST_SUITE_P(All, ExudeDomains, ::testing::Combine(::testing::Range<std::size_t>(0, 5), ::testing::Values(0U, 3U)));

/// Cavities, handles, edges and vertices that touch, up to three regions; turned in half of the cases.
TEST(Exude, RandomPolycubesKeepBoundaryAndRegions) {
    std::uint64_t changes = 0, on_boundary = 0;
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        SCOPED_TRACE(seed);
        const RandomPolycube domain = random_polycube(seed);
        const Plc plc = seed % 2 == 0 ? domain.plc : transformed(domain.plc, seed, 0, 1);
        TetMesh mesh = almost_good_mesh(plc, 0.55, seed);
        const TetMesh before = mesh;
        changes += run(mesh, 12).changes;
        EXPECT_GE(min_angle(mesh), min_angle(before));
        EXPECT_EQ(mesh.subfaces, before.subfaces);
        const auto now = volumes(mesh);
        for (const auto& [region, cells] : domain.cells_of_region) EXPECT_NEAR(now.at(region), cells, 1e-9);
        EXPECT_EQ(count_conflicts(mesh), 0U);
        EXPECT_EQ(count_encroached(mesh), 0U);
        EXPECT_TRUE(certify(mesh, {}, &plc).proven());
        for (const auto& f : mesh.subfaces)
            for (const std::uint32_t v : f) on_boundary += !mesh.weights.empty() && mesh.weights[v] > 0;
    }
    EXPECT_GT(changes, 30U);
    EXPECT_GT(on_boundary, 0U);
}

TEST(Exude, BringsTheAngleBeyondFiveDegreesAwayFromTheBoundary) {
    double worst_inside = 180;
    for (const std::uint64_t seed : {1U, 2U}) {
        TetMesh mesh = almost_good_mesh(transformed(cube(), seed, 0, 1), 0.1, seed);
        run(mesh, 20);
        Certificate certificate;
        measure_shape(mesh, certificate);
        worst_inside = std::min(worst_inside, certificate.interior.min_dihedral_angle_deg);
    }
    EXPECT_GT(worst_inside, 5);
}

TEST(Exude, ContinuesFromWeights) {
    TetMesh mesh = almost_good_mesh(l_block(), 0.25);
    run(mesh, 5);
    const TetMesh first = mesh;
    ASSERT_FALSE(first.weights.empty());
    run(mesh, 15);
    EXPECT_NE(mesh.weights, first.weights);
    for (std::size_t v = 0; v < mesh.weights.size(); ++v) EXPECT_GE(mesh.weights[v], first.weights[v]);
    EXPECT_EQ(count_conflicts(mesh), 0U);
}

TEST(Exude, StopsWhenAskedWithAMeshThatHolds) {
    TetMesh mesh = almost_good_mesh(cube(), 0.25);
    std::stop_source source;
    source.request_stop();
    RunControl control;
    control.stop = source.get_token();
    RunGuard guard({}, control);
    const ExudationReport report = exude(mesh, 20, {}, guard);
    EXPECT_EQ(report.verdict, RunGuard::Verdict::cancelled);
    EXPECT_EQ(report.changes, 0U);
    EXPECT_EQ(count_conflicts(mesh), 0U);
}

/// Each way to tamper with weights is refuted, with a witness near the damage.
TEST(Exude, DamagedWeightsAreRefuted) {
    const Plc plc = cube_with_internal_facet();
    TetMesh mesh = almost_good_mesh(plc, 0.2 * diagonal(plc) / 2);
    run(mesh, 15);
    ASSERT_FALSE(mesh.weights.empty());
    const auto heaviest = static_cast<std::size_t>(std::max_element(mesh.weights.begin(), mesh.weights.end()) - mesh.weights.begin());
    const auto expect_refuted = [&](const TetMesh& damaged, const char* name) {
        const Certificate certificate = certify(damaged, {}, &plc);
        ASSERT_NE(certificate.find(name), nullptr);
        EXPECT_EQ(certificate.find(name)->state, Claim::State::refuted) << name;
        EXPECT_TRUE(certificate.find(name)->witness.has_value());
        EXPECT_GT(count_conflicts(damaged) + count_encroached(damaged), 0U);
    };
    TetMesh damaged = mesh;
    damaged.weights[heaviest] = 0;
    expect_refuted(damaged, "weighted_delaunay");
    damaged.weights[heaviest] = 4 * mesh.weights[heaviest];
    expect_refuted(damaged, "weighted_delaunay");
    damaged = mesh;
    damaged.weights.clear();
    expect_refuted(damaged, "delaunay");
    damaged = mesh;
    damaged.weights.pop_back();
    EXPECT_EQ(certify(damaged).find("numbers_in_range")->state, Claim::State::refuted);
    EXPECT_EQ(certify(damaged).find("weighted_delaunay")->state, Claim::State::not_checked);
    damaged = mesh;
    damaged.weights[0] = std::nan("");
    EXPECT_EQ(certify(damaged).find("finite_coordinates")->state, Claim::State::refuted);
    // all by the same amount: no difference
    damaged = mesh;
    for (double& w : damaged.weights) w = w - 64;
    if (std::equal(mesh.weights.begin(), mesh.weights.end(), damaged.weights.begin(), [](double a, double b) { return a == b + 64; })) {
        EXPECT_EQ(certify(damaged).find("weighted_delaunay")->state, Claim::State::proven);
    }
}

/// Count by count, the certificate and the brute-force check see the same conflicts, whether it looks at faces or at all spheres.
TEST(Exude, CertificateCountsConflictsAsBruteForceDoes) {
    TetMesh mesh = almost_good_mesh(cube(), 0.3);
    run(mesh, 15);
    mesh.weights.resize(mesh.vertices.size(), 0);
    std::size_t refuted = 0;
    for (std::size_t v = 0; v < mesh.vertices.size(); v += 3) {
        TetMesh damaged = mesh;
        damaged.weights[v] += 0.002 * static_cast<double>(v % 5);
        const Claim claim = *certify(damaged).find("weighted_delaunay");
        ASSERT_EQ(claim.violations, count_conflicts(damaged)) << v;
        refuted += claim.violations > 0;
    }
    EXPECT_GT(refuted, 5U);
}

}  // namespace
}  // namespace wellmesh::testing
