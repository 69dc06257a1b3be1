// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "io/readers.hpp"
#include "sample_files.hpp"

namespace wellmesh::io {
namespace {

using testing::expect_error;
using testing::source_of;

const std::string kHead = "MeshVersionFormatted 1\n# comment\nDimension 3\n";
const std::string kVertices = "Vertices 4\n0 0 0 1\n1 0 0 2\n0 1 0 3\n0 0 1 4\n";
const std::string kTets = "Tetrahedra\n1\n1 2 3 4 -7\n";

TetMesh mesh(const std::string& text) {
    return read_medit_mesh(source_of(text, "f.mesh"));
}

void expect_rejected(const std::string& text, std::initializer_list<std::string_view> words) {
    expect_error(ErrorCode::bad_input, words, [&] { (void)mesh(text); });
}

TEST(ReadMedit, ReadsAMeshWithSectionsInAnyOrder) {
    const TetMesh m = mesh(kHead + kTets + "Corners\n2\n1\n2\nTriangles\n2\n1 2 3 5\n2 3 4 6\nNormals\n1\n0 0 1.5e0\nRidges 1 1\n" + kVertices +
                           "AngleOfCornerBound 30\nRequiredTriangles 1\n2\nEdges\n1\n1 4 9\nHexahedra\n0\nEnd\nanything");
    EXPECT_EQ(m.vertices.size(), 4U);
    EXPECT_EQ(m.tets, (std::vector<std::array<std::uint32_t, 4>>{{0, 1, 2, 3}}));
    EXPECT_EQ(m.tet_regions, (std::vector<std::int32_t>{-7}));
    EXPECT_EQ(m.subfaces.size(), 2U);
    EXPECT_EQ(m.subface_facets, (std::vector<std::int32_t>{5, 6}));
    EXPECT_EQ(m.subface_markers, m.subface_facets);
    EXPECT_EQ(m.subsegments, (std::vector<std::array<std::uint32_t, 2>>{{0, 3}}));
    EXPECT_EQ(m.subsegment_segments, (std::vector<std::int32_t>{9}));
    EXPECT_TRUE(m.vertex_carriers.empty());
    EXPECT_EQ(mesh(kHead + kVertices + kTets).tets.size(), 1U) << "without 'End'";
}

TEST(ReadMedit, ReadsASurface) {
    const testing::Surface quads = testing::sample_surface();
    for (const testing::Surface& surface : {quads, testing::triangulated(quads)}) {
        const Plc plc = read_medit_surface(source_of(testing::medit_text(surface)));
        EXPECT_EQ(plc.vertices, surface.vertices);
        ASSERT_EQ(plc.facets.size(), surface.polygons.size());
        for (std::size_t f = 0; f < plc.facets.size(); ++f) {
            EXPECT_EQ(plc.facets[f].polygons, testing::Polygons{surface.polygons[f]});
            EXPECT_EQ(plc.facets[f].marker, 5);
        }
        EXPECT_EQ(plc.first_number, 1U);
        EXPECT_EQ(plc.fill, FillRule::nonzero_winding);
        EXPECT_EQ(plc.vertex_lines[0], 7U);
        EXPECT_EQ(plc.facet_lines.size(), plc.facets.size());
    }
    expect_error(ErrorCode::bad_input, {"no surface"}, [] { (void)read_medit_surface(source_of(kHead + kVertices + kTets)); });
}

TEST(ReadMedit, RejectsWithPlaceAndToken) {
    expect_rejected("10\n0 2 0\n", {"f.mesh:1:", "'10'", "MeshVersionFormatted"});
    expect_rejected("MeshVersionFormatted 9\n", {"version 9"});
    expect_rejected("MeshVersionFormatted 2\nDimension 2\n", {"dimension is 2"});
    expect_rejected("MeshVersionFormatted 2\nVertices\n", {"'Dimension' before"});
    expect_rejected(kHead + kTets, {"no 'Vertices'"});
    expect_rejected(kHead + kVertices, {"no 'Tetrahedra'"});
    expect_rejected(kHead + kVertices + kVertices + kTets, {"f.mesh:9:", "twice"});
    expect_rejected(kHead + kVertices + "Tetrahedra\n1\n1 2 3 5 0\n", {"f.mesh:11:", "vertex 5", "4 vertices"});
    expect_rejected(kHead + kVertices + "Tetrahedra\n1\n0 2 3 4 0\n", {"f.mesh:11:", "vertex 0"});
    expect_rejected(kHead + kVertices + "Tetrahedra\n2\n1 2 3 4 0\nEnd\n", {"hold more than 1"});
    expect_rejected(kHead + kVertices + "Tetrahedra\n2\n1 2 3 4 0\n1 2 3 End\n", {"'End'"});
    expect_rejected(kHead + kVertices + kTets + "Nonsense\n1\n", {"'Nonsense'", "f.mesh:12:"});
    expect_rejected(kHead + kVertices + kTets + "Corners\n2\n1\nEnd\n", {"f.mesh:15:", "'End'"});
    expect_rejected(kHead + kVertices + "Hexahedra\n1\n1 2 3 4 1 2 3 4 0\n" + kTets, {"1 Hexahedra"});
    expect_rejected(kHead + "Vertices 1\n0 0 nan 0\n", {"'nan'"});
    expect_rejected(kHead + "Vertices 1000000000000\n0 0 0 0\n", {"1000000000000"});
    expect_rejected(kHead + kVertices + "Tetrahedra\n1\n1 2 3 4 3000000000\n", {"32 bits"});
}

}  // namespace
}  // namespace wellmesh::io
