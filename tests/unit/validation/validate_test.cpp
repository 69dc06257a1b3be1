// SPDX-License-Identifier: Apache-2.0
// validate() on inputs whose complex is known.
#include "plc_helpers.hpp"

#include <cmath>

namespace wellmesh::testing {
namespace {

struct Expected {
    std::size_t vertices, segments, facets, cells;
    double filled_volume;
};

Expected expected(const std::string& name) {
    if (name == "cube") return {8, 12, 6, 2, 1};
    if (name == "l_block") return {12, 18, 8, 2, 3};
    if (name == "cavity") return {16, 24, 12, 3, 26};
    if (name == "two_regions") return {12, 20, 11, 3, 2};
    const double r = std::sqrt(2.0) - 1;  // regular octagon of inradius 1: area 8 (sqrt(2) - 1)
    return {32, 48, 19, 2, 1.5 * 8 * r + 1.5 * 2 * r};
}

TEST(Validate, SyntheticDomainsInAnyOrientationPlaceAndScale) {
    for (const auto& [name, plc] : all_synthetic_plcs())
        for (const std::uint64_t rotation : {0U, 1U, 2U, 3U})
            for (const double shift : {0.0, 1e3, 1e6})
                for (const double scale : {1.0, 1e-6, 1e6}) {
                    SCOPED_TRACE(name + " rotation " + std::to_string(rotation) + " shift " + std::to_string(shift) + " scale " + std::to_string(scale));
                    const ValidPlc valid = validate(transformed(plc, rotation, shift, scale));
                    const Expected e = expected(name);
                    EXPECT_EQ(valid.vertices.size(), e.vertices);
                    EXPECT_EQ(valid.segments.size(), e.segments);
                    EXPECT_EQ(valid.facets.size(), e.facets);
                    EXPECT_EQ(valid.cells.size(), e.cells);
                    EXPECT_TRUE(valid.acute_features.empty()) << valid.acute_features[0].angle_deg;
                    EXPECT_TRUE(valid.diagnosis.defects.empty()) << listing(valid.diagnosis);
                    double filled = 0;
                    for (const ValidCell& c : valid.cells) filled += c.filled ? c.volume : 0;
                    EXPECT_NEAR(filled / (scale * scale * scale) / e.filled_volume, 1, 1e-8);
                }
}

TEST(Validate, ComplexesAreConsistent) {
    for (const auto& [name, plc] : all_synthetic_plcs()) {
        SCOPED_TRACE(name);
        expect_consistent(validate(plc));
        expect_consistent(validate(transformed(plc, 5, 10, 3)));
    }
}

TEST(Validate, RegionsTakeTheirSeedsNumbers) {
    Plc plc = cube_with_internal_facet();
    plc.region_seeds[0].id = -7;
    plc.region_seeds[0].max_volume = 0.25;
    plc.region_seeds[1].id = -7;  // one number for two cells is fine
    const ValidPlc valid = validate(plc);
    EXPECT_EQ(valid.cells[1].region, -7);
    EXPECT_EQ(valid.cells[2].region, -7);
    EXPECT_EQ(valid.cells[1].max_volume, 0.25);
    EXPECT_EQ(valid.cells[1].inside.x < 1, true);
}

TEST(Validate, CellsWithoutSeedGetUnusedNumbers) {
    Plc plc = cube_with_internal_facet();
    plc.region_seeds.pop_back();
    plc.region_seeds[0].id = 1;
    EXPECT_EQ(validate(plc).cells[2].region, 2);
    plc.region_seeds.clear();
    EXPECT_EQ(validate(plc).cells[1].region, 1);
    EXPECT_EQ(validate(plc).cells[2].region, 2);
}

TEST(Validate, TriangulatedBoxBecomesSixFacets) {
    const ValidPlc valid = validate(triangulated_box());
    expect_consistent(valid);
    EXPECT_EQ(valid.facets.size(), 6U);
    EXPECT_EQ(valid.segments.size(), 12U);
    EXPECT_TRUE(valid.acute_features.empty());
}

TEST(Validate, MergeRuleNoneKeepsTriangles) {
    Plc plc = triangulated_box();
    plc.merge_coplanar = MergeRule::none;
    const ValidPlc valid = validate(plc);
    EXPECT_EQ(valid.facets.size(), 12U);
    EXPECT_EQ(valid.segments.size(), 18U);
}

TEST(Validate, MarkersKeepCoplanarTrianglesApart) {
    Plc plc = triangulated_box();
    plc.facets[0].marker = 5;
    const ValidPlc valid = validate(plc);
    EXPECT_EQ(valid.facets.size(), 7U);
    EXPECT_EQ(valid.segments.size(), 13U);
}

TEST(Validate, NestedBoxesByWinding) {
    Plc plc = triangulated_box({0, 0, 0}, {9, 9, 9});
    add_box(plc, {1, 1, 1}, {8, 8, 8}, true);   // a cavity
    add_box(plc, {2, 2, 2}, {7, 7, 7});         // an island in it
    add_box(plc, {3, 3, 3}, {6, 6, 6});         // oriented alike: winding number 2, filled
    for (const std::uint64_t rotation : {0U, 4U}) {
        const ValidPlc valid = validate(transformed(plc, rotation, 0, 1));
        expect_consistent(valid);
        ASSERT_EQ(valid.cells.size(), 5U);
        std::size_t filled = 0;
        for (const ValidCell& c : valid.cells) {
            filled += c.filled;
            if (!c.filled && std::isfinite(c.volume)) {
                EXPECT_NEAR(c.volume, 343 - 125, 1e-9);
            }
        }
        EXPECT_EQ(filled, 3U);
    }
}

TEST(Validate, BoxesThatTouchInAVertexOrAnEdge) {
    Plc plc = triangulated_box();
    add_box(plc, {1, 1, 1}, {2, 2, 2});
    add_box(plc, {0, 1, 1}, {-1, 2, 2}, true);  // mirrored in x, so turned once more
    const ValidPlc valid = validate(plc);
    expect_consistent(valid);
    EXPECT_EQ(valid.cells.size(), 4U);
    for (std::size_t c = 1; c < valid.cells.size(); ++c) EXPECT_NEAR(valid.cells[c].volume, 1, 1e-12);
}

TEST(Validate, AWallStatedTwiceSeparatesTwoRegions) {
    Plc plc = triangulated_box();
    add_box(plc, {1, 0, 0}, {2, 1, 1});  // its wall repeats the first box's, turned
    const ValidPlc valid = validate(plc);
    expect_consistent(valid);
    EXPECT_EQ(valid.cells.size(), 3U);
    EXPECT_EQ(count(valid.diagnosis, DefectKind::duplicate_facet), 2U);
    EXPECT_TRUE(valid.cells[1].filled && valid.cells[2].filled);
}

TEST(Validate, InconsistentOrientationFillsEveryCell) {
    Plc plc = triangulated_box();
    std::swap(plc.facets[3].polygons[0][0], plc.facets[3].polygons[0][1]);
    const ValidPlc valid = validate(plc);
    EXPECT_TRUE(valid.cells[1].filled);
    EXPECT_EQ(count(valid.diagnosis, DefectKind::inconsistent_orientation), 1U);
    expect_consistent(valid);
}

TEST(Validate, SlitsWiresAndPointsInsideFacets) {
    Plc plc = cube();
    const auto add = [&](Vec3 p) {
        plc.vertices.push_back(p);
        return static_cast<std::uint32_t>(plc.vertices.size() - 1);
    };
    // the first facet lies in x = 0 or x = 1
    const double x = plc.vertices[plc.facets[0].polygons[0][0]].x;
    const std::uint32_t a = add({x, 0.25, 0.5}), b = add({x, 0.75, 0.5}), c = add({x, 0.5, 0.25});
    plc.facets[0].polygons.push_back({a, b});
    plc.facets[0].polygons.push_back({c});
    const std::uint32_t d = add({0.5, 0.5, 0.25}), e = add({0.5, 0.5, 0.75}), lone = add({0.25, 0.5, 0.5});
    plc.segments.push_back({{d, e}, 42});
    add({7, 7, 7});
    const ValidPlc valid = validate(plc);
    expect_consistent(valid);
    EXPECT_EQ(valid.vertices.size(), 14U);
    EXPECT_EQ(valid.segments.size(), 14U);
    ASSERT_EQ(valid.isolated_vertices.size(), 1U);
    EXPECT_EQ(valid.source_vertex[valid.isolated_vertices[0].index()], lone);
    EXPECT_EQ(count(valid.diagnosis, DefectKind::isolated_vertex), 1U);
    EXPECT_EQ(std::count_if(valid.segments.begin(), valid.segments.end(), [](const ValidSegment& s) { return s.marker == 42 && s.facets.empty(); }), 1);
    EXPECT_EQ(valid.facets[0].vertices.size(), 7U);
    EXPECT_EQ(valid.facets[0].segments.size(), 5U);
}

TEST(Validate, AFacetIsCutWhereASegmentSeparatesIt) {
    const ValidPlc valid = validate(cube_with_internal_facet());
    for (const ValidSegment& s : valid.segments) EXPECT_GE(s.facets.size(), 2U);
    EXPECT_EQ(std::count_if(valid.segments.begin(), valid.segments.end(), [](const ValidSegment& s) { return s.facets.size() == 3; }), 4);
}

TEST(Validate, PolygonEdgesAreSplitAtVerticesOfTheirFacetEverywhere) {
    // one facet of the cube lists a vertex in the middle of an edge as a point; the neighbour that shares the edge does not know it
    for (const std::uint64_t rotation : {0U, 1U, 2U}) {
        Plc plc = cube();
        const auto& polygon = plc.facets[0].polygons[0];
        const Vec3 a = plc.vertices[polygon[0]], b = plc.vertices[polygon[1]];
        plc.vertices.push_back(0.5 * (a + b));
        plc.facets[0].polygons.push_back({8});
        const ValidPlc valid = validate(transformed(plc, rotation, 100, 1));
        expect_consistent(valid);
        EXPECT_EQ(valid.segments.size(), 13U);
        EXPECT_TRUE(valid.acute_features.empty());
    }
}

TEST(Validate, NeedlesOfATriangulationAreClosed) {
    // the box's bottom diagonal is split at its midpoint on one side only, with a flat triangle in the gap
    for (const double lift : {0.0, 1e-17}) {
        Plc plc = triangulated_box({0, 0, -1}, {1, 1, 0});
        // facets 2 and 3 are the top, z = 0: triangles (4, 5, 7) and (4, 7, 6) with the common edge 4-7
        plc.vertices.push_back({0.5, 0.5, lift});
        plc.facets[3].polygons = {{4, 8, 6}};
        PlcFacet other, needle;
        other.polygons = {{8, 7, 6}};
        needle.polygons = {{4, 7, 8}};
        plc.facets.push_back(other);
        plc.facets.push_back(needle);
        const ValidPlc valid = validate(plc);
        expect_consistent(valid);
        EXPECT_EQ(valid.facets.size(), 6U);
        EXPECT_EQ(valid.vertices.size(), 9U);
        EXPECT_EQ(count(valid.diagnosis, DefectKind::degenerate_facet), 1U);
        EXPECT_NEAR(valid.cells[1].volume, 1, 1e-12);
    }
}

TEST(Validate, BitIdenticalVerticesAreOneAndMinusZeroIsZero) {
    Plc plc = triangulated_box();
    for (PlcFacet& f : plc.facets)
        for (std::uint32_t& v : f.polygons[0]) {
            Vec3 p = plc.vertices[v];
            if (p.x == 0) p.x = -0.0;
            plc.vertices.push_back(p);
            v = static_cast<std::uint32_t>(plc.vertices.size() - 1);
        }
    const ValidPlc valid = validate(plc);
    EXPECT_EQ(valid.vertices.size(), 8U);
    for (const Vec3& p : valid.vertices) EXPECT_FALSE(std::signbit(p.x));
    EXPECT_EQ(count(valid.diagnosis, DefectKind::duplicate_vertex), 1U);
}

TEST(Validate, AcuteFeaturesOfAWedge) {
    // a triangular prism with angles of 30, 60 and 90 degrees; its ends are orthogonal to its sides
    Plc plc;
    const double h = std::tan(std::numbers::pi / 6);
    plc.vertices = {{0, 0, 0}, {1, 0, 0}, {1, h, 0}, {0, 0, 2}, {1, 0, 2}, {1, h, 2}};
    for (const std::vector<std::uint32_t>& p : std::vector<std::vector<std::uint32_t>>{{0, 1, 2}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}) {
        PlcFacet f;
        f.polygons = {p};
        plc.facets.push_back(f);
    }
    for (const std::uint64_t rotation : {0U, 1U, 2U}) {
        const ValidPlc valid = validate(transformed(plc, rotation, 1e3, 1));
        std::size_t segments = 0, vertices = 0;
        for (const AcuteFeature& f : valid.acute_features) {
            (f.kind == EntityKind::segment ? segments : vertices) += 1;
            EXPECT_TRUE(std::abs(f.angle_deg - 30) < 1e-6 || std::abs(f.angle_deg - 60) < 1e-6) << f.angle_deg;
        }
        EXPECT_EQ(segments, 2U);
        EXPECT_EQ(vertices, 4U);
        EXPECT_NEAR(valid.acute_features.front().angle_deg, 30, 1e-6);
    }
}

TEST(Validate, ASegmentCanBeAcuteToAFacetOnly) {
    // a wire that leaves the middle of the cube's floor, on a point of that facet, at 45 degrees
    Plc plc = cube();
    const double x = plc.vertices[plc.facets[0].polygons[0][0]].x;
    plc.vertices.push_back({x, 0.5, 0.5});
    plc.vertices.push_back({0.5, 0.75, 0.5 + 0.25 * std::sqrt(3.0)});
    plc.facets[0].polygons.push_back({8});
    plc.segments.push_back({{8, 9}, 0});
    const ValidPlc valid = validate(plc);
    ASSERT_EQ(valid.acute_features.size(), 1U);
    EXPECT_EQ(valid.acute_features[0].kind, EntityKind::vertex);
    EXPECT_NEAR(valid.acute_features[0].angle_deg, 45, 1e-9);
}

TEST(Validate, ThrowsWithAllOffenders) {
    Plc plc = triangulated_box();
    add_box(plc, {0.5, 0.5, 0.5}, {2, 2, 2});
    plc.source_name = "two_boxes.off";
    try {
        (void)validate(plc);
        FAIL();
    } catch (const MeshError& e) {
        EXPECT_EQ(e.code(), ErrorCode::bad_input);
        EXPECT_EQ(e.stage(), Stage::validate);
        EXPECT_NE(std::string(e.what()).find("two_boxes.off"), std::string::npos);
        EXPECT_NE(std::string(e.what()).find("self_intersection"), std::string::npos);
        EXPECT_EQ(e.offenders().size(), 2 * count(diagnose(plc), DefectKind::self_intersection));
    }
}

}  // namespace
}  // namespace wellmesh::testing
