// SPDX-License-Identifier: Apache-2.0
// Each kind of defect, made on purpose; diagnose() never throws.
#include "plc_helpers.hpp"

#include <limits>

namespace wellmesh::testing {
namespace {

const Defect* find(const Diagnosis& d, DefectKind kind) {
    for (const Defect& x : d.defects)
        if (x.kind == kind) return &x;
    return nullptr;
}

void expect_only_error(const Plc& plc, DefectKind kind, std::size_t n) {
    const Diagnosis d = diagnose(plc);
    EXPECT_EQ(count(d, kind), n) << listing(d);
    for (const Defect& x : d.defects)
        if (x.severity == Severity::error) {
            EXPECT_EQ(x.kind, kind) << x.message;
        }
    EXPECT_TRUE(d.has_errors());
    EXPECT_THROW((void)validate(plc), MeshError);
}

TEST(Diagnose, EmptyInput) {
    expect_only_error(Plc{}, DefectKind::empty_input, 1);
    Plc points;
    points.vertices = {{0, 0, 0}, {1, 0, 0}};
    expect_only_error(points, DefectKind::empty_input, 1);
}

TEST(Diagnose, ListsEveryBadVertexAndIndexAtOnce) {
    Plc plc = cube();
    plc.first_number = 1;
    plc.vertices[2].y = std::numeric_limits<double>::quiet_NaN();
    plc.vertices[5].x = std::numeric_limits<double>::infinity();
    plc.vertices[6].z = 1e300;
    plc.facets[0].polygons[0][0] = 99;
    const Diagnosis d = diagnose(plc);
    EXPECT_EQ(count(d, DefectKind::non_finite_coordinate), 2U);
    EXPECT_EQ(count(d, DefectKind::coordinate_range), 1U);
    ASSERT_EQ(count(d, DefectKind::bad_index), 1U);
    EXPECT_EQ(find(d, DefectKind::non_finite_coordinate)->elements.at(0).number, 3U);
    EXPECT_NE(find(d, DefectKind::bad_index)->message.find("100"), std::string::npos);
}

TEST(Diagnose, CoordinateRangeHasItsOwnCode) {
    Plc plc = cube();
    plc.vertices.push_back({1e-300, 0, 0});
    try {
        (void)validate(plc);
        FAIL();
    } catch (const MeshError& e) {
        EXPECT_EQ(e.code(), ErrorCode::coordinate_range);
    }
}

TEST(Diagnose, OpenSurfaceListsEveryEdge) {
    Plc plc = triangulated_box();
    plc.facets.erase(plc.facets.begin() + 4);
    expect_only_error(plc, DefectKind::open_edge, 3);
}

TEST(Diagnose, DanglingFacetsOfAComplexAreFine) {
    Plc plc = cube();
    plc.vertices.insert(plc.vertices.end(), {{0.25, 0.25, 0.5}, {0.75, 0.25, 0.5}, {0.5, 0.75, 0.5}});
    PlcFacet f;
    f.polygons = {{8, 9, 10}};
    plc.facets.push_back(f);
    const ValidPlc valid = validate(plc);
    EXPECT_EQ(valid.cells.size(), 2U);
    EXPECT_EQ(valid.facets.back().cells[0], valid.facets.back().cells[1]);
}

TEST(Diagnose, NoCell) {
    Plc plc = cube();
    plc.facets.pop_back();
    expect_only_error(plc, DefectKind::no_cell, 1);
    plc = cube();
    plc.hole_seeds.push_back({0.5, 0.5, 0.5});
    expect_only_error(plc, DefectKind::no_cell, 1);
}

TEST(Diagnose, NonPlanarFacetNamesItsWorstVertex) {
    Plc plc = cube();
    // a vertex in the middle of one square, pulled off its plane
    const double x = plc.vertices[plc.facets[0].polygons[0][0]].x;
    plc.vertices.push_back({x + (x == 0 ? -0.01 : 0.01), 0.5, 0.5});
    plc.facets[0].polygons.push_back({8});
    const Diagnosis d = diagnose(plc);
    const Defect* defect = find(d, DefectKind::non_planar_facet);
    ASSERT_NE(defect, nullptr);
    EXPECT_EQ(defect->elements.at(0).number, 0U);
    EXPECT_EQ(defect->elements.at(1).number, 8U);
    EXPECT_GT(defect->value, 0.004);
    EXPECT_LT(defect->value, 0.01);
    MeshOptions tolerant;
    tolerant.coplanar_tolerance = 0.02;
    EXPECT_FALSE(diagnose(plc, tolerant).has_errors());
}

TEST(Diagnose, SelfIntersectionsNameBothFacetsAndAPoint) {
    Plc plc;
    plc.first_number = 1;
    plc.vertices = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0.5, 0.5, -1}, {0.5, 0.5, 1}, {5, 5, 1}};
    for (std::uint32_t i : {0U, 3U}) {
        PlcFacet f;
        f.polygons = {{i, i + 1, i + 2}};
        plc.facets.push_back(f);
    }
    const Diagnosis d = diagnose(plc);
    const Defect* defect = find(d, DefectKind::self_intersection);
    ASSERT_NE(defect, nullptr);
    EXPECT_EQ(defect->elements.at(0).number, 1U);
    EXPECT_EQ(defect->elements.at(1).number, 2U);
    const Vec3 at = defect->elements[0].where.value();
    EXPECT_NEAR(at.z, 0, 1e-15);
    EXPECT_NEAR(at.x - at.y, 0, 1e-15);
    EXPECT_GE(at.x, 0.5 - 1e-15);
    EXPECT_LE(at.x, 1 + 1e-15);
}

TEST(Diagnose, EdgesThroughForeignVerticesAreIntersections) {
    Plc plc = triangulated_box();
    plc.vertices.push_back({0.5, 0.5, 1});  // on a diagonal of the top or its neighbour's
    plc.facets[2].polygons = {{4, 5, 8}};
    PlcFacet f;
    f.polygons = {{5, 7, 8}};
    plc.facets.push_back(f);
    EXPECT_GE(count(diagnose(plc), DefectKind::self_intersection), 1U);
}

TEST(Diagnose, FoldedTrianglesIntersect) {
    Plc plc;
    plc.vertices = {{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, 0.5, 0}};
    for (std::uint32_t apex : {2U, 3U}) {
        PlcFacet f;
        f.polygons = {{0, 1, apex}};
        plc.facets.push_back(f);
    }
    EXPECT_EQ(count(diagnose(plc), DefectKind::self_intersection), 1U);
}

TEST(Diagnose, CrossingEdgesOfOneFacet) {
    Plc plc = cube();
    std::swap(plc.facets[0].polygons[0][1], plc.facets[0].polygons[0][2]);
    EXPECT_GE(count(diagnose(plc), DefectKind::self_intersection), 1U);
}

TEST(Diagnose, VerticesCloserToAFacetThanRounding) {
    // the tip of a pyramid an ulp below the lid of a box that holds it
    Plc plc = triangulated_box();
    const auto first = static_cast<std::uint32_t>(plc.vertices.size());
    plc.vertices.insert(plc.vertices.end(), {{0.2, 0.2, 0.2}, {0.8, 0.2, 0.2}, {0.5, 0.8, 0.2}, {0.5, 0.4, 1 - 0x1p-53}});
    for (const auto& t : {std::array{0U, 1U, 2U}, std::array{0U, 3U, 1U}, std::array{1U, 3U, 2U}, std::array{2U, 3U, 0U}}) {
        PlcFacet f;
        f.polygons = {{first + t[0], first + t[1], first + t[2]}};
        plc.facets.push_back(f);
    }
    expect_only_error(plc, DefectKind::feature_too_thin, 1);
    plc.vertices.back().z = 1 - 1e-9;  // what doubles can hold is fine
    EXPECT_FALSE(diagnose(plc).has_errors()) << listing(diagnose(plc));
}

TEST(Diagnose, Seeds) {
    Plc plc = cube_with_internal_facet();
    plc.region_seeds.push_back({{0.25, 0.5, 0.5}, 9, 0});
    expect_only_error(plc, DefectKind::seed_conflict, 1);
    plc = cube_with_internal_facet();
    plc.region_seeds.push_back({{5, 5, 5}, 9, 0});
    expect_only_error(plc, DefectKind::seed_outside, 1);
    plc = cube_with_internal_facet();
    plc.region_seeds[0].point = {1, 0.5, 0.5};
    expect_only_error(plc, DefectKind::seed_on_facet, 1);
    plc = cube_with_internal_facet();
    plc.hole_seeds.push_back({9, 9, 9});
    const Diagnosis d = diagnose(plc);
    EXPECT_FALSE(d.has_errors());
    EXPECT_EQ(count(d, DefectKind::seed_outside), 1U);
    plc = cube_with_cavity();
    plc.region_seeds.push_back({{1.5, 1.5, 1.5}, 3, 0});
    expect_only_error(plc, DefectKind::seed_outside, 1);
}

TEST(Diagnose, ErrorsComeFirst) {
    Plc plc = cube_with_internal_facet();
    plc.vertices.push_back({17, 0, 0});
    plc.hole_seeds.push_back({9, 9, 9});
    plc.region_seeds.push_back({{5, 5, 5}, 9, 0});
    const Diagnosis d = diagnose(plc);
    ASSERT_EQ(d.defects.size(), 3U) << listing(d);
    EXPECT_EQ(d.defects[0].severity, Severity::error);
    EXPECT_EQ(d.defects[1].severity, Severity::warning);
    EXPECT_EQ(d.defects[2].severity, Severity::note);
}

TEST(Diagnose, MutilatedCubesNeverCrash) {
    // every subset of facets, and every single index replaced by every other
    const Plc whole = cube();
    for (unsigned mask = 0; mask < 64; ++mask) {
        Plc plc = whole;
        plc.facets.clear();
        for (unsigned f = 0; f < 6; ++f)
            if (mask >> f & 1) plc.facets.push_back(whole.facets[f]);
        EXPECT_EQ(diagnose(plc).has_errors(), mask != 63);
    }
    std::size_t valid = 0, cases = 0;
    for (std::size_t f = 0; f < 6; ++f)
        for (std::size_t i = 0; i < 4; ++i)
            for (std::uint32_t v = 0; v < 8; ++v) {
                Plc plc = whole;
                if (plc.facets[f].polygons[0][i] == v) continue;
                plc.facets[f].polygons[0][i] = v;
                valid += !diagnose(plc).has_errors();
                ++cases;
            }
    EXPECT_EQ(cases, 168U);
    EXPECT_EQ(valid, 0U);
}

}  // namespace
}  // namespace wellmesh::testing
