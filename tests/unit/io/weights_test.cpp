// SPDX-License-Identifier: Apache-2.0
// Weights in every format that is written, back from those that are read, and what is wrong with them, by line.
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "io/readers.hpp"
#include "sample_files.hpp"
#include "sample_mesh.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh {
namespace {

using testing::expect_error;
using testing::source_of;
using testing::TemporaryDirectory;

TetMesh weighted_mesh() {
    TetMesh mesh = testing::sample_mesh(2);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) mesh.weights.push_back(v % 3 == 0 ? 0 : 1e-3 * unit_double(mix64(23, v)));
    return mesh;
}

TEST(Weights, RoundTripBitForBit) {
    const TemporaryDirectory directory;
    const TetMesh mesh = weighted_mesh();
    const std::size_t n = mesh.vertices.size();
    EXPECT_EQ(write_mesh(mesh, directory / "a.mesh"), (std::vector{directory / "a.mesh", directory / "a.weights.sol"}));
    EXPECT_EQ(read_weights(directory / "a.weights.sol", n), mesh.weights);
    write_mesh(mesh, directory / "b.node");
    EXPECT_EQ(read_weights(directory / "b.node", n), mesh.weights);
    EXPECT_EQ(read_mesh(directory / "b.node").vertices, mesh.vertices);
    EXPECT_TRUE(read_mesh(directory / "b.node").weights.empty());  // an attribute may be anything
}

TEST(Weights, ArePointDataOfVtuAndMsh) {
    const TemporaryDirectory directory;
    const TetMesh mesh = weighted_mesh();
    write_mesh(mesh, directory / "a.vtu");
    const std::string vtu = TemporaryDirectory::read(directory / "a.vtu");
    const std::size_t tag = vtu.find("Name=\"weight\""), points = vtu.find("<PointData>"), cells = vtu.find("<Cells>");
    ASSERT_TRUE(points < tag && tag < cells && cells != std::string::npos);
    const std::size_t offset = std::stoul(vtu.substr(vtu.find("offset=\"", tag) + 8));
    const std::size_t data = vtu.find("<AppendedData encoding=\"raw\">\n_") + std::strlen("<AppendedData encoding=\"raw\">\n_") + offset;
    std::vector<double> read(mesh.weights.size());
    std::memcpy(read.data(), vtu.data() + data + sizeof(std::uint64_t), read.size() * sizeof(double));
    EXPECT_EQ(read, mesh.weights);
    for (const int version : {41, 22}) {
        write_mesh(mesh, directory / "a.msh", {.msh_version = version});
        const std::string msh = TemporaryDirectory::read(directory / "a.msh");
        const std::size_t at = msh.find("$NodeData\n1\n\"weight\"\n1\n0\n3\n0\n1\n27\n1 0\n2 ");
        ASSERT_NE(at, std::string::npos) << version;
        EXPECT_NE(msh.find("$EndNodeData\n", at), std::string::npos);
    }
}

TEST(Weights, MeshesWithoutAnyAreWrittenAsBefore) {
    const TemporaryDirectory directory;
    TetMesh mesh = weighted_mesh();
    mesh.weights.clear();
    for (const char* name : {"a.mesh", "a.vtu", "a.msh", "a.node"}) {
        write_mesh(mesh, directory / name);
        EXPECT_EQ(TemporaryDirectory::read(directory / name).find("weight"), std::string::npos) << name;
    }
    EXPECT_FALSE(std::filesystem::exists(directory / "a.weights.sol"));
    expect_error(ErrorCode::bad_input, {"a.node", "no attribute"}, [&] { (void)read_weights(directory / "a.node", mesh.vertices.size()); });
}

TEST(Weights, WrongOnesAreNotWritten) {
    const TemporaryDirectory directory;
    TetMesh mesh = weighted_mesh();
    mesh.weights[5] = std::numeric_limits<double>::infinity();
    expect_error(ErrorCode::bad_input, {"vertex 5 (from 0) has a weight that is not finite"}, [&] { write_mesh(mesh, directory / "a.mesh"); });
    mesh.weights.pop_back();
    expect_error(ErrorCode::bad_input, {"another number of weights"}, [&] { write_mesh(mesh, directory / "a.mesh"); });
    EXPECT_TRUE(directory.files().empty());
}

TEST(Weights, WhatIsWrongWithAFileIsSaidByLine) {
    const auto expect = [](const char* text, std::initializer_list<std::string_view> words) {
        expect_error(ErrorCode::bad_input, words, [&] { (void)io::read_medit_weights(source_of(text, "w.sol")); });
    };
    const char* const sparse = "MeshVersionFormatted 2\n\nDimension\n3\n# ours\nSolAtVertices\n2\n1 1\n0.5\n-1e-3\n";
    EXPECT_EQ(io::read_medit_weights(source_of(sparse)), (std::vector{0.5, -1e-3}));
    EXPECT_EQ(io::read_medit_weights(source_of("MeshVersionFormatted 1 Dimension 3 SolAtVertices 1 1 1 7 End")), std::vector{7.0});
    expect("", {"w.sol:1", "'MeshVersionFormatted'"});
    expect("MeshVersionFormatted 9", {"w.sol:1", "version 9"});
    expect("MeshVersionFormatted 2\nDimension 2\n", {"w.sol:2", "only 3"});
    expect("MeshVersionFormatted 2\nDimension 3\nVertices 4\n", {"w.sol:3", "'SolAtVertices'", "'Vertices'"});
    expect("MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n99999999\n1 1\n", {"w.sol:4"});
    expect("MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n2\n2 1 1\n1 1\n2 2\n", {"w.sol:5", "one field, not 2"});
    expect("MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n1\n1 3\n1 1 1\n", {"w.sol:5", "type 3"});
    expect("MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n2\n1 1\n1\nx\n", {"w.sol:7", "a weight", "'x'"});
    expect("MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n2\n1 1\n1\nnan\n", {"w.sol:7"});
    expect("MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n2\n1 1\n1\n", {"w.sol", "a weight"});
    expect("MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n1\n1 1\n1\n2\n", {"w.sol:7", "'End'"});
    const TemporaryDirectory directory;
    directory.write("w.sol", "MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n2\n1 1\n1\n2\nEnd\n");
    expect_error(ErrorCode::bad_input, {"w.sol", "2 weights, the mesh 3 vertices"}, [&] { (void)read_weights(directory / "w.sol", 3); });
    expect_error(ErrorCode::cannot_read, {".sol .node"}, [&] { (void)read_weights(directory / "w.txt", 3); });
    expect_error(ErrorCode::cannot_read, {"none.sol"}, [&] { (void)read_weights(directory / "none.sol", 3); });
}

}  // namespace
}  // namespace wellmesh
