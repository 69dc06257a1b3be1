// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "foreign_meshes.hpp"
#include "io/base64.hpp"
#include "io/readers.hpp"
#include "sample_mesh.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::io {
namespace {

using testing::expect_error;
using testing::source_of;
using testing::VtuStyle;

TEST(Base64, DecodesWhatItShould) {
    for (std::size_t n = 0; n < 70; ++n) {
        std::string bytes;
        for (std::size_t i = 0; i < n; ++i) bytes += static_cast<char>(mix64(n, i));
        EXPECT_EQ(decode_base64(testing::base64(bytes), 1000), bytes);
        EXPECT_EQ(decode_base64(testing::base64(bytes) + testing::base64("ab"), 1000), bytes + "ab") << "streams one after the other";
        EXPECT_EQ(decode_base64(testing::base64(bytes), n / 2), bytes.substr(0, n / 2));
    }
    EXPECT_EQ(decode_base64(" QU\nJD*junk", 99), "ABC");
}

TEST(ReadVtu, EveryEncoding) {
    const TetMesh mesh = testing::sample_mesh(2);
    std::vector<VtuStyle> styles{{.ascii = true}};
    for (const bool base64 : {true, false})
        for (const bool appended : {true, false})
            for (const bool compressed : {true, false})
                for (const bool little : {true, false})
                    for (const bool wide : {true, false})
                        if (base64 || appended) styles.push_back({false, base64, appended, compressed, little, wide});
    ASSERT_EQ(styles.size(), 25U);
    for (const VtuStyle& style : styles) {
        SCOPED_TRACE(fmt::format("ascii {} base64 {} appended {} compressed {} little {} wide {}", style.ascii, style.base64, style.appended,
                                 style.compressed, style.little, style.wide_header));
        const std::string text = testing::vtu_text(mesh, style);
        const TetMesh back = read_vtu_mesh(source_of(text, "nowhere/f.vtu"));
        EXPECT_EQ(back.vertices, mesh.vertices);
        EXPECT_EQ(back.tets, mesh.tets);
        EXPECT_EQ(back.tet_regions, mesh.tet_regions);
        EXPECT_EQ(back.subfaces, mesh.subfaces);
        EXPECT_EQ(back.subface_markers, mesh.subface_markers);
        EXPECT_EQ(*back.names.find(3, 20), "left & right");
        EXPECT_EQ(*back.names.find(2, 100), "left & right");
        const BackgroundMesh background = read_background(source_of(text), read_vtu(source_of(text), false));
        ASSERT_EQ(background.sizes.size(), mesh.vertices.size());
        EXPECT_EQ(background.sizes.back(), static_cast<double>(mesh.vertices.size()) - 0.5);
    }
}

TEST(ReadVtu, RejectsWithPlaceAndWord) {
    const std::string good = testing::vtu_text(testing::sample_mesh(1), {.ascii = true});
    const auto rejected = [&](const char* from, const char* to, std::initializer_list<std::string_view> words) {
        std::string text = good;
        const std::size_t at = text.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        text.replace(at, std::string_view(from).size(), to);
        expect_error(ErrorCode::bad_input, words, [&] { (void)read_vtu_mesh(source_of(text, "nowhere/f.vtu")); });
    };
    rejected("</UnstructuredGrid>", "</Grid>", {"f.vtu:", "XML"});
    rejected("type=\"UnstructuredGrid\"", "type=\"ImageData\"", {"'ImageData'", "UnstructuredGrid"});
    rejected("NumberOfPoints=\"8\"", "NumberOfPoints=\"9\"", {"27 coordinates", "24"});
    rejected("NumberOfPoints=\"8\"", "NumberOfPoints=\"x\"", {"'x'", "NumberOfPoints", "f.vtu:6:"});
    rejected("NumberOfPoints=\"8\"", "NumberOfPoints=\"99999999999\"", {"more than the file can hold"});
    rejected("Name=\"types\"", "Name=\"kinds\"", {"'types'"});
    rejected("10 10 10 10 10 10", "24 10 10 10 10 10", {"cell 0", "tetrahedron of second order"});
    rejected("10 10 10 10 10 10", "12 10 10 10 10 10", {"cell 0", "hexahedron"});
    rejected("10 10 10 10 10 10", "5 10 10 10 10 10", {"cell 0", "4 points"});
    rejected("<Cells>\n", "<Cells>\n<DataArray Name=\"connectivity\" type=\"Int64\">0 1 2 99</DataArray>", {"cell 0", "point 99", "8 points"});
    rejected("header_type=\"UInt32\"", "compressor=\"vtkLZ4DataCompressor\"", {"vtkLZ4DataCompressor", "vtkZLibDataCompressor"});
    std::string damaged = testing::vtu_text(testing::sample_mesh(2), {.appended = true, .compressed = true});
    damaged[damaged.find("<AppendedData") + 400] ^= 0x55;
    expect_error(ErrorCode::bad_input, {"f.vtu:"}, [&] { (void)read_vtu_mesh(source_of(damaged, "nowhere/f.vtu")); });
}

TEST(ReadVtu, TheBoundaryBesideMustBeThatOfTheMesh) {
    const testing::TemporaryDirectory directory;
    write_mesh(testing::sample_mesh(2), directory / "a.vtu");
    EXPECT_EQ(directory.files(), (std::vector<std::string>{"a.boundary.vtu", "a.vtu"}));
    write_mesh(testing::sample_mesh(1), directory / "b.vtu");
    std::filesystem::rename(directory / "b.boundary.vtu", directory / "a.boundary.vtu");
    expect_error(ErrorCode::bad_input, {"a.boundary.vtu", "different meshes"}, [&] { (void)read_mesh(directory / "a.vtu"); });
    std::filesystem::remove(directory / "a.boundary.vtu");
    EXPECT_TRUE(read_mesh(directory / "a.vtu").subfaces.empty()) << "alone it is a mesh without constraints";
}

TEST(ReadVtp, PolygonsLinesAndVertices) {
    const std::string text =
        "<VTKFile type=\"PolyData\"><PolyData><Piece NumberOfPoints=\"5\" NumberOfVerts=\"1\" NumberOfLines=\"1\" NumberOfPolys=\"2\">"
        "<Points><DataArray type=\"Float32\" NumberOfComponents=\"3\">0 0 0 1 0 0 1 1 0 0 1 0 0 0 1</DataArray></Points>"
        "<Verts><DataArray Name=\"connectivity\" type=\"Int32\">4</DataArray><DataArray Name=\"offsets\" type=\"Int32\">1</DataArray></Verts>"
        "<Lines><DataArray Name=\"connectivity\" type=\"Int32\">0 4 2</DataArray><DataArray Name=\"offsets\" type=\"Int32\">3</DataArray></Lines>"
        "<Polys><DataArray Name=\"connectivity\" type=\"Int32\">0 1 2 3 0 1 4</DataArray><DataArray Name=\"offsets\" type=\"Int32\">4 "
        "7</DataArray></Polys>"
        "<CellData><DataArray Name=\"marker\" type=\"Int32\">9 8 7 6</DataArray></CellData></Piece></PolyData></VTKFile>";
    const Plc plc = read_vtp_surface(source_of(text));
    ASSERT_EQ(plc.facets.size(), 2U);
    EXPECT_EQ(plc.facets[0].marker + plc.facets[1].marker, 13);
    ASSERT_EQ(plc.segments.size(), 2U);
    EXPECT_EQ(plc.segments[1].vertices, (std::array<std::uint32_t, 2>{4, 2}));
    EXPECT_EQ(plc.segments[0].marker, 8);
    EXPECT_EQ(plc.vertex_markers, (std::vector<std::int32_t>{0, 0, 0, 0, 9}));
    EXPECT_GE(plc.relative_rounding, 0x1p-24);
}

}  // namespace
}  // namespace wellmesh::io
