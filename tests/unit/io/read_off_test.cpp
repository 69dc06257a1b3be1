// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "io/readers.hpp"
#include "sample_files.hpp"

namespace wellmesh::io {
namespace {

using testing::expect_error;
using testing::source_of;

Plc read(const std::string& text) {
    return read_off(source_of(text, "f.off"));
}

void expect_rejected(const std::string& text, std::initializer_list<std::string_view> words) {
    expect_error(ErrorCode::bad_input, words, [&] { (void)read(text); });
}

TEST(ReadOff, ReadsASurface) {
    const testing::Surface surface = testing::sample_surface();
    const Plc plc = read(testing::off_text(surface));
    EXPECT_EQ(plc.vertices, surface.vertices);
    ASSERT_EQ(plc.facets.size(), surface.polygons.size());
    for (std::size_t f = 0; f < plc.facets.size(); ++f) {
        EXPECT_EQ(plc.facets[f].polygons, testing::Polygons{surface.polygons[f]});
        EXPECT_EQ(plc.facets[f].marker, 0);
    }
    EXPECT_EQ(plc.fill, FillRule::nonzero_winding);
    EXPECT_EQ(plc.merge_coplanar, MergeRule::all);
    EXPECT_EQ(plc.relative_rounding, 0);
    EXPECT_EQ(plc.source_name, "f.off");
    EXPECT_EQ(plc.first_number, 0U);
    ASSERT_EQ(plc.vertex_lines.size(), 8U);
    EXPECT_EQ(plc.vertex_lines[0], 3U);
    EXPECT_EQ(plc.facet_lines[0], 11U);
}

TEST(ReadOff, AcceptsItsVariants) {
    const char* const body = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n";
    for (const char* const head : {"OFF\n4 1 0\n", "OFF 4 1 0\n", "OFF 4 1\n", "# c\nOFF # c\n# c\n\n4 1 6 # c\n", "\xef\xbb\xbfOFF\r\n4 1 0\r\n"}) {
        const Plc plc = read(std::string(head) + body);
        EXPECT_EQ(plc.vertices.size(), 4U) << head;
        EXPECT_EQ(plc.facets.size(), 1U) << head;
    }
    const Plc colours = read("STCNOFF\n3 2 0\n0 0 0  0 0 1  255 0 0 255  0.5 0.5\n1 0 0 0 0 1\n0 1 -0.0\n3 0 1 2 255 0 0\n3 2 1 0 0.1 0.2 0.3 1.0\n");
    EXPECT_EQ(colours.facets.size(), 2U);
    EXPECT_FALSE(std::signbit(colours.vertices[2].z));
    EXPECT_EQ(read("OFF\n0 0 0\n").facets.size(), 0U);
}

TEST(ReadOff, KeepsFacetsWithTooFewVertices) {
    const Plc plc = read("OFF\n2 3 0\n0 0 0\n1 0 0\n2 0 1\n1 1\n0\n");
    ASSERT_EQ(plc.facets.size(), 3U);
    EXPECT_EQ(plc.facets[0].polygons[0].size(), 2U);
    EXPECT_TRUE(plc.facets[2].polygons[0].empty());
}

TEST(ReadOff, RejectsWithPlaceAndToken) {
    expect_rejected("PLY\n", {"f.off:1:", "'PLY'", "OFF"});
    expect_rejected("4OFF\n", {"three coordinates"});
    expect_rejected("OFF BINARY\n3 1 0\n", {"binary OFF"});
    expect_rejected("OFF\n", {"file ends"});
    expect_rejected("OFF\n3\n0 0 0 1 0 0 0 1 0\n", {"f.off:2:", "number of faces"});
    expect_rejected("OFF\n3 1 0 9\n0 0 0 1 0 0 0 1 0\n3 0 1 2\n", {"f.off:2:", "'9'"});
    expect_rejected("OFF\n3 1 0\n0 0 0\n1 0 0\n0 one 0\n3 0 1 2\n", {"f.off:5:", "'one'", "coordinate"});
    expect_rejected("OFF\n3 1 0\n0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n", {"f.off:5:", "'nan'", "finite"});
    expect_rejected("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", {"f.off:6:", "vertex 3", "0 to 2"});
    expect_rejected("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", {"f.off:6:", "vertex -1"});
    expect_rejected("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", {"vertex number", "file ends"});
    expect_rejected("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 2 1\n", {"f.off:7:", "nothing after the 1 faces"});
    expect_rejected("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 red\n", {"f.off:6:", "'red'", "colour"});
    expect_rejected("OFF\n353535235358 6 0\n0 0 0\n", {"f.off:2:", "353535235358"});
    expect_rejected("OFF\n1 1 0\n0 0 0\n4000000000 0 0 0\n", {"f.off:4:", "4000000000"});
}

}  // namespace
}  // namespace wellmesh::io
