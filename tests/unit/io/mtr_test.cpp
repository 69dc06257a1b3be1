// SPDX-License-Identifier: Apache-2.0
// TetGen's sizes at points: beside a complex, and on a background mesh.
#include <fstream>

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "io/readers.hpp"
#include "sample_files.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh {
namespace {

using testing::expect_error;
using testing::source_of;
using testing::TemporaryDirectory;

TEST(Mtr, OneSizeALineInTheOrderOfThePoints) {
    EXPECT_EQ(io::read_mtr(source_of("# sizes\n3 1\n0.5\n0 # none\n1e-3\n"), 3), (std::vector<double>{0.5, 0, 1e-3}));
    EXPECT_EQ(io::read_mtr(source_of("2\n1\n2\n"), 2), (std::vector<double>{1, 2}));
}

TEST(Mtr, ErrorsNameTheLine) {
    expect_error(ErrorCode::bad_input, {"sample:1", "3 sizes, but there are 2 points"}, [] { (void)io::read_mtr(source_of("3 1\n1\n1\n1\n"), 2); });
    expect_error(ErrorCode::bad_input, {"sample:1", "6 values a point"}, [] { (void)io::read_mtr(source_of("1 6\n1 0 0 1 0 1\n"), 1); });
    expect_error(ErrorCode::bad_input, {"sample:3", "-1"}, [] { (void)io::read_mtr(source_of("2 1\n1\n-1\n"), 2); });
    expect_error(ErrorCode::bad_input, {"sample:3", "'x'"}, [] { (void)io::read_mtr(source_of("2 1\n1\nx\n"), 2); });
    expect_error(ErrorCode::bad_input, {"sample:4"}, [] { (void)io::read_mtr(source_of("2 1\n1\n1\n1\n"), 2); });
    expect_error(ErrorCode::bad_input, {"sample:1"}, [] { (void)io::read_mtr(source_of("4000000000 1\n1\n"), 4000000000U); });
}

TEST(Mtr, BesideAComplexItGivesItsVerticesSizes) {
    const TemporaryDirectory directory;
    std::ofstream(directory / "a.poly") << "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n4 0\n1\n3 1 2 3\n1\n3 1 2 4\n1\n3 2 3 4\n1\n3 1 3 4\n";
    EXPECT_TRUE(read_plc(directory / "a.poly").vertex_sizes.empty());
    std::ofstream(directory / "a.mtr") << "4 1\n0.1\n0.2\n0\n0.4\n";
    EXPECT_EQ(read_plc(directory / "a.poly").vertex_sizes, (std::vector<double>{0.1, 0.2, 0, 0.4}));
    std::ofstream(directory / "a.mtr") << "3 1\n0.1\n0.2\n0\n";
    expect_error(ErrorCode::bad_input, {"a.mtr", "3 sizes, but there are 4 points"}, [&] { (void)read_plc(directory / "a.poly"); });
}

TEST(BackgroundMesh, IsAMeshWithItsSizes) {
    const TemporaryDirectory directory;
    std::ofstream(directory / "m.b.node") << "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n";
    std::ofstream(directory / "m.b.ele") << "1 4 0\n0 0 1 2 3\n";
    expect_error(ErrorCode::cannot_read, {"m.b.mtr"}, [&] { (void)read_background_mesh(directory / "m.b.node"); });
    std::ofstream(directory / "m.b.mtr") << "4 1\n1\n2\n3\n4\n";
    for (const char* name : {"m.b.node", "m.b.ele", "m.b.mtr"}) {
        const BackgroundMesh background = read_background_mesh(directory / name);
        EXPECT_EQ(background.mesh.tets.size(), 1U);
        EXPECT_EQ(background.sizes, (std::vector<double>{1, 2, 3, 4}));
    }
    expect_error(ErrorCode::cannot_read, {".node .ele .mtr"}, [&] { (void)read_background_mesh(directory / "m.stl"); });
}

}  // namespace
}  // namespace wellmesh
