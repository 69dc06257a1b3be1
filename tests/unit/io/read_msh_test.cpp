// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "foreign_meshes.hpp"
#include "io/readers.hpp"
#include "sample_mesh.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::io {
namespace {

using testing::expect_error;
using testing::source_of;

const std::string kFormat4 = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n", kFormat2 = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const std::string kNodes2 = "$Nodes\n4\n7 0 0 0\n3 1 0 0\n5 0 1 0\n9 0 0 1\n$EndNodes\n";
const std::string kTet2 = "$Elements\n1\n1 4 2 8 80 3 5 7 9\n$EndElements\n";

TEST(ReadMsh, BinaryInEitherByteOrder) {
    const TetMesh mesh = testing::sample_mesh(2);
    for (const bool little : {true, false}) {
        const TetMesh back = read_msh_mesh(source_of(testing::msh_binary(mesh, little)));
        EXPECT_EQ(back.vertices, mesh.vertices);
        EXPECT_EQ(back.subfaces, mesh.subfaces);
        ASSERT_EQ(back.tets.size(), mesh.tets.size());
        std::size_t at = 0;  // region by region
        for (const std::int32_t region : {-10, 20})
            for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
                if (mesh.tet_regions[t] != region) continue;
                EXPECT_EQ(back.tets[at], mesh.tets[t]);
                EXPECT_EQ(back.tet_regions[at++], region + 1000);
            }
        EXPECT_EQ(back.subface_markers, std::vector<std::int32_t>(mesh.subfaces.size(), 7)) << "the sign of a group is an orientation";
        EXPECT_EQ(back.subface_facets, std::vector<std::int32_t>(mesh.subfaces.size(), 5));
        EXPECT_EQ(*back.names.find(2, 7), "the hull");
    }
}

TEST(ReadMsh, BackgroundSizes) {
    const testing::TemporaryDirectory directory;
    const TetMesh mesh = testing::sample_mesh(2);
    const BackgroundMesh background = read_background_mesh(directory.write("a.msh", testing::msh_binary(mesh, true)));
    ASSERT_EQ(background.sizes.size(), mesh.vertices.size());
    for (std::size_t v = 0; v < background.sizes.size(); ++v) EXPECT_EQ(background.sizes[v], static_cast<double>(v) + 1);
    EXPECT_EQ(background.mesh.vertices, mesh.vertices);
    const auto refused = [&](const std::string& text, const char* word) {
        expect_error(ErrorCode::bad_input, {word}, [&] { (void)read_background_mesh(directory.write("b.msh", text)); });
    };
    const auto data = [](const char* name, const char* rows, int count) {
        return fmt::format("$NodeData\n1\n\"{}\"\n1\n0\n3\n0\n1\n{}\n{}$EndNodeData\n", name, count, rows);
    };
    refused(kFormat2 + kNodes2 + kTet2, "no field");
    refused(kFormat2 + kNodes2 + kTet2 + data("a", "7 1\n3 1\n5 -1\n9 1\n", 4), "vertex 2");
    refused(kFormat2 + kNodes2 + kTet2 + data("a", "7 1\n3 1\n5 1\n", 3), "no field");
    refused(kFormat2 + kNodes2 + kTet2 + data("a", "7 1\n3 1\n5 1\n9 1\n", 4) + data("b", "7 1\n3 1\n5 1\n9 1\n", 4), "'a', 'b'");
    const std::string two = kFormat2 + kNodes2 + kTet2 + data("a", "7 1\n3 1\n5 1\n9 1\n", 4) + data("size", "7 4\n3 1\n5 2\n9 0\n", 4);
    EXPECT_EQ(read_background_mesh(directory.write("c.msh", two)).sizes, (std::vector<double>{1, 2, 4, 0})) << "in the order of node numbers";
}

TEST(ReadMsh, Version2) {
    const std::string text =
        kFormat2 +
        "$PhysicalNames\n3\n0 4 \"tip\"\n3 8 \"all of it\"\n2 6 \"base\"\n$EndPhysicalNames\n$Comments\nanything $goes here\n$EndComments\n" +
        kNodes2 +
        "$Elements\n6\n1 15 2 4 1 9\n2 2 2 6 3 7 3 5\n3 2 2 5 3 7 3 5\n4 1 2 0 11 7 3\n5 4 4 8 80 1 1 7 3 5 9\n6 2 2 6 4 7 3 9\n$EndElements\n";
    const TetMesh mesh = read_msh_mesh(source_of(text, "f.msh"));
    // Nodes come in the order of their numbers: 3, 5, 7, 9.
    EXPECT_EQ(mesh.vertices, (std::vector<Vec3>{{1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {0, 0, 1}}));
    EXPECT_EQ(mesh.tets, (std::vector<std::array<std::uint32_t, 4>>{{2, 0, 1, 3}}));
    EXPECT_EQ(mesh.tet_regions, std::vector<std::int32_t>{8});
    EXPECT_EQ(mesh.subface_markers, (std::vector<std::int32_t>{6, 6})) << "an element in two groups is listed twice; the first counts";
    EXPECT_EQ(mesh.subface_facets, (std::vector<std::int32_t>{3, 4}));
    EXPECT_EQ(mesh.subsegment_segments, std::vector<std::int32_t>{11});
    EXPECT_EQ(mesh.subsegment_markers, std::vector<std::int32_t>{0});
    EXPECT_EQ(mesh.vertex_markers, (std::vector<std::int32_t>{0, 0, 0, 4}));
    EXPECT_EQ(*mesh.names.find(0, 4), "tip");
    EXPECT_EQ(*mesh.names.find(3, 8), "all of it");
    const Plc plc = read_msh_surface(source_of(text, "f.msh"));
    EXPECT_EQ(plc.facets.size(), 2U);
    EXPECT_EQ(plc.segments.size(), 1U);
    EXPECT_EQ(plc.segments[0].marker, 11) << "without markers the file's parts";
    EXPECT_EQ(plc.fill, FillRule::bounded_cells);
    EXPECT_EQ(*plc.names.find(2, 6), "base");
}

TEST(ReadMsh, RegionsWithoutGroupsAreTheVolumes) {
    std::string text = kFormat2 + kNodes2 + kTet2;
    text.replace(text.find("8 80"), 4, "0 80");
    EXPECT_EQ(read_msh_mesh(source_of(text)).tet_regions, std::vector<std::int32_t>{80});
}

TEST(ReadMsh, RejectsWithPlaceAndWord) {
    const auto rejected = [](const std::string& text, std::initializer_list<std::string_view> words) {
        expect_error(ErrorCode::bad_input, words, [&] { (void)read_msh_mesh(source_of(text, "f.msh")); });
    };
    rejected("$NOD\n", {"f.msh:1:", "$NOD", "2.2"});
    rejected("$MeshFormat\n4 0 8\n", {"f.msh:2:", "'4'", "4.1"});
    rejected("$MeshFormat\n4.1 0 4\n", {"4 bytes"});
    rejected("$MeshFormat\n4.1 2 8\n", {"0 or 1"});
    rejected(kFormat2 + kTet2, {"before $Nodes"});
    rejected(kFormat2 + kNodes2, {"no $Elements"});
    rejected(kFormat2 + kNodes2 + kNodes2, {"twice"});
    rejected(kFormat2 + kNodes2 + "$Elements\n1\n1 4 2 8 80 3 5 7 8\n$EndElements\n", {"f.msh:13:", "node 8"});
    rejected(kFormat2 + kNodes2 + "$Elements\n1\n12 11 2 8 80 3 5 7 9\n$EndElements\n", {"f.msh:13:", "element 12", "tetrahedron of second order"});
    rejected(kFormat2 + kNodes2 + "$Elements\n1\n12 5 2 8 80 3 5 7 9\n$EndElements\n", {"element 12", "hexahedron"});
    rejected(kFormat2 + kNodes2 + "$Elements\n1\n1 77 2 8 80 3 5 7 9\n$EndElements\n", {"type 77"});
    rejected(kFormat2 + kNodes2 + "$Elements\n1\n1 3 2 8 80 3 5 7 9\n$EndElements\n", {"no tetrahedra"});
    rejected(kFormat2 + kNodes2 + "$Elements\n99\n1 4 2 8 80 3 5 7 9\n$EndElements\n", {"cannot hold more"});
    rejected(kFormat2 + "$Nodes\n1\n1 0 0 inf\n", {"'inf'", "f.msh:6:"});
    rejected(kFormat2 + "$Nodes\n2\n1 0 0 0\n1 0 0 1\n$EndNodes\n", {"node 1 is given twice"});
    rejected(kFormat4 + "$PartitionedEntities\n", {"partition"});
    rejected(kFormat4 + "$Weird\n1 2\n", {"$Weird", "does not end"});
    std::string binary = testing::msh_binary(testing::sample_mesh(1), true);
    rejected(binary.substr(0, binary.size() / 2), {"byte "});
}

TEST(ReadMsh, SurfacesPassOverOtherCells) {
    const std::string text = kFormat2 + kNodes2 + "$Elements\n2\n1 5 2 1 1 3 5 7 9 3 5 7 9\n2 2 2 0 4 3 5 7\n$EndElements\n";
    const Plc plc = read_msh_surface(source_of(text));
    ASSERT_EQ(plc.facets.size(), 1U);
    EXPECT_EQ(plc.facets[0].marker, 4);
}

}  // namespace
}  // namespace wellmesh::io
