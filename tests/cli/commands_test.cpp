// SPDX-License-Identifier: Apache-2.0
// What the commands write and say, and what they leave behind when they fail.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "cli/run_program.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::testing {
namespace {

using nlohmann::json;

constexpr const char* kOpenBoxOff =
    "OFF\n8 5 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n"
    "4 3 2 1 0\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";

TEST(mesh_command, example_meets_its_goals_and_the_certificate_holds_for_the_file) {
    const ScratchFolder scratch;
    const RunOptions here = {.folder = scratch.path()};
    ASSERT_EQ(run_wellmesh({"example", "-o", "bracket.poly"}, here).status, 0);
    const Outcome run = run_wellmesh({"mesh", "bracket.poly", "--size", "6", "-o", "bracket.mesh", "-o", "bracket.vtu", "-o", "bracket.msh",
                                      "-o", "bracket_tets.node", "--json", "report.json"}, here);
    ASSERT_EQ(run.status, 0) << run.out << run.err;
    for (const char* part : {"Asked and achieved", "Certificate", "proven", "wrote bracket.vtu", "Time"}) EXPECT_TRUE(contains(run.out, part)) << part;
    EXPECT_FALSE(contains(run.out + run.err, "\r"));

    const json report = json::parse(read_text(scratch.path() / "report.json"));
    EXPECT_EQ(report.at("exit_status"), 0);
    EXPECT_EQ(report.at("termination"), "goals_met");
    EXPECT_EQ(report.at("options").at("edge_length"), 6);
    EXPECT_TRUE(report.at("certificate").at("proven"));
    ASSERT_FALSE(report.at("goals").empty());
    for (const json& goal : report.at("goals")) EXPECT_TRUE(goal.at("met")) << goal;
    std::set<int> regions;
    for (const json& region : report.at("certificate").at("regions")) regions.insert(region.at("region").get<int>());
    EXPECT_EQ(regions, (std::set<int>{1, 2}));
    for (const json& file : report.at("files")) EXPECT_TRUE(std::filesystem::exists(scratch.path() / file.get<std::string>())) << file;
    for (const char* stage : {"read", "write"})
        EXPECT_TRUE(std::any_of(report.at("timings").begin(), report.at("timings").end(), [&](const json& t) { return t.at("stage") == stage; }));

    const TetMesh mesh = read_mesh(scratch.path() / "bracket.mesh");
    EXPECT_EQ(mesh.tets.size(), report.at("tets").get<std::size_t>());
    EXPECT_EQ(read_mesh(scratch.path() / "bracket_tets.ele").tets.size(), mesh.tets.size());
    const Outcome check = run_wellmesh({"check", "bracket.mesh", "--plc", "bracket.poly", "--max-radius-edge", "2", "--min-dihedral", "20"}, here);
    EXPECT_EQ(check.status, 0) << check.out << check.err;
    EXPECT_FALSE(contains(check.out, "REFUTED"));
}

TEST(mesh_command, example_has_no_acute_angle) {
    const ScratchFolder scratch;
    const RunOptions here = {.folder = scratch.path()};
    ASSERT_EQ(run_wellmesh({"example", "-o", "bracket.poly"}, here).status, 0);
    const Outcome doctor = run_wellmesh({"doctor", "bracket.poly", "--json", "-"}, here);
    ASSERT_EQ(doctor.status, 0) << doctor.out << doctor.err;
    const json diagnosis = json::parse(doctor.out);
    for (const json& defect : diagnosis.at("defects")) EXPECT_EQ(defect.at("severity"), "note") << defect;
    const json& cells = diagnosis.at("cells");
    EXPECT_EQ(std::count_if(cells.begin(), cells.end(), [](const json& cell) { return cell.at("filled").get<bool>(); }), 2);
}

TEST(mesh_command, certified_mode_shows_that_every_claim_held) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const Outcome run = run_wellmesh({"mesh", cube, "--mode", "certified", "--size", "0.3", "--json", scratch.file("report.json"), "-o", scratch.file("out.mesh")});
    ASSERT_EQ(run.status, 0) << run.out << run.err;
    for (const char* part : {"The paper's claims", "10^-", "lemma_5_1_case_7", "theorem_5_2", "min sigma V/L^3"}) EXPECT_TRUE(contains(run.out, part)) << part;
    const json report = json::parse(read_text(scratch.path() / "report.json"));
    EXPECT_EQ(report.at("options").at("mode"), "certified");
    EXPECT_EQ(report.at("options").at("max_radius_edge_ratio"), 20);
    const json& invariants = report.at("invariants");
    EXPECT_EQ(invariants.at("violations"), 0);
    EXPECT_LT(invariants.at("log10_existence_sigma0").get<double>(), -1000);
    EXPECT_GE(invariants.at("claims").size(), 29U);
    for (const json& timing : report.at("timings")) EXPECT_NE(timing.at("stage"), "shape");
    EXPECT_EQ(run_wellmesh({"check", scratch.file("out.mesh"), "--plc", cube, "--max-radius-edge", "20", "--min-sigma", "0.005"}).status, 0);
}

TEST(mesh_command, slivers_are_treated_as_asked_and_what_is_missed_is_said) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const auto mesh = [&](Names options) {
        Names arguments = {"mesh", cube, "-o", scratch.file("out.mesh"), "--json", "-", "--size", "0.2"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const Outcome outcome = run_wellmesh(arguments);
        return std::pair{outcome.status, json::parse(outcome.out)};
    };
    const auto goals = [](const json& report) {
        Names names;
        for (const json& goal : report["goals"]) names.push_back(goal["goal"]);
        return names;
    };
    // No care for slivers is no goal for them; one that is given counts.
    const auto [none_status, none] = mesh({"--slivers", "none"});
    EXPECT_EQ(none_status, 0);
    EXPECT_EQ(none["options"]["slivers"], "none");
    EXPECT_EQ(none["options"]["min_dihedral_angle_deg"], 0);
    EXPECT_EQ(mesh({"--slivers", "none", "--min-dihedral", "20"}).first, 1);
    EXPECT_EQ(mesh({"--slivers", "refine"}).first, 0);
    EXPECT_EQ(mesh({"--slivers", "perturb"}).first, 0);
    const auto [sigma_status, sigma] = mesh({"--slivers", "refine", "--sigma0", "0.04"});
    EXPECT_EQ(sigma_status, 0);
    EXPECT_EQ(sigma["options"]["min_dihedral_angle_deg"], 0);
    EXPECT_EQ(goals(sigma).at(1), "min sigma V/L^3");
    const auto [hopeless_status, hopeless] = mesh({"--slivers", "refine", "--min-dihedral", "45"});
    EXPECT_EQ(hopeless_status, 1);
    EXPECT_EQ(hopeless["termination"], "goals_unmet");
    EXPECT_NE(hopeless["statistics"]["notes"].dump().find("refine stopped at"), std::string::npos);
    const auto [parts_status, parts] = mesh({"--slivers", "improve", "--min-dihedral", "12", "--min-dihedral-boundary", "8"});
    EXPECT_EQ(parts_status, 0);
    EXPECT_EQ(goals(parts).at(1), "min dihedral angle [deg] inside");
    EXPECT_EQ(goals(parts).at(2), "min dihedral angle [deg] at the boundary");
}

TEST(mesh_command, practical_mode_counts_the_claims_on_request) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const Outcome without = run_wellmesh({"mesh", cube, "--size", "0.3", "--json", "-"}), with = run_wellmesh({"mesh", cube, "--size", "0.3", "--invariants", "--json", "-"});
    EXPECT_EQ(without.status, 0);
    EXPECT_EQ(with.status, 0);
    EXPECT_FALSE(json::parse(without.out).contains("invariants"));
    EXPECT_EQ(json::parse(with.out).at("invariants").at("delta"), 0.3);
    EXPECT_EQ(json::parse(with.out).at("vertices"), json::parse(without.out).at("vertices"));
}

TEST(mesh_command, json_on_standard_output_is_alone_there) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const Outcome run = run_wellmesh({"mesh", cube, "--size", "0.5", "--min-dihedral", "0", "--json", "-"});
    EXPECT_EQ(run.status, 0);
    EXPECT_EQ(json::parse(run.out).at("command"), "mesh");
    EXPECT_TRUE(contains(run.err, "Asked and achieved"));
    EXPECT_EQ(scratch.listing(), Names{"cube.off"});
}

TEST(mesh_command, quiet_says_nothing) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const Outcome run = run_wellmesh({"mesh", cube, "--min-dihedral", "0", "--quiet", "-o", scratch.file("cube.mesh")}, {.terminal = true});
    EXPECT_EQ(run.status, 0);
    EXPECT_EQ(run.out + run.err, "");
    EXPECT_EQ(scratch.listing(), (Names{"cube.mesh", "cube.off"}));
}

TEST(mesh_command, equal_seeds_give_equal_bytes) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    for (const char* name : {"a.mesh", "b.mesh"})
        ASSERT_EQ(run_wellmesh({"mesh", cube, "--size", "0.2", "--min-dihedral", "0", "--seed", "7", "-o", scratch.file(name)}).status, 0);
    ASSERT_EQ(run_wellmesh({"mesh", cube, "--size", "0.2", "--min-dihedral", "0", "--seed", "8", "-o", scratch.file("c.mesh")}).status, 0);
    EXPECT_EQ(read_text(scratch.file("a.mesh")), read_text(scratch.file("b.mesh")));
    EXPECT_NE(read_text(scratch.file("a.mesh")), read_text(scratch.file("c.mesh")));
}

TEST(mesh_command, bad_input_is_diagnosed_and_no_mesh_written) {
    const ScratchFolder scratch;
    const std::string box = scratch.write("open.off", kOpenBoxOff);
    const Outcome run = run_wellmesh({"mesh", box, "-o", scratch.file("out.vtu"), "--json", scratch.file("report.json")});
    EXPECT_EQ(run.status, 2) << run.err;
    EXPECT_FALSE(run.err.empty());
    EXPECT_EQ(scratch.listing(), (Names{"open.off", "report.json"}));
    const json report = json::parse(read_text(scratch.file("report.json")));
    EXPECT_EQ(report.at("exit_status"), 2);
    EXPECT_EQ(report.at("error").at("code"), "bad_input");

    const Outcome doctor = run_wellmesh({"doctor", box, "--json", "-"});
    EXPECT_EQ(doctor.status, 2);
    EXPECT_TRUE(json::parse(doctor.out).at("has_errors"));
    EXPECT_TRUE(contains(doctor.err, "open_edge")) << doctor.err;
}

TEST(mesh_command, budgets_end_in_a_mesh_or_in_nothing) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    // The holes of the bracket need vertices of their own before its facets are in the mesh; its 96 are all there may be.
    ASSERT_EQ(run_wellmesh({"example", "-o", scratch.file("bracket.poly")}).status, 0);
    const Outcome early = run_wellmesh({"mesh", scratch.file("bracket.poly"), "--max-vertices", "96", "-o", scratch.file("out.mesh")});
    EXPECT_EQ(early.status, 4) << early.err;
    EXPECT_TRUE(contains(early.err, "budget_exhausted")) << early.err;
    EXPECT_EQ(scratch.listing(), (Names{"bracket.poly", "cube.off"}));

    const Outcome late = run_wellmesh({"mesh", cube, "--size", "0.05", "--max-vertices", "500", "-o", scratch.file("out.mesh"), "--json", scratch.file("r.json")});
    EXPECT_EQ(late.status, 1) << late.err;
    EXPECT_EQ(json::parse(read_text(scratch.file("r.json"))).at("termination"), "vertex_budget_reached");
    EXPECT_LE(read_mesh(scratch.file("out.mesh")).vertices.size(), 500U);
    EXPECT_TRUE(contains(late.out, " NO ")) << late.out;
}

TEST(mesh_command, time_limit_gives_the_mesh_so_far) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const Outcome run = run_wellmesh({"mesh", cube, "--size", "0.01", "--time-limit", "0.5", "-o", scratch.file("out.mesh"), "--json", scratch.file("r.json")});
    EXPECT_EQ(run.status, 1) << run.err;
    EXPECT_EQ(json::parse(read_text(scratch.file("r.json"))).at("termination"), "time_budget_reached");
    EXPECT_EQ(run_wellmesh({"check", scratch.file("out.mesh"), "--plc", cube}).status, 0);
}

class interrupted : public ::testing::TestWithParam<int> {};

TEST_P(interrupted, run_ends_with_130_and_leaves_nothing) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const Outcome run = run_wellmesh({"mesh", cube, "--size", "0.004", "-o", scratch.file("out.mesh"), "-o", scratch.file("out.vtu"), "--json", scratch.file("r.json")},
                                     {.signal = GetParam(), .signal_after = std::chrono::milliseconds(700)});
    EXPECT_EQ(run.status, 130) << run.err;
    EXPECT_EQ(scratch.listing(), Names{"cube.off"});
}
INSTANTIATE_TEST_SUITE_P(signals, interrupted, ::testing::Values(SIGINT, SIGTERM, SIGHUP));

TEST(interrupt, an_ignored_signal_stays_ignored) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const Outcome run = run_wellmesh({"mesh", cube, "--size", "0.01", "--time-limit", "1.5", "-o", scratch.file("out.mesh"), "--quiet"},
                                     {.ignore_interrupt = true, .signal = SIGINT});
    EXPECT_EQ(run.status, 1) << run.err;
    EXPECT_EQ(scratch.listing(), (Names{"cube.off", "out.mesh"}));
}

TEST(files, a_full_disk_leaves_no_file) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    for (const char* name : {"out.mesh", "out.vtu", "out.msh", "out.node"}) {
        const Outcome run = run_wellmesh({"mesh", cube, "--size", "0.1", "--min-dihedral", "0", "-o", scratch.file(name)}, {.file_size_limit = 4096});
        EXPECT_EQ(run.status, 5) << name << run.err;
        EXPECT_TRUE(contains(run.err, "cannot_write")) << run.err;
        EXPECT_EQ(scratch.listing(), Names{"cube.off"}) << name;
    }
    EXPECT_EQ(run_wellmesh({"mesh", cube, "--json", "/dev/full"}).status, 5);
    EXPECT_EQ(run_wellmesh({"mesh", cube, "--json", scratch.file("r.json")}, {.file_size_limit = 1000}).status, 5);
    EXPECT_EQ(scratch.listing(), Names{"cube.off"});
}

TEST(files, a_device_is_written_in_place) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    EXPECT_EQ(run_wellmesh({"mesh", cube, "--min-dihedral", "0", "--json", "/dev/null", "--quiet"}).status, 0);
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST(files, a_closed_pipe_costs_no_output_file) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    (void)run_wellmesh({"mesh", cube, "-o", scratch.file("out.mesh")}, {.closed_stdout = true});
    EXPECT_GT(read_mesh(scratch.file("out.mesh")).tets.size(), 0U);
    EXPECT_EQ(scratch.listing(), (Names{"cube.off", "out.mesh"}));
}

TEST(memory, exhaustion_is_said_and_nothing_written) {
#ifdef WELLMESH_SANITIZED
    GTEST_SKIP() << "sanitizers reserve more address space than the limit";
#endif
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const Outcome run = run_wellmesh({"mesh", cube, "--size", "0.005", "-o", scratch.file("out.mesh")}, {.address_space_limit = 200U << 20});
    EXPECT_EQ(run.status, 4) << run.err;
    EXPECT_TRUE(contains(run.err, "out of memory")) << run.err;
    EXPECT_EQ(scratch.listing(), Names{"cube.off"});
}

TEST(progress, line_on_a_terminal_is_erased_at_the_end) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const Outcome run = run_wellmesh({"mesh", cube, "--size", "0.05", "--min-dihedral", "0", "-o", scratch.file("out.mesh")}, {.terminal = true});
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_TRUE(contains(run.err, " vertices, ")) << run.err;
    EXPECT_TRUE(contains(run.err, "bad elements left")) << run.err;
    const std::string erased = "\r\033[K";
    ASSERT_GE(run.err.size(), erased.size());
    EXPECT_EQ(run.err.substr(run.err.size() - erased.size()), erased);
    EXPECT_FALSE(contains(run.err, "\n"));
}

TEST(check_command, damage_is_refuted_with_a_witness) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    ASSERT_EQ(run_wellmesh({"mesh", cube, "--size", "0.25", "--min-dihedral", "0", "-o", scratch.file("good.mesh")}).status, 0);
    EXPECT_EQ(run_wellmesh({"check", scratch.file("good.mesh"), "--plc", cube, "--quiet"}).status, 0);

    TetMesh mesh = read_mesh(scratch.file("good.mesh"));
    mesh.tets.pop_back();
    mesh.tet_regions.pop_back();
    write_mesh(mesh, scratch.file("bad.mesh"));
    const Outcome check = run_wellmesh({"check", scratch.file("bad.mesh"), "--plc", cube, "--json", scratch.file("r.json")});
    EXPECT_EQ(check.status, 1);
    EXPECT_TRUE(contains(check.out, "REFUTED")) << check.out;
    const json report = json::parse(read_text(scratch.file("r.json")));
    EXPECT_FALSE(report.at("certificate").at("proven"));
    for (const json& claim : report.at("certificate").at("claims"))
        if (claim.at("state") == "refuted") {
            EXPECT_GT(claim.at("violations"), 0) << claim;
            EXPECT_FALSE(claim.at("witness").is_null() && claim.at("detail").get<std::string>().empty()) << claim;
        }
    EXPECT_EQ(run_wellmesh({"check", scratch.file("good.mesh"), "--min-dihedral", "60"}).status, 1);
}

/// A weighted mesh says so everywhere, and is checked from its files with its weights only.
TEST(check_command, weighted_meshes_are_checked_with_their_weights) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const Outcome run = run_wellmesh({"mesh", cube, "--size", "0.2", "--slivers", "exude", "--min-dihedral", "5", "--json", scratch.file("m.json"),
                                      "-o", scratch.file("a.mesh"), "-o", scratch.file("b.node"), "-o", scratch.file("c.vtu")});
    ASSERT_EQ(run.status, 0) << run.out << run.err;
    EXPECT_TRUE(contains(run.out, "the mesh is weighted Delaunay")) << run.out;
    EXPECT_TRUE(contains(run.out, "weighted_delaunay")) << run.out;
    const json made = json::parse(read_text(scratch.file("m.json")));
    EXPECT_EQ(made.at("options").at("slivers"), "exude");
    EXPECT_GT(made.at("statistics").at("weighted_vertices"), 0);
    for (const json& claim : made.at("certificate").at("claims")) EXPECT_NE(claim.at("name"), "delaunay");
    EXPECT_TRUE(contains(read_text(scratch.file("c.vtu")), "Name=\"weight\""));
    for (const auto& [mesh, weights] : {std::pair{"a.mesh", "a.weights.sol"}, {"b.node", "b.node"}, {"a.mesh", "b.node"}}) {
        const Outcome check = run_wellmesh({"check", scratch.file(mesh), "--plc", cube, "--weights", scratch.file(weights), "--min-dihedral", "5", "--json",
                                            scratch.file("r.json")});
        EXPECT_EQ(check.status, 0) << check.out;
        EXPECT_EQ(json::parse(read_text(scratch.file("r.json"))).at("weights"), scratch.file(weights));
        const Outcome without = run_wellmesh({"check", scratch.file(mesh), "--plc", cube});
        EXPECT_EQ(without.status, 1);
        EXPECT_TRUE(contains(without.out, "REFUTED")) << without.out;
    }
    EXPECT_EQ(run_wellmesh({"check", scratch.file("a.mesh"), "--weights", scratch.file("none.sol")}).status, 5);
    const std::string bad = scratch.write("w.sol", "MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n1\n1 1\nno\n");
    const Outcome wrong = run_wellmesh({"check", scratch.file("a.mesh"), "--weights", bad});
    EXPECT_EQ(wrong.status, 2);
    EXPECT_TRUE(contains(wrong.err, "w.sol:6")) << wrong.err;
}

TEST(check_command, what_is_no_mesh_is_bad_input) {
    const ScratchFolder scratch;
    EXPECT_EQ(run_wellmesh({"check", scratch.write("a.mesh", "")}).status, 2);
    EXPECT_EQ(run_wellmesh({"check", scratch.write("b.mesh", "MeshVersionFormatted 2\nDimension 3\nVertices\n99999999999\n")}).status, 2);
    EXPECT_EQ(run_wellmesh({"quality", scratch.write("c.mesh", "hello")}).status, 2);
}

TEST(quality_command, histogram_counts_every_tetrahedron) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    ASSERT_EQ(run_wellmesh({"mesh", cube, "--size", "0.25", "--min-dihedral", "0", "-o", scratch.file("cube.mesh")}).status, 0);
    const Outcome quality = run_wellmesh({"quality", scratch.file("cube.mesh"), "--json", scratch.file("r.json")});
    EXPECT_EQ(quality.status, 0);
    EXPECT_TRUE(contains(quality.out, "####")) << quality.out;
    const json report = json::parse(read_text(scratch.file("r.json")));
    std::uint64_t sum = 0;
    for (const json& bin : report.at("all").at("min_dihedral_histogram")) sum += bin.get<std::uint64_t>();
    EXPECT_EQ(sum, report.at("tets").get<std::uint64_t>());
    EXPECT_EQ(report.at("interior").at("tets").get<std::uint64_t>() + report.at("boundary").at("tets").get<std::uint64_t>(), sum);
}

TEST(delaunay_command, timings_are_json_on_standard_output) {
    const ScratchFolder scratch;
    std::ostringstream points;
    points.precision(17);
    for (int i = 0; i < 200; ++i) points << (i * 37 % 101) / 101.0 << ' ' << (i * 53 % 211) / 211.0 << ' ' << (i * 71 % 307) / 307.0 << '\n';
    points << "0 0 0\n";  // again
    const std::string file = scratch.write("points.xyz", points.str());
    const Outcome run = run_wellmesh({"delaunay", file, "-o", scratch.file("out.mesh"), "-o", scratch.file("out.vtu")});
    ASSERT_EQ(run.status, 0) << run.err;
    const json report = json::parse(run.out);
    EXPECT_EQ(report.at("points"), 201);
    EXPECT_EQ(report.at("duplicates"), 1);
    EXPECT_GT(report.at("tets"), 200);
    for (const char* key : {"read_seconds", "delaunay_seconds", "write_seconds"}) EXPECT_GE(report.at(key).get<double>(), 0) << key;
    EXPECT_EQ(read_mesh(scratch.file("out.mesh")).tets.size(), report.at("tets").get<std::size_t>());

    EXPECT_EQ(run_wellmesh({"delaunay", scratch.write("flat.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n")}).status, 2);
    EXPECT_EQ(run_wellmesh({"delaunay", scratch.write("nan.xyz", "0 0 0\n1 0 0\n0 1 0\n0 0 nan\n")}).status, 2);
}

}  // namespace
}  // namespace wellmesh::testing
