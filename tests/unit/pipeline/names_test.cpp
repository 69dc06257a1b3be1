// SPDX-License-Identifier: Apache-2.0
// From the input's names and markers to those of the mesh: closed, open and dangling facets, wires and single points.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/vec3_math.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh {
namespace {

/// Two cells, with an open sheet, a fin on a wall, a wire, a wire that hangs from a wall, and a lone point inside.
Plc furnished() {
    Plc plc = testing::cube_with_internal_facet();
    for (std::size_t f = 0; f < plc.facets.size(); ++f) plc.facets[f].marker = static_cast<std::int32_t>(10 + f);
    const auto vertex = [&](double x, double y, double z) {
        plc.vertices.push_back({x, y, z});
        return static_cast<std::uint32_t>(plc.vertices.size() - 1);
    };
    plc.facets.push_back({{{vertex(0.3, 0.3, 0.3), vertex(0.7, 0.3, 0.3), vertex(0.7, 0.7, 0.3), vertex(0.3, 0.7, 0.3)}}, {}, 70});  // open, inside
    plc.facets.push_back(
        {{{vertex(1.3, 0.4, 0), vertex(1.7, 0.4, 0), vertex(1.7, 0.4, 0.4), vertex(1.3, 0.4, 0.4)}}, {}, 71});  // stands on the floor
    const std::vector<std::uint32_t>& fin = plc.facets.back().polygons[0];
    plc.facets[8].polygons.push_back({fin[0], fin[1]});  // the floor knows where
    plc.segments.push_back({{vertex(1.3, 0.7, 0.6), vertex(1.7, 0.7, 0.6)}, 80});
    plc.segments.push_back({{vertex(0.5, 0.5, 1), vertex(0.5, 0.5, 0.7)}, 81});  // from the ceiling
    plc.facets[9].polygons.push_back({plc.segments.back().vertices[0]});
    const std::uint32_t lone = vertex(1.5, 0.2, 0.8);
    plc.vertex_markers.assign(plc.vertices.size(), 0);
    plc.vertex_markers[lone] = 90;
    plc.vertex_markers[0] = 91;
    plc.region_seeds[0].id = 5;
    plc.region_seeds[1].id = -6;
    plc.names.of_dimension = {{{{90, "probe"}}, {{80, "wire"}}, {{70, "sheet"}, {71, "fin"}}, {{5, "air"}, {-6, "oil"}}}};
    return plc;
}

TEST(NamesInTheMesh, EveryEntityKnowsItsInput) {
    for (const std::uint64_t rotation : {0U, 8U}) {
        SCOPED_TRACE(rotation);
        const double scale = rotation == 0 ? 1 : 1e-3;
        const Plc plc = testing::transformed(furnished(), rotation, rotation == 0 ? 0 : 10, scale);
        MeshOptions options;
        options.quality.min_dihedral_angle_deg = 0;
        const MeshResult result = generate(plc, options);
        const TetMesh& mesh = result.mesh;
        EXPECT_TRUE(result.certificate.proven());
        EXPECT_EQ(mesh.names, plc.names);

        std::map<std::int32_t, double> areas, lengths, volumes;
        for (std::size_t f = 0; f < mesh.subfaces.size(); ++f) {
            const auto& [a, b, c] = mesh.subfaces[f];
            areas[mesh.subface_markers[f]] += norm(cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a])) / 2;
            EXPECT_EQ(plc.facets.at(static_cast<std::size_t>(mesh.subface_facets[f]) - 1).marker, mesh.subface_markers[f]);
        }
        for (std::size_t f = 0; f < plc.facets.size(); ++f)
            EXPECT_NEAR(areas[plc.facets[f].marker] / scale / scale, plc.facets[f].marker < 70 ? 1 : 0.16, 1e-9) << f;
        ASSERT_EQ(mesh.subsegment_markers.size(), mesh.subsegments.size());
        for (std::size_t s = 0; s < mesh.subsegments.size(); ++s)
            lengths[mesh.subsegment_markers[s]] += distance(mesh.vertices[mesh.subsegments[s][0]], mesh.vertices[mesh.subsegments[s][1]]);
        EXPECT_NEAR(lengths[80] / scale, 0.4, 1e-9);
        EXPECT_NEAR(lengths[81] / scale, 0.3, 1e-9);
        ASSERT_EQ(mesh.vertex_markers.size(), mesh.vertices.size());
        std::map<std::int32_t, Vec3> marked;
        for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
            if (mesh.vertex_markers[v] != 0) marked[mesh.vertex_markers[v]] = mesh.vertices[v];
        EXPECT_EQ(marked, (std::map<std::int32_t, Vec3>{{90, plc.vertices.back()}, {91, plc.vertices[0]}}));
        const std::set<std::int32_t> regions(mesh.tet_regions.begin(), mesh.tet_regions.end());
        EXPECT_EQ(regions, (std::set<std::int32_t>{-6, 5}));
        ASSERT_EQ(result.statistics.cells.size(), 3U);
        std::set<std::string> names;
        for (const CellSummary& cell : result.statistics.cells)
            if (cell.filled) {
                names.insert(cell.name);
                EXPECT_NEAR(cell.volume / std::pow(scale, 3), 1, 1e-6);
            }
        EXPECT_EQ(names, (std::set<std::string>{"air", "oil"}));
    }
}

}  // namespace
}  // namespace wellmesh
