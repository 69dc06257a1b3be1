// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "sample_files.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh {
namespace {

using testing::expect_error;
using testing::TemporaryDirectory;

TEST(ReadTetgenMesh, ReadsAllFourFiles) {
    const TemporaryDirectory directory;
    directory.write("a.node", "5 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n4 1 1 1\n# made by hand\n");
    directory.write("a.ele", "2 4 2\n0 0 1 2 3 12.0 0.5\n1 1 2 3 4 -3 0.5\n");
    EXPECT_TRUE(read_mesh(directory / "a.ele").subfaces.empty());
    directory.write("a.face", "1 1\n0 0 1 2 8 -1 0\n");
    directory.write("a.edge", "1 0\n0 0 1\n");
    const TetMesh mesh = read_mesh(directory / "a.node");
    EXPECT_EQ(mesh.vertices.size(), 5U);
    EXPECT_EQ(mesh.tets, (std::vector<std::array<std::uint32_t, 4>>{{0, 1, 2, 3}, {1, 2, 3, 4}}));
    EXPECT_EQ(mesh.tet_regions, (std::vector<std::int32_t>{12, -3}));
    EXPECT_EQ(mesh.subface_facets, (std::vector<std::int32_t>{8}));
    EXPECT_EQ(mesh.subsegment_segments, (std::vector<std::int32_t>{0}));
}

TEST(ReadTetgenMesh, RejectsWithPlaceAndToken) {
    const TemporaryDirectory directory;
    const auto reject = [&](const char* ele, std::initializer_list<std::string_view> words) {
        directory.write("a.ele", ele);
        expect_error(ErrorCode::bad_input, words, [&] { (void)read_mesh(directory / "a.ele"); });
    };
    directory.write("a.node", "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n");
    expect_error(ErrorCode::cannot_read, {"a.ele"}, [&] { (void)read_mesh(directory / "a.ele"); });
    reject("1 10 0\n1 1 2 3 4 1 2 3 4 1 2\n", {"a.ele:1:", "10 nodes"});
    reject("1 4 0\n1 1 2 3 5\n", {"a.ele:2:", "vertex 5"});
    reject("1 4 0\n1 1 2 3\n", {"a.ele:2:", "line ends"});
    reject("1 4 1\n1 1 2 3 4 0.5\n", {"a.ele:2:", "'0.5'"});
    reject("1 4 0\n1 1 2 3 4\n2 1 2 3 4\n", {"a.ele:3:", "nothing after"});
    reject("3 4 0\n1 1 2 3 4\n", {"a.ele:1:"});
}

}  // namespace
}  // namespace wellmesh
