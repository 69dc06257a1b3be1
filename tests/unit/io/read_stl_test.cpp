// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "io/readers.hpp"
#include "sample_files.hpp"

namespace wellmesh::io {
namespace {

using testing::expect_error;
using testing::source_of;

Plc read(const std::string& bytes) {
    return read_stl(source_of(bytes, "f.stl"));
}

void expect_rejected(const std::string& bytes, std::initializer_list<std::string_view> words) {
    expect_error(ErrorCode::bad_input, words, [&] { (void)read(bytes); });
}

/// The corners of every facet, which is all that STL states.
std::vector<std::vector<Vec3>> corners(const Plc& plc) {
    std::vector<std::vector<Vec3>> out;
    for (const PlcFacet& facet : plc.facets)
        for (const auto& v : out.emplace_back(), facet.polygons.front()) out.back().push_back(plc.vertices[v]);
    return out;
}

std::vector<std::vector<Vec3>> corners(const testing::Surface& surface) {
    std::vector<std::vector<Vec3>> out;
    for (const auto& polygon : surface.polygons)
        for (const auto v : out.emplace_back(), polygon) out.back().push_back(surface.vertices[v]);
    return out;
}

TEST(ReadStl, ReadsTextAndMergesVertices) {
    const testing::Surface surface = testing::triangulated(testing::sample_surface());
    const Plc plc = read(testing::stl_text(surface));
    EXPECT_EQ(corners(plc), corners(surface));
    EXPECT_EQ(plc.vertices.size(), 8U);
    EXPECT_EQ(plc.relative_rounding, 0);
    EXPECT_EQ(plc.fill, FillRule::nonzero_winding);
    EXPECT_EQ(plc.merge_coplanar, MergeRule::all);
    EXPECT_EQ(plc.vertex_lines.size(), 8U);
    EXPECT_EQ(plc.facet_lines.front(), 2U);
    for (const PlcFacet& facet : plc.facets) EXPECT_EQ(facet.marker, 0);
}

TEST(ReadStl, ReadsBinaryThatBeginsWithSolid) {
    const testing::Surface surface = testing::triangulated(testing::sample_surface(true));
    const Plc plc = read(testing::stl_binary(surface));
    EXPECT_EQ(corners(plc), corners(surface));
    EXPECT_EQ(plc.vertices.size(), 8U);
    EXPECT_EQ(plc.relative_rounding, 0x1p-24);
    EXPECT_TRUE(plc.vertex_lines.empty());
}

TEST(ReadStl, NegativeZeroIsZero) {
    const Plc plc = read("solid\nfacet normal nan nan nan\nouter loop\nvertex 0 0 0\nvertex -0 1 0\nvertex 1 -0.0 0\nendloop\nendfacet\n"
                         "facet normal 0 0 1\nouter loop\nvertex -0 -0 -0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid\n");
    EXPECT_EQ(plc.vertices.size(), 3U);
    for (const Vec3& p : plc.vertices) EXPECT_FALSE(std::signbit(p.x) || std::signbit(p.y) || std::signbit(p.z));
}

TEST(ReadStl, SolidsBecomeMarkers) {
    const std::string facet = "FACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1 0\nENDLOOP\nENDFACET\n";
    const Plc plc = read("solid a\n" + facet + facet + "endsolid a\nSolid solid facet\n" + facet + "endsolid\n\n");
    ASSERT_EQ(plc.facets.size(), 3U);
    EXPECT_EQ(plc.facets[0].marker, 1);
    EXPECT_EQ(plc.facets[1].marker, 1);
    EXPECT_EQ(plc.facets[2].marker, 2);
}

TEST(ReadStl, ToleratesWhatWritersLeaveOut) {
    const Plc plc = read("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
                         "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendsolidname\n");
    EXPECT_EQ(plc.facets.size(), 2U);
}

TEST(ReadStl, RejectsBrokenText) {
    const std::string head = "solid s\nfacet normal 0 0 1\nouter loop\n";
    expect_rejected(head + "vertex 0 0 blah\n", {"f.stl:4:", "'blah'", "coordinate"});
    expect_rejected(head + "vertex 0 0\nvertex 1 1 1\n", {"f.stl:5:", "'vertex'"});
    expect_rejected(head + "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop foo\nendfacet\n", {"f.stl:7:", "'foo'"});
    expect_rejected(head + "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n", {"f.stl:9:", "file ends", "endsolid"});
    expect_rejected("solid s\nendsolid s\njunk\n", {"f.stl:3:", "'junk'"});
    expect_rejected("hello world", {"neither text STL"});
    expect_rejected("solid s\nfacet", {"'normal'", "file ends"});
}

TEST(ReadStl, RejectsBrokenBinary) {
    const std::string whole = testing::stl_binary(testing::triangulated(testing::sample_surface(true)));
    expect_rejected(whole.substr(0, whole.size() - 1), {"byte 80", "12 triangles"});
    expect_rejected(whole + "x", {"byte 80", "12 triangles"});
    std::string nan = whole;
    nan.replace(84 + 50 + 12, 4, "\xff\xff\xff\x7f");
    expect_rejected(nan, {"triangle 2", "byte 146", "finite"});
}

}  // namespace
}  // namespace wellmesh::io
