// SPDX-License-Identifier: Apache-2.0
// Random domains with angles down to 0.01 degrees, and angles of any size between many facets at once: every run ends, in a conforming Delaunay mesh or
// in an error that names what could not be done. WELLMESH_ACUTE_CASES=1000 tries more of them than the default.
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "support/acute_plcs.hpp"
#include "support/expect_result.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh::testing {
namespace {

constexpr std::uint64_t kDefaultCases = 20, kGroups = 10;

std::uint64_t cases() {
    const char* const asked = std::getenv("WELLMESH_ACUTE_CASES");
    return asked == nullptr ? kDefaultCases : std::strtoull(asked, nullptr, 10);
}

/// Delaunay, conforming and Gabriel by the certificate, computed again and without goals, so that nothing of the run's own is believed.
void expect_certified(const Plc& plc, const MeshResult& result) {
    CertifyOptions bounds;
    bounds.tolerance = result.statistics.certificate_tolerance;
    bounds.flat_angle_rad = result.statistics.certificate_flat_angle_rad;
    const Certificate again = certify(result.mesh, bounds, &plc);
    for (const Claim& c : again.claims) EXPECT_NE(c.state, Claim::State::refuted) << c.name << ": " << c.detail;
    for (const char* name : {"delaunay", "gabriel_subfaces", "gabriel_subsegments", "disjoint_tets"}) EXPECT_EQ(again.find(name)->state, Claim::State::proven) << name;
    for (const RegionVolume& r : result.certificate.regions)
        if (r.plc_volume) { EXPECT_NEAR(r.volume, *r.plc_volume, 1e-6 * *r.plc_volume); }
}

class AcutePlcs : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(AcutePlcs, EndInAConformingMeshOrATypedError) {
    std::map<std::string, std::size_t> ends;
    for (std::uint64_t seed = GetParam(); seed < cases(); seed += kGroups) {
        const NamedPlc named = random_acute(seed);
        SCOPED_TRACE(named.name);
        MeshOptions options;
        options.seed = seed;
        if (seed / 10 % 2 == 0) {  // conformity alone
            options.slivers = SliverStrategy::none;
            options.quality = {.max_radius_edge_ratio = 1e300, .min_dihedral_angle_deg = 0};
        }
        options.limits.time = std::chrono::seconds(100);  // a hang is a failure
        options.limits.max_vertices = 8000;               // needles take several times more in half a minute, and show nothing else
        try {
            const MeshResult result = generate(named.plc, options);
            ++ends[to_string(result.termination)];
            EXPECT_NE(result.termination, Termination::time_budget_reached);
            expect_valid(result);
            expect_certified(named.plc, result);
        } catch (const MeshError& e) {
            ++ends[to_string(e.code())];
            EXPECT_EQ(e.code(), ErrorCode::unsupported_acute) << e.what();
            EXPECT_FALSE(e.offenders().empty()) << e.what();
        }
    }
    for (const auto& [end, count] : ends) RecordProperty(end, static_cast<int>(count));
}

INSTANTIATE_TEST_SUITE_P(All, AcutePlcs, ::testing::Range<std::uint64_t>(0, kGroups));

std::size_t vertices_for_conformity(const Plc& plc) {
    MeshOptions options;
    options.slivers = SliverStrategy::none;
    options.quality = {.max_radius_edge_ratio = 1e300, .min_dihedral_angle_deg = 0};
    const MeshResult result = generate(plc, options);
    expect_certified(plc, result);
    return result.mesh.vertices.size();
}

/// Rotated coordinates are rounded, and symmetric input is symmetric but for that: rectangles have no circle then, and axes are not quite shared.
TEST(AcuteSymmetry, SurvivesRotations) {
    const std::vector<NamedPlc> all{{"fan of 16", fan(16)},     {"fan of 64", fan(64)},      {"blades, 30", two_blades(30)}, {"blades, 5", two_blades(5)},
                                    {"blades, 0.1", two_blades(0.1)}, {"wedge, 0.1", wedge(0.1)}, {"wedge, 0.01", wedge(0.01)}};
    for (const NamedPlc& named : all) {
        const std::size_t given = vertices_for_conformity(named.plc);
        for (std::uint64_t rotation = 1; rotation <= 3; ++rotation)
            for (const double scale : {1.0, 1e-6}) {
                SCOPED_TRACE(named.name + ", rotation " + std::to_string(rotation) + ", scale " + std::to_string(scale));
                EXPECT_LE(vertices_for_conformity(transformed(named.plc, rotation, 0, scale)), 2 * given + 40);
            }
    }
}

TEST(AcutePlcInput, IsVariedAndSharp) {
    std::map<std::string, int> kinds;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        const NamedPlc named = random_acute(seed);
        ++kinds[named.name.substr(0, named.name.find(' '))];
        EXPECT_FALSE(diagnose(named.plc).has_errors()) << named.name;
    }
    EXPECT_EQ(kinds.size(), 8U);
    EXPECT_EQ(kinds["complex"], 18);
}

}  // namespace
}  // namespace wellmesh::testing
