// SPDX-License-Identifier: Apache-2.0
// Random domains by construction: whatever the union of boxes, generate() keeps every promise.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "core/rng.hpp"
#include "support/expect_result.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh::testing {
namespace {

constexpr std::uint64_t kCases = 40, kCubeGroups = 4;

void expect_volumes(const RandomPolycube& random, const MeshResult& result) {
    ASSERT_EQ(result.certificate.regions.size(), random.cells_of_region.size());
    for (const RegionVolume& r : result.certificate.regions) {
        const auto cells = random.cells_of_region.find(r.region);
        ASSERT_NE(cells, random.cells_of_region.end());
        EXPECT_NEAR(r.volume, cells->second, 1e-6);
        ASSERT_TRUE(r.plc_volume.has_value());
        EXPECT_NEAR(*r.plc_volume, cells->second, 1e-6);
    }
}

class RandomPolycubes : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(RandomPolycubes, AreMeshedToTheirGoals) {
    for (std::uint64_t seed = 1 + GetParam() * kCases / kCubeGroups; seed <= (GetParam() + 1) * kCases / kCubeGroups; ++seed) {
        const RandomPolycube random = random_polycube(seed);
        const std::uint64_t rotation = seed % 3 == 0 ? 0 : mix64(seed);
        const double shift = seed % 5 == 0 ? 1e3 : 0;
        MeshOptions options;
        options.seed = seed;
        if (seed % 4 == 0) options.size.edge_length = 0.75;
        if (seed % 4 == 1) options.size.max_volume = 0.125;
        SCOPED_TRACE(fmt::format("random_polycube({}), rotation {}, shift {}", seed, rotation, shift));
        const MeshResult result = generate(transformed(random.plc, rotation, shift, 1), options);
        expect_goals_met(result);
        expect_volumes(random, result);
    }
}

INSTANTIATE_TEST_SUITE_P(All, RandomPolycubes, ::testing::Range<std::uint64_t>(0, kCubeGroups));

TEST(RandomPolycubeInput, IsVaried) {
    std::size_t regions = 0, cavities = 0, facets_with_holes = 0, not_a_box = 0;
    for (std::uint64_t seed = 1; seed <= kCases; ++seed) {
        const RandomPolycube random = random_polycube(seed);
        regions += random.cells_of_region.size() > 1;
        cavities += !random.plc.hole_seeds.empty();
        facets_with_holes += std::any_of(random.plc.facets.begin(), random.plc.facets.end(), [](const PlcFacet& f) { return !f.holes.empty(); });
        not_a_box += random.plc.facets.size() > 6;
    }
    EXPECT_GT(not_a_box, 25U);
    EXPECT_GT(regions, 10U);
    EXPECT_GT(facets_with_holes, 2U);
    RecordProperty("cavities", static_cast<int>(cavities));
}

}  // namespace
}  // namespace wellmesh::testing
