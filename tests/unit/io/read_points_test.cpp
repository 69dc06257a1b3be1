// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "io/readers.hpp"
#include "sample_files.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::io {
namespace {

using testing::expect_error;
using testing::source_of;

const std::vector<Vec3> kTwo{{1, 2, 3}, {-4.5, 0, 6e10}};

TEST(ReadPoints, ReadsXyz) {
    for (const char* const text :
         {"1 2 3\n-4.5 -0 6e10\n", "2\n1 2 3\n-4.5 0 6e10", "# c\n\n1,2,3,red\n-4.5,0,6e10,blue\n", "  1\t2 3 9 9 9\r\n-4.5 0 6e10\r\n"})
        EXPECT_EQ(read_xyz_points(source_of(text)), kTwo) << text;
    expect_error(ErrorCode::bad_input, {"p:2:", "line ends"}, [] { (void)read_xyz_points(source_of("1 2 3\n4 5\n", "p")); });
    expect_error(ErrorCode::bad_input, {"1 points", "states 2"}, [] { (void)read_xyz_points(source_of("2\n1 2 3    \n", "p")); });
    expect_error(ErrorCode::bad_input, {"no points"}, [] { (void)read_xyz_points(source_of("# c\n\n", "p")); });
    expect_error(ErrorCode::bad_input, {"p:1:", "'x'"}, [] { (void)read_xyz_points(source_of("x y z\n", "p")); });
}

TEST(ReadPoints, ReadsNode) {
    EXPECT_EQ(read_node_points(source_of("2 3 1 1\n7 1 2 3 0.5 1\n9 -4.5 0 6e10 0.5 0\n")), kTwo);
    expect_error(ErrorCode::bad_input, {"nothing after"}, [] { (void)read_node_points(source_of("1 3 0 0\n1 1 2 3\n2 1 2 3\n")); });
}

TEST(ReadPoints, GoesByTheExtension) {
    const testing::TemporaryDirectory directory;
    EXPECT_EQ(wellmesh::read_points(directory.write("A.XYZ", "1 2 3\n-4.5 0 6e10\n")), kTwo);
    expect_error(ErrorCode::cannot_read, {".foo", ".xyz"}, [&] { (void)wellmesh::read_points(directory.write("a.foo", "1 2 3")); });
}

}  // namespace
}  // namespace wellmesh::io
