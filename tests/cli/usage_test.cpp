// SPDX-License-Identifier: Apache-2.0
// What people type wrong, and what --help says.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "cli/run_program.hpp"
#include "wellmesh/certificate.hpp"
#include "wellmesh/io.hpp"
#include "wellmesh/options.hpp"
#include "wellmesh/version.hpp"

namespace wellmesh::testing {
namespace {


const Names kCommands = {"mesh", "check", "quality", "doctor", "delaunay", "example"};
TEST(usage, version_is_the_headers) {
    const Outcome outcome = run_wellmesh({"--version"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(outcome.out, "wellmesh " WELLMESH_VERSION "\n");
}

TEST(usage, help_of_every_command_explains_the_exit_status) {
    std::vector<Names> calls = {{"--help"}};
    for (const std::string& command : kCommands) calls.push_back({command, "--help"});
    for (const Names& call : calls) {
        const Outcome outcome = run_wellmesh(call);
        EXPECT_EQ(outcome.status, 0) << call[0];
        EXPECT_EQ(outcome.err, "") << call[0];
        for (const char* status : {"0 ", "1 ", "2 ", "3 ", "4 ", "5 ", "70 ", "130 "})
            EXPECT_TRUE(contains(outcome.out, fmt::format("\n  {} ", status))) << call[0] << ": " << status;
    }
    EXPECT_TRUE(contains(run_wellmesh({"mesh", "--help"}).out, "Usage: wellmesh mesh [OPTIONS] INPUT"));
}

TEST(usage, defaults_in_help_are_those_of_the_structs) {
    const MeshOptions options;
    const std::string mesh = run_wellmesh({"mesh", "--help"}).out;
    EXPECT_TRUE(contains(mesh, fmt::format("--max-radius-edge RATIO={} ", options.quality.max_radius_edge_ratio))) << mesh;
    EXPECT_TRUE(contains(mesh, fmt::format("--min-dihedral DEG={} ", options.quality.min_dihedral_angle_deg))) << mesh;
    EXPECT_TRUE(contains(mesh, fmt::format("--seed N={} ", options.seed))) << mesh;
    EXPECT_TRUE(contains(mesh, fmt::format("--slivers none|refine|improve|chew|exude|perturb|best={}\n", to_string(options.slivers)))) << mesh;
    EXPECT_TRUE(contains(mesh, fmt::format("--msh-version 41|22={} ", WriteOptions{}.msh_version))) << mesh;
    // Those that say "default: none" must have none.
    EXPECT_FALSE(options.size.edge_length || options.size.max_volume || options.limits.max_vertices || options.limits.time || options.coplanar_tolerance);

    const CertifyOptions certify;
    const std::string check = run_wellmesh({"check", "--help"}).out;
    EXPECT_TRUE(contains(check, fmt::format("--tolerance REL={:g} ", certify.tolerance))) << check;
    EXPECT_TRUE(contains(check, fmt::format("--flat-angle RAD={:g} ", certify.flat_angle_rad))) << check;
}

TEST(usage, slips_are_answered_with_the_nearest_word) {
    const std::vector<std::pair<Names, std::string>> slips = {
        {{"mesh", "x.off", "--sise", "3"}, "did you mean '--size'?"},
        {{"mesh", "--max-radius-edg=3", "x.off"}, "did you mean '--max-radius-edge'?"},
        {{"check", "x.mesh", "--pcl", "y"}, "did you mean '--plc'?"},
        {{"mash", "x.off"}, "did you mean 'mesh'?"},
        {{"mesh", "x.off", "--zzzzzz"}, "known are --help"},
        {{"mesh", "x.off", "y.off"}, "unexpected argument 'y.off'"},
        {{"mesh"}, "INPUT is required"},
        {{}, "known are mesh improve study check quality doctor delaunay convert example"},
    };
    for (const auto& [arguments, answer] : slips) {
        const Outcome outcome = run_wellmesh(arguments);
        EXPECT_EQ(outcome.status, 3) << answer;
        EXPECT_EQ(outcome.out, "") << answer;
        EXPECT_TRUE(contains(outcome.err, answer)) << outcome.err;
    }
}

TEST(usage, values_out_of_range_are_refused_with_the_range) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const std::vector<std::pair<Names, std::string>> bad = {
        {{"--size", "0"}, "above 0"}, {{"--size", "-1"}, "above 0"}, {{"--size", "nan"}, "above 0"}, {{"--size", "inf"}, "above 0"},
        {{"--size", "1e400"}, "above 0"}, {{"--size", "three"}, "--size"}, {{"--max-volume", "nan"}, "above 0"}, {{"--max-volume", "-2"}, "above 0"},
        {{"--max-radius-edge", "0.6"}, "0.6124"}, {{"--max-radius-edge", "inf"}, "0.6124"}, {{"--max-radius-edge", "nan"}, "0.6124"},
        {{"--min-dihedral", "-1"}, "70.52"}, {{"--min-dihedral", "71"}, "70.52"}, {{"--min-dihedral", "nan"}, "70.52"},
        {{"--thin-features", "perhaps"}, "neither join nor refuse"}, {{"--coplanar-tolerance", "-1e-9"}, "at least 0"}, {{"--coplanar-tolerance", "nan"}, "at least 0"},
        {{"--max-vertices", "3"}, "at least 4"}, {{"--max-vertices", "-5"}, "whole number"}, {{"--max-vertices", "1e3"}, "whole number"},
        {{"--min-dihedral", ""}, "must not be empty"}, {{"--size", ""}, "must not be empty"},
        {{"--seed", "-1"}, "whole number"}, {{"--seed", "18446744073709551616"}, "whole number"}, {{"--seed", ""}, "whole number"},
        {{"--time-limit", "0"}, "seconds"}, {{"--time-limit", "-1"}, "seconds"}, {{"--time-limit", "nan"}, "seconds"}, {{"--time-limit", "1e300"}, "seconds"},
        {{"--msh-version", "40"}, "41 or 22"},
        {{"--slivers", "exuded"}, "one of none refine improve chew exude perturb best, not 'exuded'"},
        {{"--slivers", "chew"}, "needs a size"}, {{"--min-dihedral-boundary", "5"}, "refine and improve"}, {{"--sigma0-boundary", "0.01"}, "refine and improve"},
        {{"--mode", "proven"}, "practical or certified"}, {{"--delta", "1"}, "above 0 and below 1"}, {{"--delta", "nan"}, "above 0 and below 1"},
        {{"--b", "4.5"}, "belongs to certified mode"}, {{"--sigma0", "0.01"}, "belongs to certified mode"}, {{"--rho0", "inf"}, "0.6124"},
    };
    for (const auto& [option, answer] : bad) {
        Names arguments = {"mesh", cube, "-o", scratch.file("out.mesh"), "--json", scratch.file("report.json")};
        arguments.insert(arguments.end(), option.begin(), option.end());
        const Outcome outcome = run_wellmesh(arguments);
        EXPECT_EQ(outcome.status, 3) << option[0] << ' ' << option[1] << '\n' << outcome.err;
        EXPECT_TRUE(contains(outcome.err, answer)) << option[0] << ' ' << option[1] << '\n' << outcome.err;
    }
    EXPECT_EQ(scratch.listing(), Names{"cube.off"});
    for (const Names& option : {Names{"--tolerance", "-1"}, Names{"--flat-angle", "nan"}, Names{"--max-aspect", "0"}, Names{"--min-sigma", "-1"}, Names{"--min-dihedral-boundary", "91"},
                                Names{"--min-sigma-boundary", "nan"}})
        EXPECT_EQ(run_wellmesh({"check", cube, option[0], option[1]}).status, 3) << option[0];
}

TEST(usage, certified_constants_outside_the_theorems_are_refused_with_the_range) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const std::vector<std::pair<Names, std::string>> bad = {
        {{"--delta", "1"}, "delta must be above 0 and below 1, not 1"}, {{"--delta", "0"}, "above 0 and below 1"}, {{"--delta", "-0.1"}, "above 0 and below 1"},
        {{"--delta", "nan"}, "above 0 and below 1"}, {{"--delta", "inf"}, "above 0 and below 1"},
        {{"--b", "0"}, "b must be a finite number above 0"}, {{"--b", "-1"}, "finite number above 0"}, {{"--b", "nan"}, "finite number above 0"}, {{"--b", "inf"}, "finite number above 0"},
        {{"--b", "4.2"}, "(1 - delta) b >= 4 (Theorem 4.2) is violated: 3.99 with delta = 0.05, b = 4.2, rho0 = 20; b must be at least 4.2106"},
        {{"--rho0", "8"}, "(1 - delta)^2 rho0 >= 8 (Theorem 4.2)"}, {{"--max-radius-edge", "14"}, "Theorem 5.1, grading"}, {{"--rho0", "nan"}, "finite number"}, {{"--rho0", "inf"}, "finite number"},
        {{"--delta", "0.2"}, "b must be at least 5, or delta at most 0.1111"},
        {{"--sigma0", "0"}, "sigma0 must be above 0 and at most 0.1179"}, {{"--sigma0", "nan"}, "at most 0.1179"}, {{"--sigma0", "0.2"}, "at most 0.1179"},
        {{"--min-dihedral", "20"}, "judges slivers by sigma0"},
    };
    for (const auto& [option, answer] : bad) {
        const Outcome outcome = run_wellmesh({"mesh", cube, "--mode", "certified", option[0], option[1]});
        EXPECT_EQ(outcome.status, 3) << option[0] << ' ' << option[1];
        EXPECT_TRUE(contains(outcome.err, answer)) << option[0] << ' ' << option[1] << '\n' << outcome.err;
    }
}

TEST(usage, several_bad_values_are_listed_at_once) {
    const Outcome outcome = run_wellmesh({"mesh", "x.off", "--size", "-1", "--min-dihedral", "80", "--max-radius-edge", "0"});
    EXPECT_EQ(outcome.status, 3);
    for (const char* field : {"size", "min dihedral angle", "max radius-edge ratio"}) EXPECT_TRUE(contains(outcome.err, field)) << outcome.err;
}

TEST(usage, outputs_are_checked_before_the_work) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const std::string poly = scratch.write("part.poly", "0 3 0 0\n");
    const std::string node = scratch.write("part.node", "0 3 0 0\n");
    const auto status = [&](const Names& arguments) { return run_wellmesh(arguments, {.folder = scratch.path()}).status; };
    EXPECT_EQ(status({"mesh", cube, "-o", "out.foo"}), 3);
    EXPECT_EQ(status({"mesh", cube, "-o", "out"}), 3);
    EXPECT_EQ(status({"mesh", cube, "-o", "out.vtu", "-o", "./out.vtu"}), 3);
    EXPECT_EQ(status({"mesh", cube, "-o", "out.node", "-o", "out.ele"}), 3);
    EXPECT_EQ(status({"mesh", poly, "-o", "part.ele"}), 3) << "would replace the input's part.node";
    EXPECT_EQ(status({"mesh", cube, "--json", "./cube.off"}), 3);
    EXPECT_EQ(status({"mesh", cube, "-o", "out.mesh", "--json", "out.mesh"}), 3);
    EXPECT_EQ(status({"mesh", cube, "-o", "no-such-folder/out.vtu"}), 5);
    EXPECT_EQ(status({"mesh", cube, "--json", scratch.path().string()}), 5);
    EXPECT_EQ(status({"mesh", "no-such-file.off"}), 5);
    EXPECT_EQ(status({"check", "no-such-file.mesh"}), 5);
    EXPECT_EQ(status({"doctor", "no-such-file.off"}), 5);
    EXPECT_EQ(status({"quality", "no-such-file.mesh"}), 5);
    EXPECT_EQ(status({"delaunay", "no-such-file.xyz"}), 5);
    EXPECT_EQ(status({"example", "-o", "out.stl"}), 3);
    EXPECT_EQ(scratch.listing(), (Names{"cube.off", "part.node", "part.poly"}));
    EXPECT_EQ(read_text(cube), kCubeOff);
    EXPECT_EQ(read_text(node), "0 3 0 0\n");
}

}  // namespace
}  // namespace wellmesh::testing
