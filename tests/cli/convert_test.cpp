// SPDX-License-Identifier: Apache-2.0
// wellmesh convert, and regions that the command line names.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "cli/run_program.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::testing {
namespace {

using nlohmann::json;

// Two cubes one on the other with a common side, as a surface without seeds.
constexpr const char* kTower =
    "OFF\n12 11 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n0 0 2\n1 0 2\n1 1 2\n0 1 2\n"
    "4 3 2 1 0\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n4 4 5 6 7\n4 4 5 9 8\n4 5 6 10 9\n4 6 7 11 10\n4 7 4 8 11\n4 8 9 10 11\n";

json report_of(const std::string& path) { return json::parse(read_text(path)); }

TEST(region_flags, name_the_cells_of_a_surface) {
    const ScratchFolder scratch;
    const std::string tower = scratch.write("tower.off", kTower);
    const Outcome run = run_wellmesh({"mesh", tower, "--region-at", "0.5,0.5,0.5=base of it", "--region-at", "0.5,0.5,+1.5=7", "--min-dihedral", "0",
                                      "-o", scratch.file("t.msh"), "-o", scratch.file("t.vtu"), "--json", scratch.file("r.json")});
    ASSERT_EQ(run.status, 0) << run.out << run.err;
    EXPECT_TRUE(contains(run.out, "base of it"));
    const TetMesh mesh = read_mesh(scratch.file("t.msh"));
    EXPECT_EQ(std::set<std::int32_t>(mesh.tet_regions.begin(), mesh.tet_regions.end()), (std::set<std::int32_t>{1, 7}));
    EXPECT_EQ(*mesh.names.find(3, 1), "base of it");
    EXPECT_EQ(mesh.names, read_mesh(scratch.file("t.vtu")).names);
    const json cells = report_of(scratch.file("r.json")).at("statistics").at("cells");
    ASSERT_EQ(cells.size(), 3U);
    EXPECT_TRUE(cells[0].at("volume").is_null());
    EXPECT_EQ(cells[1].at("name"), "base of it");
    EXPECT_EQ(cells[1].at("volume"), 1.0);
    EXPECT_EQ(cells[2].at("region"), 7);

    const Outcome doctor = run_wellmesh({"doctor", tower, "--hole-at", "0.5,0.5,1.5", "--json", scratch.file("d.json")});
    EXPECT_EQ(doctor.status, 0) << doctor.out;
    EXPECT_EQ(report_of(scratch.file("d.json")).at("cells")[2].at("filled"), false);
    const Outcome conflict =
        run_wellmesh({"mesh", tower, "--region-at", "0.5,0.5,0.5=a", "--region-at", "0.2,0.5,0.5=b", "-o", scratch.file("x.msh")});
    EXPECT_EQ(conflict.status, 2);
    EXPECT_TRUE(contains(conflict.err, "lie in one cell")) << conflict.err;
    EXPECT_TRUE(contains(conflict.err, "(0.2, 0.5, 0.5)")) << conflict.err;
    for (const char* bad : {"0.5,0.5,0.5", "0.5,0.5=a", "a,b,c=d", "0,0,inf=d", "1,1,1=", "1,2,3,4=x"}) {
        const Outcome usage = run_wellmesh({"mesh", tower, "--region-at", bad});
        EXPECT_EQ(usage.status, 3) << bad;
        EXPECT_TRUE(contains(usage.err, "X,Y,Z=NAME")) << usage.err;
    }
    EXPECT_EQ(run_wellmesh({"mesh", tower, "--hole-at", "1,2"}).status, 3);
}

TEST(convert_command, meshes_and_complexes) {
    const ScratchFolder scratch;
    const RunOptions here{.folder = scratch.path()};
    (void)scratch.write("tower.off", kTower);
    ASSERT_EQ(run_wellmesh({"mesh", "tower.off", "--min-dihedral", "0", "--quiet", "-o", "a.mesh"}, here).status, 0);
    const TetMesh mesh = read_mesh(scratch.file("a.mesh"));
    // Once around all formats of meshes; .inp is written alone.
    const Names around{"a.mesh", "b.msh", "c.vtu", "d.node", "e.mesh"};
    for (std::size_t i = 0; i + 1 < around.size(); ++i) {
        const Outcome run = run_wellmesh({"convert", around[i], around[i + 1]}, here);
        ASSERT_EQ(run.status, 0) << run.err;
        EXPECT_TRUE(contains(run.out, "mesh: ")) << run.out;
        EXPECT_TRUE(contains(run.out, "wrote " + around[i + 1])) << run.out;
    }
    const TetMesh back = read_mesh(scratch.file("e.mesh"));
    EXPECT_EQ(back.vertices, mesh.vertices);
    EXPECT_EQ(back.tets.size(), mesh.tets.size());
    EXPECT_EQ(run_wellmesh({"check", "e.mesh", "--plc", "tower.off"}, here).status, 0);
    EXPECT_EQ(run_wellmesh({"convert", "a.mesh", "f.inp", "--quiet"}, here).out, "");
    // The complex: every format, and each of them meshes into the same volume.
    for (const char* name : {"t.poly", "t.smesh", "t.obj", "t.ply", "t.stl", "t.mesh", "t.msh", "t.vtp", "t.off"}) {
        const Outcome run = run_wellmesh({"convert", "tower.off", name, "--json", "r.json"}, here);
        ASSERT_EQ(run.status, 0) << run.err;
        EXPECT_EQ(report_of(scratch.file("r.json")).at("kind"), "complex");
        const Outcome doctor = run_wellmesh({"doctor", name, "--json", "d.json"}, here);
        EXPECT_EQ(doctor.status, 0) << name << doctor.out;
        const json cells = report_of(scratch.file("d.json")).at("cells");
        ASSERT_EQ(cells.size(), 3U) << name;
        EXPECT_EQ(cells[1].at("volume"), 1.0);
        EXPECT_EQ(cells[2].at("filled"), true);
    }
    const Outcome boundary = run_wellmesh({"convert", "a.mesh", "hull.poly", "--complex"}, here);
    EXPECT_EQ(boundary.status, 0);
    EXPECT_TRUE(contains(boundary.out, "complex: "));
}

TEST(convert_command, says_what_is_lost_and_what_is_wrong) {
    const ScratchFolder scratch;
    const RunOptions here{.folder = scratch.path()};
    (void)scratch.write("tower.off", kTower);
    (void)scratch.write("named.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\ng floor\nf 1 3 2\ng walls\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
    const Outcome lossy = run_wellmesh({"convert", "named.obj", "a.off"}, here);
    EXPECT_EQ(lossy.status, 0);
    EXPECT_TRUE(contains(lossy.out, ".off can't carry the 2 markers of facets")) << lossy.out;
    EXPECT_TRUE(contains(lossy.out, ".off can't carry 2 names of facets")) << lossy.out;
    EXPECT_EQ(run_wellmesh({"convert", "named.obj", "a.stl", "--binary"}, here).status, 0);
    EXPECT_EQ(read_plc(scratch.file("a.stl")).relative_rounding, 0x1p-24);

    const auto refused = [&](const Names& arguments, int status, const char* word) {
        const Outcome run = run_wellmesh(arguments, here);
        EXPECT_EQ(run.status, status) << run.err;
        EXPECT_TRUE(contains(run.err, word)) << run.err;
    };
    const Names before = scratch.listing();
    refused({"convert", "tower.off", "b.inp"}, 3, "'wellmesh mesh'");
    refused({"convert", "tower.off", "b.xyz"}, 3, "unknown format");
    refused({"convert", "tower.off", "tower.off"}, 3, "replace the input");
    refused({"convert", "nothing.off", "b.off"}, 5, "nothing.off");
    refused({"convert", "tower.off", "b.msh", "--msh-version", "3"}, 3, "41 or 22");
    refused({"convert", "tower.off", "b.mesh", "--references", "x"}, 3, "entity or marker");
    refused({"convert", "tower.off"}, 3, "OUTPUT");
    EXPECT_EQ(scratch.listing(), before);
}

}  // namespace
}  // namespace wellmesh::testing
