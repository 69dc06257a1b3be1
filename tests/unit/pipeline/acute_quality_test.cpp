// SPDX-License-Identifier: Apache-2.0
// Goals outside what the input's acute angles force, and input whose facets are as thin as the rounding of its file.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "support/expect_result.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/generate.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::testing {
namespace {

/// Triangles around one segment in the unit cube, two of them at less than a degree.
Plc seven_triangles() {
    Plc plc = cube();
    const auto vertex = [&](double x, double y, double z) {
        plc.vertices.push_back({x, y, z});
        return static_cast<std::uint32_t>(plc.vertices.size() - 1);
    };
    const std::uint32_t low = vertex(0.5, 0.5, 0.25), high = vertex(0.52, 0.55, 0.8);
    for (const Vec3 p : {Vec3{0.733142257661301, 0.7578683360601537, 0.6746627735437228}, {0.5824259970577734, 0.46305719914228183, 0.6763494840632716},
                         {0.3987347749442367, 0.5317655613045371, 0.47842734829976696}, {0.6945816780748938, 0.39298735045945316, 0.3857179254183519},
                         {0.614607061654915, 0.4152336141282059, 0.3621965054703732}, {0.46223253438103196, 0.5380848223843917, 0.4808331518449509},
                         {0.44029800016262804, 0.5470266256854707, 0.3280913279073761}}) {
        PlcFacet facet;
        facet.polygons.push_back({low, high, vertex(p.x, p.y, p.z)});
        plc.facets.push_back(facet);
    }
    return plc;
}

/// Edges between the triangles are a hundredth of the ball about the segment's end, and grading out of them comes to an end in that ball.
TEST(AcuteQuality, GoalsHoldAroundBallsThatAreInTheWay) {
    const MeshResult result = generate(seven_triangles(), MeshOptions{});
    EXPECT_EQ(result.termination, Termination::goals_met);
    expect_valid(result);
    EXPECT_FALSE(result.exemptions.empty());
    for (const Exemption& e : result.exemptions) {
        const auto& corners = result.mesh.tets[e.tet];
        EXPECT_GE(std::count_if(corners.begin(), corners.end(), [&](std::uint32_t v) { return result.mesh.vertex_carriers[v].kind != CarrierKind::region; }), 2) << e.tet;
    }
}

/// Single precision: merged facets have needles among them that the rounding turns over.
TEST(AcuteQuality, FacetsThatRoundingMakesTooThinStayApart) {
    const std::filesystem::path file = std::filesystem::path(WELLMESH_SHARED_MODELS) / "nasty/42400-IDGH.stl";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no models";
    const Plc plc = read_plc(file);
    MeshOptions options;
    options.slivers = SliverStrategy::none;
    options.quality = {.max_radius_edge_ratio = 1e300, .min_dihedral_angle_deg = 0};
    const MeshResult result = generate(plc, options);
    EXPECT_EQ(result.termination, Termination::goals_met);
    EXPECT_LT(result.statistics.coplanar_tolerance, 1e-11);
    EXPECT_TRUE(std::any_of(result.statistics.notes.begin(), result.statistics.notes.end(), [](const std::string& n) { return n.find("stay apart") != std::string::npos; }));
    options.coplanar_tolerance = 4.7e-5;  // who states a tolerance gets that one
    EXPECT_THROW((void)generate(plc, options), MeshError);
}

}  // namespace
}  // namespace wellmesh::testing
