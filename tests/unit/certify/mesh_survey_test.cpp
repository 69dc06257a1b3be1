// SPDX-License-Identifier: Apache-2.0
// What a survey says does not depend on what the mesh lists, nor on how many edges a vertex has.
#include "certify/mesh_survey.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "brute_force.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/delaunay.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh::certifying {
namespace {

MeshSurvey survey(const TetMesh& mesh) {
    const SuspectMesh suspect(mesh);
    return survey_mesh(suspect, TetsByCorner(suspect), {}, {});
}

void expect_same_shapes(const MeshSurvey& a, const MeshSurvey& b) {
    EXPECT_EQ(a.on_constraint, b.on_constraint);
    std::array<std::array<ShapeStatistics, 3>, 2> edges{};
    for (const std::size_t k : {0U, 1U}) (k == 0 ? a : b).edges.store(edges[k][0], edges[k][1], edges[k][2]);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(edges[0][i].min_edge, edges[1][i].min_edge);
        EXPECT_EQ(edges[0][i].mean_edge, edges[1][i].mean_edge);
        EXPECT_EQ(edges[0][i].max_edge, edges[1][i].max_edge);
    }
    for (ShapeStatistics ShapeSurvey::* part : {&ShapeSurvey::all, &ShapeSurvey::interior, &ShapeSurvey::boundary}) {
        const ShapeStatistics &x = a.shapes.*part, &y = b.shapes.*part;
        EXPECT_EQ(x.tets, y.tets);
        EXPECT_EQ(x.min_dihedral_angle_deg, y.min_dihedral_angle_deg);
        EXPECT_EQ(x.max_aspect_ratio, y.max_aspect_ratio);
        EXPECT_EQ(x.min_dihedral_histogram, y.min_dihedral_histogram);
    }
}

TEST(MeshSurvey, ListsAreNoMoreThanAGuess) {
    MeshOptions options;
    options.size.edge_length = 0.3;
    const TetMesh mesh = generate(testing::cube_with_internal_facet(), options).mesh;
    const MeshSurvey expected = survey(mesh);
    EXPECT_GT(expected.shapes.interior.tets, 10U);
    EXPECT_TRUE(expected.faces.edges.has_value());
    TetMesh unlisted = mesh;
    unlisted.subfaces.clear();
    unlisted.subface_facets.clear();
    unlisted.subface_markers.clear();
    expect_same_shapes(survey(unlisted), expected);
    // A few are missing; or there are more, which then are constraints, in whatever order.
    TetMesh fewer = unlisted;
    fewer.subfaces.assign(mesh.subfaces.begin(), mesh.subfaces.begin() + 5);
    expect_same_shapes(survey(fewer), expected);
    TetMesh more = unlisted;
    more.subfaces = mesh.subfaces;
    for (std::size_t t = 0; t < 4; ++t) more.subfaces.push_back({mesh.tets[7 * t][0], mesh.tets[7 * t][2], mesh.tets[7 * t][1]});
    TetMesh reversed = more;
    std::reverse(reversed.subfaces.begin(), reversed.subfaces.end());
    expect_same_shapes(survey(more), survey(reversed));
}

// A vertex with hundreds of edges, and the lowest number or the highest.
TEST(MeshSurvey, HubsCountAsBruteForceCounts) {
    for (const bool first : {true, false}) {
        std::vector<Vec3> points;
        for (std::uint64_t i = 0; i < 300; ++i) {
            Vec3 p{unit_double(mix64(i, 0)) - 0.5, unit_double(mix64(i, 1)) - 0.5, unit_double(mix64(i, 2)) - 0.5};
            points.push_back((1 / norm(p)) * p);
        }
        points.insert(first ? points.begin() : points.end(), Vec3{0, 0, 0});
        const TetMesh mesh = triangulate_points(points).mesh;
        std::map<std::set<std::uint32_t>, int> faces;
        std::set<std::set<std::uint32_t>> edges;
        double sum = 0;
        for (const auto& t : mesh.tets)
            for (std::size_t i = 0; i < 4; ++i) {
                ++faces[{t[i], t[(i + 1) % 4], t[(i + 2) % 4]}];
                for (std::size_t j = i + 1; j < 4; ++j)
                    if (edges.insert({t[i], t[j]}).second) sum += distance(mesh.vertices[t[i]], mesh.vertices[t[j]]);
            }
        const MeshSurvey found = survey(mesh);
        EXPECT_EQ(found.faces.faces, faces.size());
        EXPECT_EQ(found.faces.boundary_faces, static_cast<std::uint64_t>(std::count_if(faces.begin(), faces.end(), [](const auto& f) { return f.second == 1; })));
        EXPECT_EQ(found.faces.locally_not_delaunay, 0U);
        EXPECT_TRUE(found.faces.edges.has_value());
        std::array<ShapeStatistics, 3> s{};
        found.edges.store(s[0], s[1], s[2]);
        EXPECT_NEAR(s[0].mean_edge, sum / static_cast<double>(edges.size()), 1e-13);
        // The same with one face too many: found at whichever vertex it is.
        TetMesh broken = mesh;
        broken.tets.push_back(mesh.tets[3]);
        broken.tet_regions.clear();
        const MeshSurvey bad = survey(broken);
        EXPECT_EQ(bad.faces.distinct_tets.violations, 1U);
        EXPECT_FALSE(bad.faces.edges.has_value());
        std::array<ShapeStatistics, 3> again{};
        bad.edges.store(again[0], again[1], again[2]);
        EXPECT_EQ(again[0].mean_edge, s[0].mean_edge);
    }
}

}  // namespace
}  // namespace wellmesh::certifying
