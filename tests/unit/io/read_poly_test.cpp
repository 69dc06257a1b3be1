// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "io/readers.hpp"
#include "sample_files.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::io {
namespace {

using testing::expect_error;
using testing::source_of;
using Polygon = std::vector<std::uint32_t>;

Plc poly(const std::string& text) {
    return read_poly(source_of(text, "f.poly"));
}

Plc smesh(const std::string& text) {
    return read_smesh(source_of(text, "f.smesh"));
}

void expect_rejected(const std::string& text, std::initializer_list<std::string_view> words) {
    expect_error(ErrorCode::bad_input, words, [&] { (void)poly(text); });
}

const std::string kFour = "4 3 0 0\n1 0 0 0\n2 4 0 0\n3 0 4 0\n4 0 0 4\n";

TEST(ReadPoly, ReadsEveryPart) {
    const Plc plc = poly(
        "# a comment\n"
        "5 3 2 1 # points\n"
        "0 0 0 0  1.5 2 7\n\n1 4 0 0  1.5 2 -8\n2 4 4 0 0 0 9\n3 0 4 0 0 0 9\n4 2 2 0 0 0 9\n"
        "3 1\n"
        "3 1 -5  # three polygons, one hole\n"
        "4 0 1\n 2 # goes on\n 3\n"
        "2 0 4\n"
        "1 4\n"
        "1 0.5 0.25 0\n"
        "1\n3 0 1 2\n"
        "2 0 6\n2 0 1\n2 1 2\n"
        "1\n1 9 9 9\n"
        "2\n1 1 1 1 -10 0.01\n2 2 2 2 20\n");
    EXPECT_EQ(plc.vertices.size(), 5U);
    EXPECT_EQ(plc.vertex_markers, (std::vector<std::int32_t>{7, -8, 9, 9, 9}));
    ASSERT_EQ(plc.facets.size(), 2U);
    EXPECT_EQ(plc.facets[0].polygons, (std::vector<Polygon>{{0, 1, 2, 3}, {0, 4}, {4}}));
    EXPECT_EQ(plc.facets[0].holes, (std::vector<Vec3>{{0.5, 0.25, 0}}));
    EXPECT_EQ(plc.facets[0].marker, -5);
    EXPECT_EQ(plc.facets[1].marker, 0);
    ASSERT_EQ(plc.segments.size(), 2U) << "a facet of two-vertex polygons alone is segments";
    EXPECT_EQ(plc.segments[1].vertices, (std::array<std::uint32_t, 2>{1, 2}));
    EXPECT_EQ(plc.segments[1].marker, 6);
    EXPECT_EQ(plc.hole_seeds, (std::vector<Vec3>{{9, 9, 9}}));
    ASSERT_EQ(plc.region_seeds.size(), 2U);
    EXPECT_EQ(plc.region_seeds[0].id, -10);
    EXPECT_EQ(plc.region_seeds[0].max_volume, 0.01);
    EXPECT_EQ(plc.region_seeds[1].max_volume, 0);
    EXPECT_EQ(plc.fill, FillRule::bounded_cells);
    EXPECT_EQ(plc.merge_coplanar, MergeRule::triangles);
    EXPECT_EQ(plc.first_number, 0U);
    EXPECT_EQ(plc.vertex_lines, (std::vector<std::uint32_t>{3, 5, 6, 7, 8}));
    EXPECT_EQ(plc.facet_lines, (std::vector<std::uint32_t>{10, 17}));
}

TEST(ReadPoly, ReadsSmesh) {
    const testing::Surface surface = testing::sample_surface();
    for (const std::uint32_t first : {0U, 1U, 42U}) {
        const Plc plc = smesh(testing::poly_text(surface, true, first));
        EXPECT_EQ(plc.vertices, surface.vertices);
        ASSERT_EQ(plc.facets.size(), surface.polygons.size());
        for (std::size_t f = 0; f < plc.facets.size(); ++f) {
            EXPECT_EQ(plc.facets[f].polygons, testing::Polygons{surface.polygons[f]});
            EXPECT_EQ(plc.facets[f].marker, static_cast<std::int32_t>(f + 10));
        }
        EXPECT_EQ(plc.first_number, std::min(first, 1U));
    }
    EXPECT_EQ(smesh(kFour + "1 0\n3 1 2 3 77\n").facets[0].marker, 0) << "a marker column that the header does not state";
}

TEST(ReadPoly, LaterPartsMayBeMissing) {
    const std::string facets = "1 0\n1\n3 1 2 3\n";
    EXPECT_EQ(poly(kFour + facets).facets.size(), 1U);
    EXPECT_EQ(poly(kFour + facets + "0\n").facets.size(), 1U);
    EXPECT_EQ(poly(kFour + facets + "0\n0\n\nremarks: /* anything */ 1 2 3\n").facets.size(), 1U);
    EXPECT_EQ(poly("4\n1,0,0,0\n2,4,0,0\n3,0,4,0\n4,0,0,4\n" + facets).vertices.size(), 4U) << "commas; a header with the count alone";
}

TEST(ReadPoly, TakesPointsFromTheNodeFileBeside) {
    const testing::TemporaryDirectory directory;
    const auto path = directory.write("a.b.poly", "0 3 0 0\n1 0\n1\n3 1 2 3\n");
    expect_error(ErrorCode::cannot_read, {"a.b.node"}, [&] { (void)wellmesh::read_plc(path); });
    directory.write("a.b.node", kFour);
    const Plc plc = wellmesh::read_plc(path);
    EXPECT_EQ(plc.vertices.size(), 4U);
    EXPECT_TRUE(plc.vertex_lines.empty());
    EXPECT_EQ(plc.facet_lines, (std::vector<std::uint32_t>{3}));
}

TEST(ReadPoly, VertexNumbersAreAsTheListStates) {
    const Plc plc = poly("4 3 0 0\n10 0 0 0\n30 4 0 0\n20 0 4 0\n7 0 0 4\n1 0\n1\n3 7 30 20\n");
    EXPECT_EQ(plc.facets[0].polygons[0], (Polygon{3, 1, 2}));
}

TEST(ReadPoly, RepeatedNumbersAreRefusedAndGapsCounted) {
    const std::string twice = "4 3 0 0\n1 0 0 0\n2 4 0 0\n1 0 4 0\n2 0 0 4\n1 0\n1\n";
    expect_rejected(twice + "3 1 3 4\n", {"f.poly:4", "repeats"});
    const std::string gap = "4 3 0 0\n1 0 0 0\n2 4 0 0\n3 0 4 0\n9 0 0 4\n1 0\n1\n";
    EXPECT_EQ(poly(gap + "3 1 2 9\n").facets[0].polygons[0], (Polygon{0, 1, 3}));
    EXPECT_EQ(poly(gap + "3 1 2 4\n").facets[0].polygons[0], (Polygon{0, 1, 3})) << "the list lacks 4, counting finds it";
    expect_rejected(gap + "3 4 2 9\n", {"f.poly:7:", "f.poly:5"});
}

TEST(ReadPoly, RejectsWithPlaceAndToken) {
    expect_rejected("1 2 0 0\n1 0.5 0.5\n", {"dimension is 2"});
    expect_rejected("4 3 0 2\n1 0 0 0\n2 0 0 0\n3 0 0 0\n4 0 0 0\n", {"f.poly:1:", "0 or 1"});
    expect_rejected("2 3 0 0\n1 0 0\n2 0 0 0 0 0 0\n", {"f.poly:2:", "line ends"});
    expect_rejected("1 3 1 0\n1 0 0 0\n", {"f.poly:2:", "attribute"});
    expect_rejected("1 3 0 1\n1 0 0 0\n", {"f.poly:2:", "marker"});
    expect_rejected("1 3 0 0\n1 0 zero 0\n", {"f.poly:2:", "'zero'"});
    expect_rejected(kFour, {"number of facets", "file ends"});
    expect_rejected(kFour + "9999999999 0\n", {"f.poly:6:", "9999999999"});
    expect_rejected(kFour + "1 0\n1\n3 1 2 5\n", {"f.poly:8:", "vertex 5", "1 to 4"});
    expect_rejected(kFour + "1 0\n1\n3 0 1 2\n", {"f.poly:8:", "vertex 0", "1 to 4"});
    expect_rejected(kFour + "1 0\n1\n3 1 2 3 4\n", {"f.poly:8:", "'4'", "line to end"});
    expect_rejected(kFour + "1 0\n1 0 3 9\n3 1 2 3\n", {"f.poly:7:", "'9'"});
    expect_rejected(kFour + "2 0\n1\n3 1 2 3\n", {"polygons", "file ends"});
    expect_rejected(kFour + "1 0\n1\n3 1 2 3\n1\n1 0 0\n", {"coordinate", "file ends"});
    expect_rejected(kFour + "1 0\n1\n3 1 2 3\n0\n1\n1 0 0 0 1.5\n", {"f.poly:11:", "'1.5'", "integer region attribute"});
    expect_rejected(kFour + "1 0\n1\n3 1 2 3\n0\n1\n1 0 0 0 99999999999\n", {"32 bits"});
    expect_error(ErrorCode::bad_input, {"f.smesh:7:"}, [&] { (void)smesh(kFour + "1 1\n3 1 2 3 7 8\n"); });
}

}  // namespace
}  // namespace wellmesh::io
