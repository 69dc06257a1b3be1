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
    return read_obj(source_of(text, "f.obj"));
}

void expect_rejected(const std::string& text, std::initializer_list<std::string_view> words) {
    expect_error(ErrorCode::bad_input, words, [&] { (void)read(text); });
}

const std::string kFour = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";

TEST(ReadObj, ReadsASurface) {
    const testing::Surface surface = testing::sample_surface();
    const Plc plc = read(testing::obj_text(surface));
    EXPECT_EQ(plc.vertices, surface.vertices);
    ASSERT_EQ(plc.facets.size(), surface.polygons.size());
    for (std::size_t f = 0; f < plc.facets.size(); ++f) EXPECT_EQ(plc.facets[f].polygons, testing::Polygons{surface.polygons[f]});
    EXPECT_EQ(plc.first_number, 1U);
    EXPECT_EQ(plc.fill, FillRule::nonzero_winding);
    EXPECT_EQ(plc.merge_coplanar, MergeRule::all);
    EXPECT_EQ(plc.vertex_lines[0], 3U);
    EXPECT_EQ(plc.facet_lines[0], 11U);
}

TEST(ReadObj, ReadsEveryKindOfCorner) {
    using Polygon = std::vector<std::uint32_t>;
    const Plc plc = read(
        kFour + "f 1 2 3\nf 1/7 2/8 3/9\nf 1/7/1 2/8/1 3/9/1\nf 1//5 2//5 3//5\nf -4 -3 -2\nf -4/-1/-1 \\\n -3/-1/-1 \\\r\n-2/-1/-1\nf 1/ 2/ 3/\n");
    ASSERT_EQ(plc.facets.size(), 7U);
    for (const PlcFacet& facet : plc.facets) EXPECT_EQ(facet.polygons, std::vector<Polygon>{Polygon({0, 1, 2})});
    EXPECT_EQ(read("f 1 2 3\n" + kFour).facets.size(), 1U) << "vertices may follow";
}

TEST(ReadObj, GroupsBecomeMarkers) {
    const std::string face = "f 1 2 3\n";
    const auto markers = [&](const std::string& text) {
        std::vector<std::int32_t> out;
        for (const PlcFacet& facet : read(kFour + text).facets) out.push_back(facet.marker);
        return out;
    };
    EXPECT_EQ(markers("o a\ng b\nusemtl c#1\n" + face + face), (std::vector<std::int32_t>{0, 0}));
    EXPECT_EQ(markers("usemtl c#1\n" + face + "usemtl c#2\n" + face + "usemtl c#1\n" + face), (std::vector<std::int32_t>{1, 2, 1}));
    EXPECT_EQ(markers("g a b\n" + face + "o x\n" + face + "g\n" + face), (std::vector<std::int32_t>{1, 2, 3}));
    EXPECT_EQ(markers("g empty\ng a\n" + face), (std::vector<std::int32_t>{0})) << "groups without faces do not count";
}

TEST(ReadObj, LinesAreSegmentsAndExtrasArePassedOver) {
    const Plc plc = read("mtllib a.mtl\ns off\nvn 0 0 1\nvt 0 0\nv 0 0 0 1.0\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0\nl 1 2/1 3\np 1\ncstype bezier\n");
    ASSERT_EQ(plc.segments.size(), 2U);
    EXPECT_EQ(plc.segments[1].vertices, (std::array<std::uint32_t, 2>{1, 2}));
}

TEST(ReadObj, RejectsWithPlaceAndToken) {
    expect_rejected(kFour + "f 1 2 5\nf 1 2 9\n", {"f.obj:6:", "vertex 9", "1 to 4"});
    expect_rejected(kFour + "f 1 2 0\n", {"f.obj:5:", "vertex 0"});
    expect_rejected(kFour + "f 1 2 -5\n", {"f.obj:5:", "vertex -5", "4"});
    expect_rejected(kFour + "f 1 2 x\n", {"f.obj:5:", "'x'"});
    expect_rejected(kFour + "f 1 2 3/a\n", {"f.obj:5:", "'3/a'"});
    expect_rejected(kFour + "f 1 2 /3\n", {"f.obj:5:", "vertex number"});
    expect_rejected("v 1 2\nv 1 2 3\n", {"f.obj:1:", "coordinate", "line ends"});
    expect_rejected("v 1 2 inf\n", {"f.obj:1:", "'inf'"});
    expect_rejected("v 1 2 3 red\n", {"f.obj:1:", "'red'"});
    expect_rejected("v 1 2 3\nhello\n", {"f.obj:2:", "'hello'"});
    expect_rejected("# nothing\n", {"'v' statements"});
}

}  // namespace
}  // namespace wellmesh::io
