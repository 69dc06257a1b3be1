// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "io/readers.hpp"
#include "sample_files.hpp"

namespace wellmesh::io {
namespace {

using testing::expect_error;
using testing::source_of;

Plc read(const std::string& bytes) {
    return read_ply(source_of(bytes, "f.ply"));
}

void expect_rejected(const std::string& bytes, std::initializer_list<std::string_view> words) {
    expect_error(ErrorCode::bad_input, words, [&] { (void)read(bytes); });
}

std::string text_ply(const std::string& elements, const std::string& data) {
    return "ply\nformat ascii 1.0\n" + elements + "end_header\n" + data;
}
const std::string kVertex3 = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kFace1 = "element face 1\nproperty list uchar int vertex_index\n";
const std::string kPoints = "0 0 0\n1 0 0\n0 1 0\n";

TEST(ReadPly, ReadsEveryFormat) {
    for (const bool as_double : {false, true})
        for (const char* const format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
            const testing::Surface surface = testing::sample_surface(!as_double);
            const Plc plc = read(testing::ply_bytes(surface, format, as_double));
            EXPECT_EQ(plc.vertices, surface.vertices) << format;
            ASSERT_EQ(plc.facets.size(), surface.polygons.size()) << format;
            for (std::size_t f = 0; f < plc.facets.size(); ++f) EXPECT_EQ(plc.facets[f].polygons, testing::Polygons{surface.polygons[f]}) << format;
            EXPECT_EQ(plc.relative_rounding, as_double ? 0 : 0x1p-24) << format;
            EXPECT_EQ(plc.merge_coplanar, MergeRule::all);
            EXPECT_EQ(plc.vertex_lines.empty(), std::string_view(format) != "ascii");
        }
}

TEST(ReadPly, AcceptsItsVariants) {
    EXPECT_EQ(read(text_ply(kVertex3 + kFace1, kPoints + "3 0 1 2\n")).facets.size(), 1U);
    EXPECT_EQ(read(text_ply(kFace1 + kVertex3, "3 0 1 2\n" + kPoints)).facets.size(), 1U) << "faces may stand first";
    EXPECT_EQ(read(text_ply("element nothing 99999999999999\n" + kVertex3 + kFace1, kPoints + "3 0 1 2\n")).facets.size(), 1U)
        << "elements without properties take no bytes";
    EXPECT_EQ(read(text_ply(kVertex3 + "property float nx\n" + kFace1, "0 0 0 nan\n1 0 0 nan\n0 1 0 nan\n3 0 1 2")).facets.size(), 1U);
    std::string windows = testing::ply_bytes(testing::sample_surface(), "binary_little_endian", true);
    const std::size_t end = windows.find("end_header\n") + 10;
    for (std::size_t i = windows.find('\n'); i <= end; i = windows.find('\n', i + 2)) windows.insert(i, "\r");
    EXPECT_EQ(read(windows).vertices, testing::sample_surface().vertices) << "CR LF in the header";
}

TEST(ReadPly, ReadsPointsWithoutFaces) {
    EXPECT_EQ(read_ply_points(source_of(text_ply(kVertex3, kPoints))).size(), 3U);
    expect_rejected(text_ply(kVertex3, kPoints), {"'face'"});
}

TEST(ReadPly, RejectsWithPlaceAndToken) {
    expect_rejected("OFF\n", {"f.ply:1:", "'ply'"});
    expect_rejected("ply\nformat ascii 2.0\n", {"f.ply:2:", "'2.0'"});
    expect_rejected("ply\nformat binary 1.0\n", {"f.ply:2:", "'binary'"});
    expect_rejected("ply\nelement vertex 1\nend_header\n", {"format"});
    expect_rejected("ply\nformat ascii 1.0\nproperty float x\n", {"f.ply:3:", "before the first element"});
    expect_rejected(text_ply("element vertex -1\n", ""), {"f.ply:3:", "-1"});
    expect_rejected(text_ply("element vertex 1\nproperty real x\n", ""), {"f.ply:4:", "'real'"});
    expect_rejected(text_ply("element vertex 1\nproperty list float int x\n", ""), {"f.ply:4:", "list"});
    expect_rejected(text_ply("element vertex 1\nproperty float x\nproperty float y\n", "0 0\n"), {"'z'"});
    expect_rejected("ply\nformat ascii 1.0\nelement vertex 3\n", {"end_header", "file ends"});
    expect_rejected(text_ply(kVertex3 + kFace1, kPoints + "3 0 1 3\n"), {"f.ply:13:", "face 0", "vertex 3"});
    expect_rejected(text_ply(kVertex3 + kFace1, kPoints + "3 0 1 -1\n"), {"f.ply:13:", "vertex -1"});
    expect_rejected(text_ply(kVertex3 + kFace1, kPoints + "3 0 1\n"), {"file ends"});
    expect_rejected(text_ply(kVertex3 + kFace1, kPoints + "3 0 1 2\n3 2 1 0\n"), {"f.ply:14:", "nothing after"});
    expect_rejected(text_ply(kVertex3 + kFace1, "0 0 0\n1 0 x\n0 1 0\n3 0 1 2\n"), {"f.ply:11:", "'x'"});
    expect_rejected(text_ply("element vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\n" + kFace1, kPoints), {"4000000000"});
}

TEST(ReadPly, RejectsBrokenBinary) {
    const std::string whole = testing::ply_bytes(testing::sample_surface(), "binary_little_endian", true);
    expect_rejected(whole.substr(0, whole.size() - 1), {"f.ply: byte", "face 5"});
    expect_rejected(whole + "x", {"1 bytes follow"});
    EXPECT_NO_THROW((void)read(whole + "\r\n"));
    std::string bad_corner = whole;
    bad_corner[bad_corner.size() - 4] = 8;
    expect_rejected(bad_corner, {"face 5", "vertex 8"});
}

}  // namespace
}  // namespace wellmesh::io
