// SPDX-License-Identifier: Apache-2.0
// wellmesh improve on meshes of this program and of others.
#include <gtest/gtest.h>
#include <signal.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"

namespace wellmesh::testing {
namespace {

using nlohmann::json;

constexpr const char* kCubePoly =
    "8 3 0 0\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n"
    "6 0\n1\n4 4 3 2 1\n1\n4 5 6 7 8\n1\n4 1 2 6 5\n1\n4 2 3 7 6\n1\n4 3 4 8 7\n1\n4 4 1 5 8\n0\n0\n";

json report_of(const std::string& path) { return json::parse(read_text(path)); }

TEST(improve_command, raises_the_angle_of_a_mesh_with_slivers) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.poly", kCubePoly);
    ASSERT_EQ(run_wellmesh({"mesh", cube, "--size", "0.2", "--min-dihedral", "0", "--seeding", "off", "-o", scratch.file("slivers.mesh"), "--quiet"}).status, 0);
    const Outcome before = run_wellmesh({"check", scratch.file("slivers.mesh"), "--plc", cube, "--min-dihedral", "15"});
    EXPECT_EQ(before.status, 1);
    const Outcome run = run_wellmesh({"improve", scratch.file("slivers.mesh"), "--plc", cube, "--min-dihedral", "25", "-o", scratch.file("good.mesh"), "--json", scratch.file("report.json")});
    ASSERT_EQ(run.status, 0) << run.out << run.err;
    EXPECT_TRUE(contains(run.out, "the given mesh: "));
    const json report = report_of(scratch.file("report.json"));
    EXPECT_EQ(report.at("command"), "improve");
    EXPECT_EQ(report.at("plc"), cube);
    const json& given = report.at("statistics").at("given_mesh");
    EXPECT_EQ(given.at("delaunay_tets"), given.at("tets"));
    EXPECT_EQ(given.at("added_for_conformity"), 0);
    EXPECT_EQ(given.at("moved_onto_input"), 0);
    const Outcome after = run_wellmesh({"check", scratch.file("good.mesh"), "--plc", cube, "--min-dihedral", "25", "--max-radius-edge", "2"});
    EXPECT_EQ(after.status, 0) << after.out;
    // A good mesh comes back with its vertices, however often.
    for (const auto& [in, out] : {std::pair{"good.mesh", "again.mesh"}, std::pair{"again.mesh", "third.mesh"}})
        ASSERT_EQ(run_wellmesh({"improve", scratch.file(in), "--plc", cube, "--min-dihedral", "25", "-o", scratch.file(out), "--quiet"}).status, 0);
    EXPECT_EQ(read_text(scratch.file("again.mesh")), read_text(scratch.file("third.mesh")));
}

TEST(improve_command, takes_the_meshes_of_another_program) {
    if (std::system("command -v tetgen > /dev/null 2>&1") != 0) GTEST_SKIP() << "tetgen is not installed: its meshes are not tried";
    const ScratchFolder scratch;
    const RunOptions here = {.folder = scratch.path()};
    ASSERT_EQ(run_wellmesh({"example", "-o", "bracket.poly"}, here).status, 0);
    (void)scratch.write("cube.poly", kCubePoly);
    for (const auto& [name, switches] : {std::pair{"cube", "-pq1.8a0.02Q"}, std::pair{"bracket", "-pq1.8AQ"}}) {
        SCOPED_TRACE(name);
        const std::string poly = scratch.file(std::string(name) + ".poly");
        ASSERT_EQ(std::system(("tetgen " + std::string(switches) + " " + poly + " > /dev/null 2>&1").c_str()), 0);
        const Outcome run = run_wellmesh({"improve", scratch.file(std::string(name) + ".1.ele"), "--plc", poly, "-o", "out.mesh", "--json", "report.json"}, here);
        ASSERT_EQ(run.status, 0) << run.out << run.err;
        const Outcome check = run_wellmesh({"check", "out.mesh", "--plc", poly, "--min-dihedral", "20", "--max-radius-edge", "2"}, here);
        EXPECT_EQ(check.status, 0) << check.out;
        const json report = report_of(scratch.file("report.json"));
        const json& given = report.at("statistics").at("given_mesh");
        EXPECT_GT(given.at("delaunay_tets").get<int>(), given.at("tets").get<int>() / 2);
        EXPECT_LT(report.at("vertices").get<double>(), 1.5 * given.at("vertices").get<double>());
    }
}

TEST(improve_command, refuses_a_mesh_of_another_domain_and_says_where) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.poly", kCubePoly);
    ASSERT_EQ(run_wellmesh({"example", "-o", scratch.file("bracket.poly")}).status, 0);
    ASSERT_EQ(run_wellmesh({"mesh", cube, "-o", scratch.file("cube.mesh"), "--quiet"}).status, 0);
    const Outcome run = run_wellmesh({"improve", scratch.file("cube.mesh"), "--plc", scratch.file("bracket.poly"), "-o", scratch.file("out.mesh"), "--json", scratch.file("report.json")});
    EXPECT_EQ(run.status, 2);
    EXPECT_TRUE(contains(run.err, "lie on no facet")) << run.err;
    EXPECT_TRUE(contains(run.err, "vertex ")) << run.err;
    EXPECT_EQ(report_of(scratch.file("report.json")).at("error").at("code"), "bad_input");
    EXPECT_EQ(scratch.listing(), (Names{"bracket.poly", "cube.mesh", "cube.poly", "report.json"}));
}

TEST(improve_command, arguments_are_checked) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.poly", kCubePoly);
    ASSERT_EQ(run_wellmesh({"mesh", cube, "-o", scratch.file("cube.mesh"), "--quiet"}).status, 0);
    const std::string mesh = scratch.file("cube.mesh");
    EXPECT_EQ(run_wellmesh({"improve", mesh}).status, 3);
    EXPECT_EQ(run_wellmesh({"improve", mesh, "--plc", cube, "-o", mesh}).status, 3);
    EXPECT_EQ(run_wellmesh({"improve", mesh, "--plc", cube, "--min-dihedral", "80"}).status, 3);
    EXPECT_EQ(run_wellmesh({"improve", mesh, "--plc", scratch.file("nothing.poly")}).status, 5);
    EXPECT_EQ(run_wellmesh({"improve", cube, "--plc", cube}).status, 5);  // no mesh format
}

TEST(improve_command, interrupt_leaves_nothing) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.poly", kCubePoly);
    ASSERT_EQ(run_wellmesh({"mesh", cube, "--size", "0.06", "--min-dihedral", "0", "--seeding", "off", "-o", scratch.file("cube.mesh"), "--quiet"}).status, 0);
    const Outcome run = run_wellmesh({"improve", scratch.file("cube.mesh"), "--plc", cube, "--min-dihedral", "60", "-o", scratch.file("out.mesh")}, {.signal = SIGINT});
    EXPECT_EQ(run.status, 130);
    EXPECT_EQ(scratch.listing(), (Names{"cube.mesh", "cube.poly"}));
}

}  // namespace
}  // namespace wellmesh::testing
