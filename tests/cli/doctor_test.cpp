// SPDX-License-Identifier: Apache-2.0
// wellmesh doctor as a user runs it: what it says and writes, and what it refuses.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include <nlohmann/json.hpp>

#include <fmt/format.h>

#include "cli/run_program.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::testing {
namespace {

using nlohmann::json;

/// Unit cubes with their lowest corners at these places.
std::string cubes_off(const std::vector<Vec3>& corners) {
    constexpr const char* kFaces[] = {"{3} {2} {1} {0}", "{4} {5} {6} {7}", "{0} {1} {5} {4}", "{1} {2} {6} {5}", "{2} {3} {7} {6}", "{3} {0} {4} {7}"};
    std::string points, faces;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3& c = corners[i];
        for (int k = 0; k < 8; ++k) points += fmt::format("{} {} {}\n", c.x + (k % 4 == 1 || k % 4 == 2), c.y + (k % 4 >= 2), c.z + (k >= 4));
        const std::size_t n = 8 * i;
        for (const char* face : kFaces) faces += "4 " + fmt::format(fmt::runtime(face), n, n + 1, n + 2, n + 3, n + 4, n + 5, n + 6, n + 7) + "\n";
    }
    return fmt::format("OFF\n{} {} 0\n{}{}", 8 * corners.size(), 6 * corners.size(), points, faces);
}

const std::vector<Vec3> kOverlapping{{0, 0, 0}, {0.5, 0.25, 0.125}};  // in a box of 0.5 x 0.75 x 0.875
constexpr double kCommonVolume = 0.5 * 0.75 * 0.875;
const std::vector<Vec3> kApart{{0, 0, 0}, {1.0009765625, 0.25, 0.25}};  // by 2^-10

std::size_t count_of(const json& report, const std::string& kind) {
    std::size_t n = 0;
    for (const json& d : report.at("defects")) n += d.at("kind") == kind;
    return n;
}

double filled_volume(const json& report) {
    double sum = 0;
    for (const json& cell : report.at("cells"))
        if (cell.at("filled")) sum += cell.at("volume").get<double>();
    return sum;
}

class doctor : public ::testing::Test {
protected:
    Outcome run(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), "doctor");
        return run_wellmesh(arguments, here);
    }
    [[nodiscard]] json report() const { return json::parse(read_text(scratch.file("d.json"))); }

    ScratchFolder scratch;
    RunOptions here{.folder = scratch.path()};
};

TEST_F(doctor, lists_intersections_in_a_table_in_json_and_in_spots) {
    (void)scratch.write("two.off", cubes_off(kOverlapping));
    const Outcome table = run({"two.off", "--json", "d.json", "--vtp", "spots.vtp"});
    EXPECT_EQ(table.status, 2);
    EXPECT_TRUE(table.err.empty()) << table.err;
    EXPECT_TRUE(contains(table.out, "self_intersection")) << table.out;
    EXPECT_TRUE(contains(table.out, "facet 3 (line 22) and facet 8 (line 27) meet from (1, 0.25, 0.75) to (1, 0.25, 0.625)")) << table.out;
    const json d = report();
    EXPECT_EQ(d.at("exit_status"), 2);
    EXPECT_TRUE(d.at("has_errors"));
    // An edge of either cube leaves it through the other: each pair of faces that cross is listed once.
    EXPECT_EQ(count_of(d, "self_intersection"), 6U);
    for (const json& defect : d.at("defects")) {
        EXPECT_EQ(defect.at("severity"), "error");
        EXPECT_EQ(defect.at("elements").size(), 2U);
        ASSERT_EQ(defect.at("points").size(), 2U);
        for (const json& p : defect.at("points")) EXPECT_TRUE(p[0] == 1.0 || p[1] == 1.0 || p[2] == 1.0) << p;  // on the first cube's far sides, all of them
    }
    EXPECT_TRUE(contains(read_text(scratch.file("spots.vtp")), "NumberOfPoints=\"12\" NumberOfVerts=\"0\" NumberOfLines=\"6\""));
    EXPECT_EQ(scratch.listing(), (Names{"d.json", "spots.vtp", "two.off"}));

    const Outcome pure = run({"two.off", "--json", "-"});
    EXPECT_EQ(json::parse(pure.out).at("defects"), d.at("defects"));
    EXPECT_TRUE(contains(pure.err, "self_intersection")) << pure.err;
}

TEST_F(doctor, near_misses_are_those_below_the_stated_distance) {
    (void)scratch.write("two.off", cubes_off(kApart));
    const auto misses = [&](const char* distance) {
        const Outcome out = run({"two.off", "--near", distance, "--json", "d.json"});
        EXPECT_EQ(out.status, 0) << distance << out.out << out.err;
        return count_of(report(), "near_miss");
    };
    EXPECT_EQ(misses("0"), 0U);
    EXPECT_EQ(misses("0.0009"), 0U);
    ASSERT_GT(misses("0.001"), 0U);
    const json nearest = report().at("defects").at(0);
    EXPECT_EQ(nearest.at("kind"), "near_miss");
    EXPECT_EQ(nearest.at("severity"), "warning");
    EXPECT_EQ(nearest.at("value"), 0.0009765625);
}

TEST_F(doctor, a_repaired_file_is_meshed) {
    (void)scratch.write("two.off", cubes_off(kOverlapping));
    for (const bool melt : {false, true}) {
        std::vector<std::string> arguments{"two.off", "--repair", "mended.off", "--json", "d.json"};
        if (melt) arguments.emplace_back("--union");
        const Outcome out = run(arguments);
        ASSERT_EQ(out.status, 0) << out.out << out.err;
        EXPECT_TRUE(contains(out.out, "mended.off is a valid complex")) << out.out;
        const json repair = report().at("repair");
        EXPECT_EQ(repair.at("output"), "mended.off");
        EXPECT_LE(repair.at("max_displacement"), 2 * repair.at("tolerance").get<double>());
        EXPECT_NEAR(filled_volume(repair.at("left")), 2 - kCommonVolume, 1e-9);
        EXPECT_EQ(repair.at("left").at("cells").size(), melt ? 2U : 4U);  // the outer one counts
        const Outcome meshed = run_wellmesh({"mesh", "mended.off", "-o", "mended.mesh"}, here);
        ASSERT_EQ(meshed.status, 0) << meshed.out << meshed.err;
        EXPECT_EQ(run_wellmesh({"check", "mended.mesh", "--plc", "mended.off", "--max-radius-edge", "2", "--min-dihedral", "20"}, here).status, 0);
    }
}

TEST_F(doctor, a_tolerance_joins_what_is_closer) {
    (void)scratch.write("two.off", cubes_off(kApart));
    const auto volume = [&](const char* tolerance) {
        const Outcome out = run({"two.off", "--repair", "mended.poly", "--tolerance", tolerance, "--json", "d.json"});
        EXPECT_EQ(out.status, 0) << out.out << out.err;
        return report().at("repair").at("max_displacement").get<double>();
    };
    EXPECT_EQ(volume("0.0005"), 0);
    const double moved = volume("0.002");
    EXPECT_GT(moved, 0);
    EXPECT_LE(moved, 0.004);
    EXPECT_EQ(run_wellmesh({"mesh", "mended.poly", "-o", "mended.mesh"}, here).status, 0);
}

/// In a surface file two facets between solids that touch say that the wall belongs to both; in a .poly the second would be a repetition.
TEST_F(doctor, a_wall_between_touching_solids_stands_once_in_a_poly) {
    (void)scratch.write("two.off", cubes_off({{0, 0, 0}, {1, 0.25, 0.25}}));
    for (const auto& [output, copies] : {std::pair{"mended.off", true}, {"mended.poly", false}}) {
        ASSERT_EQ(run({"two.off", "--repair", output}).status, 0);
        std::set<std::set<std::uint32_t>> distinct;
        const Plc mended = read_plc(scratch.file(output));
        for (const PlcFacet& f : mended.facets) distinct.emplace(f.polygons[0].begin(), f.polygons[0].end());
        EXPECT_EQ(distinct.size() < mended.facets.size(), copies) << output;
    }
}

TEST_F(doctor, what_can_not_be_done_is_refused_before_anything_is_written) {
    (void)scratch.write("two.off", cubes_off(kApart));
    const std::vector<std::pair<Names, std::string>> cases{{{"--near", "-1"}, "0 or more"},
                                                           {{"--near", "nan"}, "--near"},
                                                           {{"--tolerance", "0.1"}, "belong to --repair"},
                                                           {{"--union"}, "belong to --repair"},
                                                           {{"--repair", "x.off", "--tolerance", "5"}, "must be between"},
                                                           {{"--repair", "x.off", "--tolerance", "1e-300"}, "must be between"},
                                                           {{"--repair", "two.off"}, "would replace"},
                                                           {{"--vtp", "spots.vtu"}, "must end in .vtp"}};
    for (const auto& [arguments, words] : cases) {
        Names all{"two.off"};
        all.insert(all.end(), arguments.begin(), arguments.end());
        const Outcome out = run(all);
        EXPECT_EQ(out.status, 3) << arguments[0] << out.err;
        EXPECT_TRUE(contains(out.err, words)) << out.err;
    }
    EXPECT_EQ(scratch.listing(), Names{"two.off"});
}

TEST_F(doctor, files_are_whole_or_absent) {
    (void)scratch.write("two.off", cubes_off(kOverlapping));
    for (const Names& output : {Names{"--repair", "no-such-folder/x.off"}, {"--vtp", "no-such-folder/x.vtp"}, {"--json", "no-such-folder/x.json"}, {"--json", "/dev/full"}}) {
        const Outcome out = run({"two.off", output[0], output[1]});
        EXPECT_EQ(out.status, 5) << output[0] << out.err;
        EXPECT_TRUE(contains(out.err, output[1])) << out.err;
    }
    for (const Names& output : {Names{"--repair", "x.off"}, {"--vtp", "x.vtp"}, {"--json", "x.json"}}) {
        const Outcome out = run_wellmesh({"doctor", "two.off", output[0], output[1]}, {.folder = scratch.path(), .file_size_limit = 256});
        EXPECT_EQ(out.status, 5) << output[0] << out.err;
        EXPECT_TRUE(contains(out.err, output[1])) << out.err;
    }
    EXPECT_EQ(scratch.listing(), Names{"two.off"});
}

TEST_F(doctor, a_leftover_vertex_of_a_surface_is_no_point_of_the_mesh) {
    std::string cube = cubes_off({{0, 0, 0}});
    cube.replace(cube.find("8 6 0\n"), 6, "9 6 0\n0.5 0.5 0.5\n");
    for (std::size_t face = cube.find("\n4 "); face != std::string::npos; face = cube.find("\n4 ", face + 1))  // the others are one further on
        for (std::size_t k = 3; k < 11; k += 2) ++cube[face + k];
    (void)scratch.write("cube.off", cube);
    const Outcome out = run({"cube.off", "--json", "d.json"});
    EXPECT_EQ(out.status, 0) << out.out << out.err;
    EXPECT_EQ(count_of(report(), "isolated_vertex"), 1U);
    ASSERT_EQ(run_wellmesh({"mesh", "cube.off", "--min-dihedral", "0", "-o", "cube.mesh"}, here).status, 0);
    EXPECT_EQ(read_mesh(scratch.file("cube.mesh")).vertices.size(), 8U);
    EXPECT_EQ(run_wellmesh({"check", "cube.mesh", "--plc", "cube.off"}, here).status, 0);
}

}  // namespace
}  // namespace wellmesh::testing
