// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "sample_files.hpp"
#include "sample_mesh.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh {
namespace {

using testing::TemporaryDirectory;

struct Block {
    std::string keyword;  // the whole line
    std::vector<std::vector<std::string>> rows;
};

std::vector<Block> blocks_of(const std::string& text) {
    std::vector<Block> blocks;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with('*')) {
            blocks.push_back({line, {}});
            continue;
        }
        auto& row = blocks.back().rows.emplace_back();
        std::istringstream cells(line);
        for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell.substr(cell.find_first_not_of(' ')));
    }
    return blocks;
}

TEST(WriteAbaqus, SetsAndSurfaces) {
    TetMesh mesh = testing::sample_mesh(2);
    mesh.subsegment_markers.assign(mesh.subsegments.size(), 0);
    mesh.subsegment_markers[0] = 6;
    mesh.vertex_markers.assign(mesh.vertices.size(), 0);
    mesh.vertex_markers[4] = 3;
    mesh.names.of_dimension[3] = {{-10, "left part"}, {20, "left_part"}};  // one name once Abaqus' letters are taken
    mesh.names.of_dimension[2][100] = "2nd wall";
    mesh.names.of_dimension[0][3] = "Probe";
    const TemporaryDirectory directory;
    write_mesh(mesh, directory / "a.inp");
    const auto blocks = blocks_of(TemporaryDirectory::read(directory / "a.inp"));

    std::map<std::string, std::set<std::size_t>> elsets, nsets;
    std::map<std::size_t, std::array<std::uint32_t, 4>> tets;
    std::map<std::string, std::set<std::array<std::uint32_t, 3>>> surfaces;
    // Abaqus' documentation of C3D4: face 1 has the nodes 1-2-3, face 2 1-4-2, face 3 2-4-3, face 4 3-4-1.
    const std::array<std::array<std::size_t, 3>, 4> faces{{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
    std::size_t nodes = 0;
    for (const Block& block : blocks) {
        const std::string name = block.keyword.substr(block.keyword.rfind('=') + 1);
        if (block.keyword == "*NODE") {
            nodes = block.rows.size();
            EXPECT_EQ(std::stod(block.rows[7][2]), mesh.vertices[7].y);
        } else if (block.keyword.starts_with("*ELEMENT, TYPE=C3D4, ELSET=")) {
            for (const auto& row : block.rows) {
                ASSERT_EQ(row.size(), 5U);
                elsets[name].insert(std::stoul(row[0]));
                for (std::size_t k = 0; k < 4; ++k) tets[std::stoul(row[0])][k] = static_cast<std::uint32_t>(std::stoul(row[k + 1]) - 1);
            }
        } else if (block.keyword.starts_with("*ELSET") || block.keyword.starts_with("*NSET")) {
            for (const auto& row : block.rows) {
                EXPECT_LE(row.size(), 16U);
                for (const auto& cell : row) (block.keyword[1] == 'E' ? elsets : nsets)[name].insert(std::stoul(cell));
            }
        } else if (block.keyword.starts_with("*SURFACE, TYPE=ELEMENT")) {
            for (const auto& row : block.rows)
                for (const std::size_t e : elsets.at(row[0])) {
                    std::array<std::uint32_t, 3> face{};
                    for (std::size_t k = 0; k < 3; ++k) face[k] = tets.at(e)[faces[static_cast<std::size_t>(row[1][1] - '1')][k]];
                    std::sort(face.begin(), face.end());
                    EXPECT_TRUE(surfaces[name].insert(face).second) << "a face twice";
                }
        }
    }
    EXPECT_EQ(nodes, mesh.vertices.size());
    ASSERT_EQ(tets.size(), mesh.tets.size());
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) EXPECT_EQ(tets.at(t + 1), mesh.tets[t]);
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) EXPECT_TRUE(elsets.at(mesh.tet_regions[t] < 0 ? "left_part" : "left_part_2").contains(t + 1));
    EXPECT_EQ(elsets.at("left_part").size() + elsets.at("left_part_2").size(), mesh.tets.size());
    std::map<std::string, std::set<std::array<std::uint32_t, 3>>> expected;
    for (std::size_t f = 0; f < mesh.subfaces.size(); ++f) {
        auto face = mesh.subfaces[f];
        std::sort(face.begin(), face.end());
        expected[mesh.subface_markers[f] == 100 ? "S_2nd_wall" : "facet_marker_-7"].insert(face);
    }
    EXPECT_EQ(surfaces, expected);
    EXPECT_EQ(nsets.at("Probe"), std::set<std::size_t>{5});
    EXPECT_EQ(nsets.at("segment_marker_6"), (std::set<std::size_t>{mesh.subsegments[0][0] + 1U, mesh.subsegments[0][1] + 1U}));
}

}  // namespace
}  // namespace wellmesh
