// SPDX-License-Identifier: Apache-2.0
// Finished meshes against the sizes that were asked for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/vec3_math.hpp"
#include "sizing/size_field.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh::testing {
namespace {

using Size = std::function<double(const Vec3&)>;

std::vector<double> ratios(const TetMesh& mesh, const Size& asked) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const auto& t : mesh.tets)
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = i + 1; j < 4; ++j) edges.insert(std::minmax(t[i], t[j]));
    std::vector<double> out;
    for (const auto& [a, b] : edges) out.push_back(distance(mesh.vertices[a], mesh.vertices[b]) / asked(0.5 * (mesh.vertices[a] + mesh.vertices[b])));
    std::sort(out.begin(), out.end());
    return out;
}

const AskedAchieved* find(const MeshResult& result, const std::string& goal) {
    for (const AskedAchieved& g : result.goals)
        if (g.goal == goal) return &g;
    return nullptr;
}

struct Field {
    std::string name;
    Size size;
};

class Follows : public ::testing::TestWithParam<Field> {};

TEST_P(Follows, EdgesAreWithinAQuarterOfWhatIsAskedAtTheirMiddles) {
    for (const Seeding seeding : {Seeding::automatic, Seeding::off}) {
        MeshOptions options;
        options.size.at = GetParam().size;
        options.seeding = seeding;
        const MeshResult result = generate(cube(), options);
        EXPECT_EQ(result.termination, Termination::goals_met);
        EXPECT_TRUE(result.certificate.proven());
        EXPECT_GT(result.mesh.tets.size(), 2000U);
        std::vector<double> found = ratios(result.mesh, GetParam().size);
        EXPECT_NEAR(found[found.size() / 2], 1, 0.15);
        EXPECT_GT(found[found.size() / 20], 0.5);
        EXPECT_LT(found[found.size() - found.size() / 20 - 1], 1.4);
        for (double& r : found) r = std::abs(r - 1);
        std::sort(found.begin(), found.end());
        EXPECT_LE(found[found.size() / 2], 0.25);
    }
}

INSTANTIATE_TEST_SUITE_P(Fields, Follows,
                         ::testing::Values(Field{"linear", [](const Vec3& p) { return 0.05 + 0.1 * p.x; }},
                                           Field{"point", [](const Vec3& p) { return 0.02 + 0.25 * norm(p - Vec3{0.4, 0.5, 0.6}); }},
                                           Field{"one_to_a_thousand", [](const Vec3& p) { return std::min(1.0, 0.001 + 0.3 * norm(p)); }}),
                         [](const ::testing::TestParamInfo<Field>& field) { return field.param.name; });

TEST(Gradation, IsKeptEverywhereInTheMesh) {
    // A jump of 1:10, which the gradation turns into a slope: edges may be as long as the field, and that grows by 0.3 a unit, wherever the small ones are.
    MeshOptions options;
    options.size.at = [](const Vec3& p) { return norm(p - Vec3{0.5, 0.5, 0.5}) < 0.1 ? 0.06 : 0.6; };
    for (const double g : {0.3, 0.6}) {
        options.size.gradation = g;
        const MeshResult result = generate(cube(), options);
        EXPECT_EQ(result.termination, Termination::goals_met);
        const TetMesh& mesh = result.mesh;
        for (const auto& t : mesh.tets) {
            Vec3 centre;
            for (const std::uint32_t v : t) centre = centre + 0.25 * mesh.vertices[v];
            const double allowed = 0.06 + g * std::max(0.0, norm(centre - Vec3{0.5, 0.5, 0.5}) - 0.1);
            for (std::size_t i = 0; i < 4; ++i)
                for (std::size_t j = i + 1; j < 4; ++j)
                    // An edge is no longer than the diameter, and fields may be off by the interpolation's error.
                    ASSERT_LE(distance(mesh.vertices[t[i]], mesh.vertices[t[j]]), 1.15 * kSizeTolerance * 2 * kCircumradiusPerEdgeLength * allowed);
        }
    }
}

TEST(Follows, FacetsSegmentsAndRegionsGetTheirSizes) {
    Plc input = cube_with_internal_facet();
    input.facets[0].marker = 7;
    for (const double gradation : {0.3, 0.0}) {
        MeshOptions options;
        options.size.gradation = gradation;
        options.size.edge_length = 0.5;
        options.size.entities = {{EntityKind::facet, 7, 0.06}};
        const MeshResult result = generate(input, options);
        EXPECT_TRUE(result.certificate.proven());
        double sum = 0, n = 0;
        for (std::size_t s = 0; s < result.mesh.subfaces.size(); ++s) {
            if (result.mesh.subface_markers[s] != 7) continue;
            for (std::size_t k = 0; k < 3; ++k) {
                sum += distance(result.mesh.vertices[result.mesh.subfaces[s][k]], result.mesh.vertices[result.mesh.subfaces[s][(k + 1) % 3]]);
                ++n;
            }
        }
        ASSERT_GT(n, 100);
        EXPECT_NEAR(sum / n, 0.06, 0.015) << gradation;
    }
    MeshOptions options;
    options.size.entities = {{EntityKind::region, 2, 0.1}, {EntityKind::region, 1, 0.3}};
    const MeshResult result = generate(input, options);
    const AskedAchieved* fine = find(result, "edge length (mean) in region 2");
    const AskedAchieved* coarse = find(result, "edge length (mean) in region 1");
    ASSERT_TRUE(fine && coarse);
    EXPECT_NEAR(fine->asked, 0.1, 1e-9);
    EXPECT_NEAR(fine->achieved, 0.1, 0.015);
    EXPECT_LT(coarse->asked, 0.3);
    EXPECT_NEAR(coarse->achieved, coarse->asked, 0.25 * coarse->asked);
    EXPECT_TRUE(find(result, "edge length / size (median)"));
}

/// Every edge of every region counts once, on any number of threads.
TEST(Follows, TheReportMeasuresEachEdgeOnce) {
    MeshOptions options;
    options.size.gradation = 0;
    options.size.entities = {{EntityKind::region, 2, 0.05}, {EntityKind::region, 1, 0.08}};
    for (const unsigned threads : {1U, 2U}) {
        options.threads = threads;
        const MeshResult result = generate(cube_with_internal_facet(), options);
        const TetMesh& mesh = result.mesh;
        ASSERT_GT(mesh.vertices.size(), 10'000U);
        std::map<std::int32_t, std::set<std::pair<std::uint32_t, std::uint32_t>>> edges;
        for (std::size_t t = 0; t < mesh.tets.size(); ++t)
            for (std::size_t i = 0; i < 4; ++i)
                for (std::size_t j = i + 1; j < 4; ++j) edges[mesh.tet_regions[t]].insert(std::minmax(mesh.tets[t][i], mesh.tets[t][j]));
        ASSERT_EQ(edges.size(), 2U);
        std::vector<double> all;
        for (const auto& [region, some] : edges) {
            const double asked = region == 2 ? 0.05 : 0.08;
            double sum = 0;
            for (const auto& [a, b] : some) {
                sum += distance(mesh.vertices[a], mesh.vertices[b]);
                all.push_back(distance(mesh.vertices[a], mesh.vertices[b]) / asked);
            }
            const AskedAchieved* row = find(result, "edge length (mean) in region " + std::to_string(region));
            ASSERT_TRUE(row);
            EXPECT_NEAR(row->asked, asked, 1e-12);
            EXPECT_NEAR(row->achieved, sum / static_cast<double>(some.size()), 1e-12);
            EXPECT_TRUE(row->met) << region;
        }
        const AskedAchieved* median = find(result, "edge length / size (median)");
        ASSERT_TRUE(median);
        const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
        std::nth_element(all.begin(), middle, all.end());
        EXPECT_NEAR(median->achieved, *middle, 1e-12);
    }
}

TEST(MinSize, IsKeptButWhereTheInputIsFiner) {
    MeshOptions options;
    options.size.at = [](const Vec3& p) { return 0.2 * norm(p); };
    options.size.min_edge_length = 0.1;
    const MeshResult result = generate(cube(), options);
    const AskedAchieved* smallest = find(result, "edge length (smallest)");
    ASSERT_TRUE(smallest);
    EXPECT_TRUE(smallest->met);
    EXPECT_GT(smallest->achieved, 0.025);
    for (const std::string& note : result.statistics.notes) EXPECT_EQ(note.find("smallest size"), std::string::npos) << note;

    Plc input = cube();  // with a segment inside, far shorter than the smallest size
    input.vertices.insert(input.vertices.end(), {{0.5, 0.5, 0.5}, {0.503, 0.5, 0.5}});
    input.segments.push_back({{8, 9}, 1});
    const MeshResult forced = generate(input, options);
    ASSERT_TRUE(find(forced, "edge length (smallest)"));
    EXPECT_TRUE(find(forced, "edge length (smallest)")->met);
    EXPECT_TRUE(std::any_of(forced.statistics.notes.begin(), forced.statistics.notes.end(), [](const std::string& n) { return n.find("smallest size") != std::string::npos; }));
}

TEST(SizeGoals, HopelessOnesEndAtTheLimitOnVertices) {
    MeshOptions options;
    options.size.at = [](const Vec3&) { return 1e-4; };
    options.limits.max_vertices = 2000;
    const MeshResult result = generate(cube(), options);
    EXPECT_EQ(result.termination, Termination::vertex_budget_reached);
    EXPECT_LE(result.mesh.vertices.size(), 2000U);
}

TEST(SizeGoals, SameFieldSameMesh) {
    MeshOptions options;
    options.size.at = [](const Vec3& p) { return 0.1 + 0.1 * p.y; };
    options.size.per_local_feature_size = 0.5;
    options.size.elements_per_circle = 20;
    const MeshResult first = generate(l_block(), options), second = generate(l_block(), options);
    ASSERT_EQ(first.mesh.tets, second.mesh.tets);
    for (std::size_t v = 0; v < first.mesh.vertices.size(); ++v) ASSERT_EQ(squared_distance(first.mesh.vertices[v], second.mesh.vertices[v]), 0);
}

TEST(SizeGoals, VertexSizesMustFitTheVertices) {
    Plc input = cube();
    input.vertex_sizes = {1, 2};
    EXPECT_THROW((void)generate(input), MeshError);
    input.vertex_sizes.assign(8, 1);
    input.vertex_sizes[3] = -1;
    EXPECT_THROW((void)generate(input), MeshError);
}

}  // namespace
}  // namespace wellmesh::testing
