// SPDX-License-Identifier: Apache-2.0
// Conformity: the same mesh against PLCs that it does, or does not, fill.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include <algorithm>
#include <limits>
#include <string>

#include "brute_force.hpp"
#include "core/vec3_math.hpp"
#include "wellmesh/certificate.hpp"

namespace wellmesh {
namespace {

using testing::BoxMesh;
using testing::two_region_box;

Claim::State state(const Certificate& c, const char* name) { return c.find(name)->state; }
std::uint64_t violations(const BoxMesh& box, const char* name, const CertifyOptions& options = {}) { return certify(box.mesh, options, &box.plc).find(name)->violations; }

std::uint32_t add_vertex(Plc& plc, const Vec3& p) {
    plc.vertices.push_back(p);
    return static_cast<std::uint32_t>(plc.vertices.size() - 1);
}

TEST(PlcClaims, VolumesComeFromTheFacets) {
    BoxMesh box = two_region_box();
    const Certificate certificate = certify(box.mesh, {}, &box.plc);
    ASSERT_EQ(certificate.regions.size(), 2U);
    for (const RegionVolume& r : certificate.regions) {
        EXPECT_NEAR(r.volume, 8, 1e-13);
        EXPECT_NEAR(*r.plc_volume, 8, 1e-13);
    }
    // The orientation of facets does not matter.
    for (std::size_t f = 0; f < box.plc.facets.size(); f += 2) std::reverse(box.plc.facets[f].polygons[0].begin(), box.plc.facets[f].polygons[0].end());
    for (const RegionVolume& r : certify(box.mesh, {}, &box.plc).regions) EXPECT_NEAR(*r.plc_volume, 8, 1e-13);
}

TEST(PlcClaims, MissingFacetOfThePlc) {
    BoxMesh box = two_region_box();
    box.plc.facets.erase(box.plc.facets.begin() + 1);  // the one between the regions
    const Certificate c = certify(box.mesh, {}, &box.plc);
    EXPECT_EQ(state(c, "plc_distance"), Claim::State::refuted);
    EXPECT_EQ(state(c, "plc_area"), Claim::State::refuted);
    EXPECT_EQ(state(c, "region_volumes"), Claim::State::refuted);
}

TEST(PlcClaims, FacetThatTheMeshIgnores) {
    BoxMesh box = two_region_box();
    const std::uint32_t a = add_vertex(box.plc, {0.5, 0.5, 0.5}), b = add_vertex(box.plc, {1.5, 0.5, 0.5}), c = add_vertex(box.plc, {1, 1.5, 0.7});
    box.plc.facets.push_back({{{a, b, c}}, {}, 0});
    const Certificate certificate = certify(box.mesh, {}, &box.plc);
    EXPECT_EQ(certificate.find("plc_area")->violations, 1U);
    EXPECT_EQ(certificate.find("plc_area")->witness->number, box.plc.facets.size());
    EXPECT_EQ(certificate.find("plc_vertices")->violations, 3U);
    EXPECT_EQ(certificate.find("plc_segments")->violations, 3U);
    EXPECT_EQ(state(certificate, "plc_distance"), Claim::State::proven);
    EXPECT_EQ(state(certificate, "region_volumes"), Claim::State::proven);
}

TEST(PlcClaims, FacetListedTwiceIsOneFacet) {
    for (const bool turned : {false, true}) {
        BoxMesh box = two_region_box();
        PlcFacet again = box.plc.facets.front();
        if (turned) std::reverse(again.polygons[0].begin(), again.polygons[0].end());
        std::rotate(again.polygons[0].begin(), again.polygons[0].begin() + 1, again.polygons[0].end());
        box.plc.facets.push_back(again);
        EXPECT_TRUE(certify(box.mesh, {}, &box.plc).proven()) << turned;
    }
}

TEST(PlcClaims, FinIsForgivenAndDoesNotBreakTheShell) {
    BoxMesh box = two_region_box();
    const std::vector<std::uint32_t> wall = box.plc.facets.front().polygons[0];
    const Vec3 p = box.plc.vertices[wall[0]], q = box.plc.vertices[wall[1]];
    const Vec3 out{p.x + q.x - 1, p.y + q.y - 1, p.z + q.z - 1.5};
    const std::uint32_t tip = add_vertex(box.plc, {10 * out.x, 10 * out.y, 10 * out.z});
    box.plc.facets.push_back({{{wall[0], wall[1], tip}}, {}, 0});
    EXPECT_EQ(state(certify(box.mesh, {}, &box.plc), "plc_filled"), Claim::State::proven);
}

TEST(PlcClaims, FacetsOutsideTheMeshAreForgivenIfCellsMayBeLeftOut) {
    BoxMesh box = two_region_box();
    const std::uint32_t a = add_vertex(box.plc, {10, 0, 0}), b = add_vertex(box.plc, {11, 0, 0}), c = add_vertex(box.plc, {10, 1, 0}), d = add_vertex(box.plc, {10, 0, 1});
    const std::uint32_t e = add_vertex(box.plc, {9, 0, 0});
    const std::size_t first = box.plc.facets.size();
    for (const std::array<std::uint32_t, 3>& corners : {std::array{a, b, c}, std::array{a, b, d}, std::array{a, c, d}, std::array{b, c, d}, std::array{a, c, e}})
        box.plc.facets.push_back({{{corners[0], corners[1], corners[2]}}, {}, 0});
    Certificate certificate = certify(box.mesh, {}, &box.plc);
    EXPECT_EQ(certificate.find("plc_filled")->violations, 4U) << "four bound a cell, the fifth is a fin";
    EXPECT_EQ(certificate.find("plc_filled")->witness->number, first + 1);
    EXPECT_NE(certificate.find("plc_area")->detail.find("outside the mesh 2.86603"), std::string::npos) << certificate.find("plc_area")->detail;
    for (const char* name : {"plc_distance", "plc_area", "plc_vertices", "plc_segments", "region_volumes"}) EXPECT_EQ(state(certificate, name), Claim::State::proven) << name;
    box.plc.hole_seeds.push_back({10.1, 0.1, 0.1});
    certificate = certify(box.mesh, {}, &box.plc);
    EXPECT_TRUE(certificate.proven());
    EXPECT_EQ(state(certificate, "plc_filled"), Claim::State::not_checked);
    box.plc.hole_seeds.push_back({3, 0.5, 0.5});
    certificate = certify(box.mesh, {}, &box.plc);
    EXPECT_EQ(certificate.find("holes_empty")->violations, 1U);
    EXPECT_EQ(certificate.find("holes_empty")->witness->number, 2U);
}

TEST(PlcClaims, CellThatIsNotFilled) {
    BoxMesh box = two_region_box();
    TetMesh half;
    half.vertices.assign(box.mesh.vertices.begin(), box.mesh.vertices.begin() + 27);
    for (std::size_t t = 0; t < box.mesh.tets.size(); ++t)
        if (box.mesh.tet_regions[t] == 1) {
            half.tets.push_back(box.mesh.tets[t]);
            half.tet_regions.push_back(1);
        }
    Certificate certificate = certify(half, {}, &box.plc);
    EXPECT_EQ(certificate.find("plc_filled")->violations, 10U);  // five facets of two triangles
    box.plc.hole_seeds.push_back({3, 1, 1});
    EXPECT_TRUE(certify(half, {}, &box.plc).proven());
}

TEST(PlcClaims, CoplanarNeighboursMayBeMerged) {
    // A side facet cut by a diagonal into two facets: the mesh has no edge along it, and need not.
    BoxMesh box = two_region_box();
    const auto square = box.plc.facets[3].polygons[0];
    box.plc.facets[3].polygons[0] = {square[0], square[1], square[2]};
    box.plc.facets.push_back({{{square[0], square[2], square[3]}}, {}, 0});
    EXPECT_TRUE(certify(box.mesh, {}, &box.plc).proven());
    // As a slit within one facet, it is a constraint.
    box = two_region_box();
    box.plc.facets[3].polygons.push_back({square[0], square[2]});
    EXPECT_EQ(violations(box, "plc_segments"), 1U);
    EXPECT_EQ(violations(box, "plc_distance"), 0U);
}

TEST(PlcClaims, SegmentsThatBoundNoFacet) {
    BoxMesh box = two_region_box();
    // A chain of one mesh edge, and the two ends of the box that no edge joins.
    const auto& tet = box.mesh.tets[0];
    const std::uint32_t a = add_vertex(box.plc, box.mesh.vertices[tet[0]]), b = add_vertex(box.plc, box.mesh.vertices[tet[1]]);
    box.plc.segments.push_back({{a, b}, 0});
    EXPECT_TRUE(certify(box.mesh, {}, &box.plc).proven());
    box.plc.segments.push_back({{0, 11}, 0});
    EXPECT_EQ(violations(box, "plc_segments"), 1U);
}

TEST(PlcClaims, IsolatedVertices) {
    BoxMesh box = two_region_box();
    add_vertex(box.plc, box.mesh.vertices[13]);
    EXPECT_TRUE(certify(box.mesh, {}, &box.plc).proven());
    add_vertex(box.plc, {1, 1.05, 1.01});
    EXPECT_EQ(violations(box, "plc_isolated_vertices"), 1U);
    add_vertex(box.plc, {-1, 1.05, 1.01});  // outside
    EXPECT_EQ(violations(box, "plc_isolated_vertices"), 1U);
    box.plc.fill = FillRule::nonzero_winding;  // now it is a leftover of a surface file
    EXPECT_EQ(violations(box, "plc_isolated_vertices"), 0U);
    const std::uint32_t n = static_cast<std::uint32_t>(box.plc.vertices.size());
    box.plc.segments.push_back({{n - 2, n - 1}, 0});
    EXPECT_EQ(violations(box, "plc_isolated_vertices"), 1U);
}

TEST(PlcClaims, ToleranceIsRelativeToTheDiagonal) {
    BoxMesh box = two_region_box();
    box.mesh.vertices[16].y += 1e-6;
    EXPECT_GT(violations(box, "plc_distance"), 0U);
    CertifyOptions loose;
    loose.tolerance = 1e-6;  // 4.9e-6 in input units
    EXPECT_EQ(violations(box, "plc_distance", loose), 0U);
    EXPECT_EQ(violations(box, "region_volumes", loose), 0U);
}

TEST(PlcClaims, WhatCannotBeReadIsNotChecked) {
    for (const int way : {0, 1, 2, 3}) {
        BoxMesh box = two_region_box();
        if (way == 0) box.plc.facets[0].polygons[0][0] = 99;
        if (way == 1) box.plc.vertices[0].x = std::numeric_limits<double>::quiet_NaN();
        if (way == 2) box.plc.facets.clear();
        if (way == 3) box.plc.facets[0].polygons.emplace_back();
        const Certificate c = certify(box.mesh, {}, &box.plc);
        for (const char* name : {"plc_distance", "plc_area", "plc_vertices", "plc_segments", "plc_isolated_vertices", "plc_filled", "holes_empty", "region_volumes"}) {
            EXPECT_EQ(state(c, name), Claim::State::not_checked) << way;
            EXPECT_FALSE(c.find(name)->detail.empty());
        }
    }
}

TEST(PlcClaims, VerticesAreComparedByPlace) {
    BoxMesh box = two_region_box();
    box.plc.vertices[0] = {-0.0, 0.0, -0.0};
    EXPECT_TRUE(certify(box.mesh, {}, &box.plc).proven());
    box.plc.vertices[0].x = 1e-300;  // counts as zero, like everything below the exact range
    EXPECT_TRUE(certify(box.mesh, {}, &box.plc).proven());
    box.plc.first_number = 1;
    box.plc.vertices[0].x = 1e-13;
    const Certificate c = certify(box.mesh, {}, &box.plc);
    EXPECT_EQ(c.find("plc_vertices")->violations, 1U);
    EXPECT_EQ(c.find("plc_vertices")->witness->number, 1U);
}

}  // namespace
}  // namespace wellmesh
