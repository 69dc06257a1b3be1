// SPDX-License-Identifier: Apache-2.0
// Input that is thinner than the rounding of its coordinates: joined and reported, or refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "core/vec3_math.hpp"
#include "support/expect_result.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh::testing {
namespace {

constexpr double kFloat32 = 1.0 / (1 << 24);

/// A solid of single precision with a step as high as that is coarse, 2 km long and 0.7 mm high.
Plc stepped_solid() {
    Plc plc;
    plc.vertices = {{-25.198211669921875, -650.77587890625, 1174.5123291015625},   {288.26217651367188, -1118.711669921875, 839.1583251953125},
                    {-58.645263671875, -735.6923828125, 1270.13623046875},          {329.050537109375, -1179.60009765625, 795.520751953125},
                    {300.31515502929688, -1285.501708984375, 892.295166015625},     {288.2623291015625, -1118.711181640625, 839.15789794921875},
                    {601.21307373046875, -2771.328857421875, -528.541259765625},    {642.05029296875, -2832.475341796875, -572.392333984375},
                    {607.1263427734375, -2917.81640625, -449.92715454101562},       {601.2132568359375, -2771.32861328125, -528.5418701171875}};
    for (const std::vector<std::uint32_t>& t : std::vector<std::vector<std::uint32_t>>{{2, 1, 0}, {4, 3, 1}, {1, 3, 5}, {8, 4, 2}, {8, 3, 4}, {5, 3, 9}, {8, 6, 7}, {2, 4, 1},
                                                                                        {8, 7, 3}, {3, 7, 9}, {7, 6, 9}, {0, 1, 6}, {5, 9, 6}, {1, 5, 6}, {6, 8, 2}, {6, 2, 0}}) {
        PlcFacet facet;
        facet.polygons = {t};
        plc.facets.push_back(facet);
    }
    plc.fill = FillRule::nonzero_winding;
    plc.relative_rounding = kFloat32;
    return plc;
}

Plc single_precision(Plc plc) {
    const auto round = [](double x) { return static_cast<double>(static_cast<float>(x)); };
    for (Vec3& p : plc.vertices) p = {round(p.x), round(p.y), round(p.z)};
    return plc;
}

/// The promises of a joined result, against the input as it was stated.
void expect_joined(const Plc& plc, const MeshResult& result) {
    expect_valid(result);
    ASSERT_TRUE(result.statistics.joined);
    const JoinStatistics& joined = *result.statistics.joined;
    EXPECT_FALSE(joined.joined.empty());
    EXPECT_LE(joined.largest_move, joined.tolerance);
    const auto told = [](const std::string& note) { return note.find("were joined: vertex ") != std::string::npos; };
    EXPECT_EQ(std::count_if(result.statistics.notes.begin(), result.statistics.notes.end(), told), 1);
    std::set<std::uint32_t> carried;
    for (std::size_t v = 0; v < result.mesh.vertices.size(); ++v) {
        const VertexCarrier& carrier = result.mesh.vertex_carriers[v];
        if (carrier.kind != CarrierKind::input_vertex) continue;
        ASSERT_LT(carrier.id, plc.vertices.size());
        EXPECT_EQ(result.mesh.vertices[v], plc.vertices[carrier.id]);
        EXPECT_TRUE(carried.insert(carrier.id).second) << carrier.id;
    }
    EXPECT_EQ(carried.size(), plc.vertices.size());
    for (std::size_t f = 0; f < result.mesh.subfaces.size(); ++f) {
        const std::int32_t facet = result.mesh.subface_facets[f];
        ASSERT_TRUE(facet >= 1 && facet <= static_cast<std::int32_t>(plc.facets.size()));
        EXPECT_EQ(result.mesh.subface_markers[f], plc.facets[static_cast<std::size_t>(facet - 1)].marker);
    }
    for (const Exemption& e : result.exemptions)
        if (e.feature.kind == EntityKind::vertex) { EXPECT_LT(e.feature.number - plc.first_number, plc.vertices.size()); }
}

TEST(ThinFeatures, StepsWithinSinglePrecisionAreShut) {
    Plc plc = stepped_solid();
    plc.first_number = 1;
    for (PlcFacet& f : plc.facets) f.marker = 105;
    for (std::size_t v = 0; v < plc.vertices.size(); ++v) plc.vertex_markers.push_back(static_cast<std::int32_t>(200 + v));
    plc.names.of_dimension[2][105] = "deck";
    const MeshResult result = generate(plc);
    EXPECT_EQ(result.termination, Termination::goals_met);
    expect_joined(plc, result);
    const JoinStatistics& joined = *result.statistics.joined;
    ASSERT_EQ(joined.joined.size(), 2U);
    EXPECT_EQ(joined.joined[0].vertex.number, 6U);
    EXPECT_EQ(joined.joined[0].with.number, 2U);
    EXPECT_EQ(joined.joined[1].vertex.number, 10U);
    EXPECT_EQ(joined.joined[1].with.number, 7U);
    EXPECT_NEAR(joined.largest_move, distance(plc.vertices[9], plc.vertices[6]), 1e-9);
    EXPECT_GE(result.statistics.certificate_tolerance * 3e3, 0.9 * joined.largest_move);
    EXPECT_LE(result.statistics.certificate_tolerance, 1e-6);
    ASSERT_NE(result.mesh.names.find(2, 105), nullptr);
    EXPECT_EQ(std::count(result.mesh.vertex_markers.begin(), result.mesh.vertex_markers.end(), 205), 1);
    EXPECT_EQ(*result.mesh.names.find(2, 105), "deck");
}

TEST(ThinFeatures, StepsAreShutWhereverTheyAre) {
    for (const double scale : {1e-6, 1e6}) {
        const Plc scaled = single_precision(transformed(stepped_solid(), 0, 0, scale));
        expect_joined(scaled, generate(scaled));
    }
    for (const std::uint64_t rotation : {1U, 2U, 3U}) {
        const Plc rotated = single_precision(transformed(stepped_solid(), rotation, 0, 1));
        expect_joined(rotated, generate(rotated));
    }
}

/// Facets of different markers are never merged, so validation sees no thin one; their slits turn up where they can't be conformed to.
TEST(ThinFeatures, StepsBetweenMarkersAreShutWhenFoundLate) {
    Plc plc = stepped_solid();
    for (std::size_t f = 0; f < plc.facets.size(); ++f) plc.facets[f].marker = static_cast<std::int32_t>(100 + f);
    expect_joined(plc, generate(plc));
    MeshOptions options;
    options.thin_features = ThinFeatures::refuse;
    EXPECT_THROW((void)generate(plc, options), MeshError);
}

/// Rotated in doubles nothing says any more that the coordinates were single precision.
TEST(ThinFeatures, StepsAreShutWhereDoublesHideThem) {
    for (const std::uint64_t rotation : {1U, 2U, 3U}) {
        Plc rotated = transformed(stepped_solid(), rotation, 0, 1);
        rotated.relative_rounding = 0;
        const MeshResult result = generate(rotated);
        expect_joined(rotated, result);
        EXPECT_TRUE(result.statistics.joined && result.statistics.joined->assumed_single_precision);
        MeshOptions options;
        options.thin_features = ThinFeatures::refuse;
        EXPECT_THROW((void)generate(rotated, options), MeshError);
    }
}

TEST(ThinFeatures, AreRefusedOnRequest) {
    MeshOptions options;
    options.thin_features = ThinFeatures::refuse;
    try {
        (void)generate(stepped_solid(), options);
        ADD_FAILURE() << "it was meshed";
    } catch (const MeshError& e) {
        EXPECT_EQ(e.code(), ErrorCode::bad_input);
        EXPECT_NE(std::string(e.what()).find("feature_too_thin"), std::string::npos);
    }
}

/// Whatever else is wrong stays an error, and the thin feature is named with it.
TEST(ThinFeatures, NothingElseIsMended) {
    Plc open = stepped_solid();
    open.facets.erase(open.facets.begin());
    try {
        (void)generate(open);
        ADD_FAILURE() << "it was meshed";
    } catch (const MeshError& e) {
        EXPECT_EQ(e.code(), ErrorCode::bad_input);
        EXPECT_NE(std::string(e.what()).find("open_edge"), std::string::npos);
        EXPECT_NE(std::string(e.what()).find("feature_too_thin"), std::string::npos);
    }
}

/// A cube with tetrahedra inside whose tips are at the given places.
Plc cube_with_tips(const std::vector<Vec3>& tips) {
    Plc plc = cube();
    plc.facets[0].marker = 7;
    for (std::size_t i = 0; i < tips.size(); ++i) {
        const auto first = static_cast<std::uint32_t>(plc.vertices.size());
        const double at = 0.25 + 0.5 * static_cast<double>(i) / static_cast<double>(tips.size());
        for (const Vec3& p : {tips[i], Vec3{at, 0.4, 0.4}, Vec3{at + 0.1, 0.5, 0.35}, Vec3{at + 0.05, 0.6, 0.45}}) plc.vertices.push_back(p);
        for (const auto& t : {std::array<std::uint32_t, 3>{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}) {
            PlcFacet facet;
            facet.polygons = {{first + t[0], first + t[1], first + t[2]}};
            facet.marker = 9;
            plc.facets.push_back(facet);
        }
    }
    return plc;
}

/// Certified against the input as it is, or refused as bad input.
bool meshed_or_refused(const Plc& plc) {
    try {
        const MeshResult result = generate(plc);
        if (result.statistics.joined) expect_joined(plc, result);
        else expect_valid(result);
        return true;
    } catch (const MeshError& e) {
        EXPECT_EQ(e.code(), ErrorCode::bad_input) << e.what();
        return false;
    }
}

TEST(ThinFeatures, TipsAtFacetsEdgesAndVertices) {
    unsigned inside = 0, edges = 0, several = 0;
    for (const double ulps : {0.0, 0.5, 2.0}) {
        SCOPED_TRACE(ulps);
        const double z = 1 - ulps * std::numeric_limits<double>::epsilon();
        inside += meshed_or_refused(cube_with_tips({{0.3, 0.45, z}}));
        edges += meshed_or_refused(cube_with_tips({{0.3, z, z}}));
        several += meshed_or_refused(cube_with_tips({{0.3, 0.45, z}, {0.5, 0.55, z}, {0.7, z, z}}));
        meshed_or_refused(cube_with_tips({{z, z, z}}));
        meshed_or_refused(transformed(cube_with_tips({{0.3, 0.45, z}, {0.6, 0.55, z}}), 5, 0, 1));
        meshed_or_refused(transformed(cube_with_tips({{0.3, z, z}}), 6, 0, 1));
    }
    EXPECT_EQ(inside, 2U);  // those that don't touch
    EXPECT_EQ(edges, 2U);
    EXPECT_EQ(several, 2U);
}

/// Joined, there is nothing left of it: no mesh of the input as stated.
TEST(ThinFeatures, BodiesAsFlatAsTheRoundingAreRefused) {
    Plc plc = cube_with_tips({{0.3, 0.45, 1 - std::numeric_limits<double>::epsilon()}});
    plc.vertices[11] = {0.3, 0.45, 0.45};
    EXPECT_FALSE(meshed_or_refused(transformed(plc, 5, 0, 1)));
}

}  // namespace
}  // namespace wellmesh::testing
