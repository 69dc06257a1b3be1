// SPDX-License-Identifier: Apache-2.0
// Limits as a user meets them: statuses, messages, and what is on disk afterwards.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"

namespace wellmesh::testing {
namespace {

using nlohmann::json;

TEST(limits, fewer_vertices_than_the_input_has_are_an_error) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const Outcome run = run_wellmesh({"mesh", cube, "--max-vertices", "7", "-o", scratch.file("out.mesh"), "--json", scratch.file("r.json")});
    EXPECT_EQ(run.status, 4) << run.err;
    EXPECT_TRUE(contains(run.err, "at most 7 vertices were allowed, and 8 are there already")) << run.err;
    EXPECT_EQ(scratch.listing(), (Names{"cube.off", "r.json"}));
    EXPECT_EQ(json::parse(read_text(scratch.file("r.json"))).at("error").at("code"), "budget_exhausted");
}

TEST(limits, a_spent_number_of_vertices_is_said_with_what_is_missed) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const Outcome run = run_wellmesh({"mesh", cube, "--size", "0.05", "--max-vertices", "300", "-o", scratch.file("out.mesh")});
    EXPECT_EQ(run.status, 1) << run.err;
    EXPECT_TRUE(contains(run.out, "vertex_budget_reached") || contains(run.err, "vertex_budget_reached")) << run.out << run.err;
    EXPECT_TRUE(contains(run.out, " NO ")) << run.out;
    const Outcome few = run_wellmesh({"mesh", cube, "--max-vertices", "3"});
    EXPECT_EQ(few.status, 3) << few.err;
    EXPECT_TRUE(contains(few.err, "at least 4")) << few.err;
}

TEST(limits, sizes_of_memory_as_people_type_them) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const auto bytes = [&](const std::string& size) {
        const Outcome run = run_wellmesh({"mesh", cube, "--min-dihedral", "0", "--max-memory", size, "--quiet", "--json", "-"});
        EXPECT_EQ(run.status, 0) << size << ": " << run.err;
        return run.status == 0 ? json::parse(run.out).at("options").at("max_memory_bytes").get<std::uint64_t>() : 0;
    };
    EXPECT_EQ(bytes("2000000000"), 2'000'000'000U);
    EXPECT_EQ(bytes("700M"), std::uint64_t{700} << 20);
    EXPECT_EQ(bytes("1.5g"), std::uint64_t{1536} << 20);
    EXPECT_EQ(bytes("2GiB"), std::uint64_t{2} << 30);
    for (const char* wrong : {"", "12", "5X", "-3G", "G", "1e400", "nan", "2 G"}) {
        const Outcome run = run_wellmesh({"mesh", cube, "--max-memory", wrong});
        EXPECT_EQ(run.status, 3) << wrong;
        EXPECT_TRUE(contains(run.err, "--max-memory")) << run.err;
    }
}

TEST(limits, too_little_memory_ends_the_run_with_a_reason) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const Outcome none = run_wellmesh({"mesh", cube, "--max-memory", "1M", "-o", scratch.file("out.mesh")});
    EXPECT_EQ(none.status, 4) << none.err;
    EXPECT_TRUE(contains(none.err, "memory limit")) << none.err;
    const Outcome refused = run_wellmesh({"mesh", cube, "--size", "0.003", "--max-memory", "1G", "-o", scratch.file("out.mesh")});
    EXPECT_EQ(refused.status, 4) << refused.err;
    EXPECT_TRUE(contains(refused.err, "GiB")) << refused.err;
    EXPECT_EQ(scratch.listing(), Names{"cube.off"});
}

TEST(limits, failing_allocations_are_told_in_the_report) {
#ifdef WELLMESH_SANITIZED
    GTEST_SKIP() << "sanitizers need address space of their own";
#endif
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const Outcome run = run_wellmesh({"mesh", cube, "--size", "0.006", "-o", scratch.file("out.mesh"), "--json", scratch.file("r.json")},
                                     {.address_space_limit = std::uint64_t{128} << 20});
    EXPECT_EQ(run.status, 4) << run.err;
    EXPECT_TRUE(contains(run.err, "out of memory")) << run.err;
    EXPECT_EQ(scratch.listing(), (Names{"cube.off", "r.json"}));
    EXPECT_EQ(json::parse(read_text(scratch.file("r.json"))).at("exit_status"), 4);
}

TEST(limits, a_report_that_can_not_be_written_names_the_mesh_that_is) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const Outcome run = run_wellmesh({"mesh", cube, "--min-dihedral", "0", "-o", scratch.file("out.mesh"), "--json", "/dev/full"});
    EXPECT_EQ(run.status, 5) << run.err;
    EXPECT_TRUE(contains(run.err, "out.mesh")) << run.err;
    EXPECT_EQ(scratch.listing(), (Names{"cube.off", "out.mesh"}));
}

TEST(limits, weights_do_not_outlive_their_mesh) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    ASSERT_LE(run_wellmesh({"mesh", cube, "--size", "0.3", "--slivers", "exude", "-o", scratch.file("out.mesh")}).status, 1);
    ASSERT_EQ(scratch.listing(), (Names{"cube.off", "out.mesh", "out.weights.sol"}));
    ASSERT_EQ(run_wellmesh({"mesh", cube, "--size", "0.3", "-o", scratch.file("out.mesh")}).status, 0);
    EXPECT_EQ(scratch.listing(), (Names{"cube.off", "out.mesh"}));
}

TEST(limits, delta_is_refused_where_nothing_is_picked) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    for (const char* slivers : {"none", "exude"}) {
        const Outcome run = run_wellmesh({"mesh", cube, "--slivers", slivers, "--delta", "0.1"});
        EXPECT_EQ(run.status, 3) << run.err;
        EXPECT_TRUE(contains(run.err, "delta")) << run.err;
    }
}

}  // namespace
}  // namespace wellmesh::testing
