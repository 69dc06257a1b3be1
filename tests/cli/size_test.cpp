// SPDX-License-Identifier: Apache-2.0
// Sizes that differ from place to place, as a user asks for them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <tuple>

#include "cli/run_program.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::testing {
namespace {

using nlohmann::json;

/// Two unit cubes, regions 1 and 2; the wall between them has marker 3, the vertex at the origin 4.
std::string two_boxes() {
    return "12 3 0 1\n1 0 0 0 4\n2 1 0 0 0\n3 2 0 0 0\n4 0 1 0 0\n5 1 1 0 0\n6 2 1 0 0\n7 0 0 1 0\n8 1 0 1 0\n9 2 0 1 0\n10 0 1 1 0\n11 1 1 1 0\n12 2 1 1 0\n"
           "11 1\n1 0 1\n4 1 2 5 4\n1 0 1\n4 2 3 6 5\n1 0 1\n4 7 8 11 10\n1 0 1\n4 8 9 12 11\n1 0 1\n4 1 2 8 7\n1 0 1\n4 2 3 9 8\n1 0 1\n4 4 5 11 10\n1 0 1\n4 5 6 12 11\n"
           "1 0 1\n4 1 4 10 7\n1 0 3\n4 2 5 11 8\n1 0 1\n4 3 6 12 9\n0\n2\n1 0.5 0.5 0.5 1\n2 1.5 0.5 0.5 2\n";
}

double achieved(const json& report, const std::string& goal) {
    for (const json& g : report.at("goals"))
        if (g.at("goal") == goal) return g.at("achieved");
    ADD_FAILURE() << "no goal " << goal;
    return 0;
}

TEST(sizes, of_regions_facets_and_vertices_are_asked_and_achieved) {
    const ScratchFolder scratch;
    const RunOptions here = {.folder = scratch.path()};
    (void)scratch.write("boxes.poly", two_boxes());
    const Outcome run = run_wellmesh({"mesh", "boxes.poly", "--size", "0.5", "--size-region", "2=0.12", "--size-facet", "3=0.1", "--size-vertex", "4=0.02", "--gradation", "0.4", "-o",
                                      "boxes.mesh", "--json", "report.json"}, here);
    ASSERT_EQ(run.status, 0) << run.out << run.err;
    const json report = json::parse(read_text(scratch.path() / "report.json"));
    EXPECT_NEAR(achieved(report, "edge length (mean) in region 2"), 0.12, 0.02);
    EXPECT_NEAR(achieved(report, "edge length / size (median)"), 1, 0.2);
    EXPECT_EQ(report.at("options").at("gradation"), 0.4);
    ASSERT_EQ(report.at("options").at("entity_sizes").size(), 3U);
    EXPECT_EQ(report.at("options").at("entity_sizes").at(0), json({{"entity", "region"}, {"id", 2}, {"edge_length", 0.12}}));
    EXPECT_EQ(run_wellmesh({"check", "boxes.mesh", "--plc", "boxes.poly", "--max-radius-edge", "2", "--min-dihedral", "20"}, here).status, 0);
}

TEST(sizes, come_from_mtr_files_and_background_meshes) {
    const ScratchFolder scratch;
    const RunOptions here = {.folder = scratch.path()};
    (void)scratch.write("boxes.poly", two_boxes());
    const auto tets = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"mesh", "boxes.poly", "-o", "boxes.mesh"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome run = run_wellmesh(arguments, here);
        EXPECT_EQ(run.status, 0) << run.out << run.err;
        return read_mesh(scratch.path() / "boxes.mesh").tets.size();
    };
    const std::size_t plain = tets({});
    (void)scratch.write("sizes.node", "4 3 0 0\n1 -1 -1 -1\n2 9 -1 -1\n3 -1 9 -1\n4 -1 -1 9\n");
    (void)scratch.write("sizes.ele", "1 4 0\n1 1 2 3 4\n");
    (void)scratch.write("sizes.mtr", "4 1\n0.15\n0.15\n0.15\n0.15\n");
    const std::size_t background = tets({"--background", "sizes.node"});
    EXPECT_GT(background, 5 * plain);
    (void)scratch.write("boxes.mtr", "12 1\n" + [] { std::string s; for (int i = 0; i < 12; ++i) s += "0.15\n"; return s; }());
    EXPECT_EQ(tets({}), background);
    EXPECT_EQ(tets({"--vertex-sizes", "off"}), plain);
    EXPECT_TRUE(contains(run_wellmesh({"mesh", "boxes.poly", "-o", "boxes.mesh"}, here).out, "sizes at its vertices"));

    for (const char* target : {"sizes.node", "sizes.ele"}) {
        const Outcome run = run_wellmesh({"mesh", "boxes.poly", "--background", "sizes.mtr", "-o", target}, here);
        EXPECT_EQ(run.status, 3);
        EXPECT_TRUE(contains(run.err, "would replace the input")) << run.err;
    }
    (void)scratch.write("sizes.mtr", "4 1\n0.15\n0.15\nx\n0.15\n");
    const Outcome broken = run_wellmesh({"mesh", "boxes.poly", "--background", "sizes.node", "-o", "boxes.mesh"}, here);
    EXPECT_EQ(broken.status, 2);
    EXPECT_TRUE(contains(broken.err, "sizes.mtr:4")) << broken.err;
    EXPECT_EQ(run_wellmesh({"mesh", "boxes.poly", "--background", "none.node"}, here).status, 5);
}

TEST(sizes, by_features_and_curvature_are_options_and_off_is_a_gradation) {
    const ScratchFolder scratch;
    const RunOptions here = {.folder = scratch.path()};
    (void)scratch.write("boxes.poly", two_boxes());
    const Outcome run = run_wellmesh({"mesh", "boxes.poly", "--lfs", "0.5", "--curvature", "24", "--min-size", "0.05", "--gradation", "off", "-o", "boxes.mesh", "--json", "-"}, here);
    ASSERT_EQ(run.status, 0) << run.err;
    const json report = json::parse(run.out);
    EXPECT_EQ(report.at("options").at("per_local_feature_size"), 0.5);
    EXPECT_EQ(report.at("options").at("elements_per_circle"), 24);
    EXPECT_EQ(report.at("options").at("min_edge_length"), 0.05);
    EXPECT_EQ(report.at("options").at("gradation"), 0);
    EXPECT_NEAR(achieved(report, "edge length / size (median)"), 1, 0.2);
}

/// A unit cube whose lid, at z = 1, an edge of it and the corner at the origin have names.
constexpr const char* kNamedCubeMsh =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n4\n0 11 \"corner\"\n1 12 \"rim of the lid\"\n2 13 \"lid\"\n2 14 \"wall\"\n$EndPhysicalNames\n"
    "$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n$EndNodes\n"
    "$Elements\n8\n1 15 2 11 1 1\n2 1 2 12 1 5 6\n3 3 2 14 1 4 3 2 1\n4 3 2 13 2 5 6 7 8\n5 3 2 14 3 1 2 6 5\n6 3 2 14 4 2 3 7 6\n7 3 2 14 5 3 4 8 7\n8 3 2 14 6 4 1 5 8\n"
    "$EndElements\n";

/// Mean length of the edges of tetrahedra whose ends both satisfy a condition, over what was asked for at their middles.
template <class Condition, class Asked>
double mean_edge(const TetMesh& mesh, Condition&& on, Asked&& asked) {
    double sum = 0;
    std::size_t n = 0;
    for (const auto& t : mesh.tets)
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = i + 1; j < 4; ++j) {
                const Vec3 &p = mesh.vertices[t[i]], &q = mesh.vertices[t[j]];
                if (!on(p) || !on(q)) continue;
                sum += std::hypot(p.x - q.x, p.y - q.y, p.z - q.z) / asked({0.5 * (p.x + q.x), 0.5 * (p.y + q.y), 0.5 * (p.z + q.z)});
                ++n;
            }
    EXPECT_GT(n, 0U);
    return sum / static_cast<double>(n);
}

TEST(sizes, are_asked_by_the_names_of_the_file_and_of_the_command_line) {
    const ScratchFolder scratch;
    const RunOptions here = {.folder = scratch.path()};
    (void)scratch.write("cube.msh", kNamedCubeMsh);
    const auto mesh_with = [&](std::vector<std::string> sizes) {
        std::vector<std::string> all{"mesh", "cube.msh", "--region-at", "0.5,0.5,0.5=steel", "--size", "0.5", "--gradation", "0.5", "-o", "cube.mesh", "--json", "report.json"};
        all.insert(all.end(), sizes.begin(), sizes.end());
        return run_wellmesh(all, here);
    };
    const auto on_lid = [](const Vec3& p) { return p.z == 1; };
    const auto on_rim = [](const Vec3& p) { return p.z == 1 && p.y == 0; };
    const auto near_corner = [](const Vec3& p) { return std::hypot(p.x, p.y, p.z) < 0.05; };
    const auto anywhere = [](const Vec3&) { return true; };
    const std::vector<std::tuple<std::vector<std::string>, std::string, double, std::function<bool(const Vec3&)>>> cases{
        {{"--size-facet", "lid=0.1"}, "facet", 0.1, on_lid},
        {{"--size-segment", "rim of the lid=0.05"}, "segment", 0.05, on_rim},
        {{"--size-vertex", "corner=0.02"}, "vertex", 0.02, near_corner},
        {{"--size-region", "steel=0.2"}, "region", 0.2, anywhere}};
    for (const auto& [arguments, entity, length, place] : cases) {
        const Outcome run = mesh_with(arguments);
        ASSERT_EQ(run.status, 0) << entity << run.out << run.err;
        const json sizes = json::parse(read_text(scratch.file("report.json"))).at("options").at("entity_sizes");
        ASSERT_EQ(sizes.size(), 1U) << sizes;
        EXPECT_EQ(sizes.at(0).at("entity"), entity);
        EXPECT_EQ(sizes.at(0).at("edge_length"), length);
        const double grows = entity == "vertex" ? 0.5 : 0;  // from the corner; the others are asked about only where they are
        const double mean = mean_edge(read_mesh(scratch.file("cube.mesh")), place, [&](const Vec3& p) { return length + grows * std::hypot(p.x, p.y, p.z); });
        EXPECT_GT(mean, 0.5) << entity;
        EXPECT_LT(mean, 1.3) << entity;
    }
    for (const char* flag : {"--size-facet", "--size-segment", "--size-vertex", "--size-region"}) {
        const Outcome run = mesh_with({flag, "no such thing=0.1"});
        EXPECT_EQ(run.status, 3) << flag;
        EXPECT_TRUE(contains(run.err, "no such thing")) << run.err;
        EXPECT_TRUE(contains(run.err, std::string(flag) == "--size-facet" ? "lid" : std::string(flag) == "--size-segment" ? "rim of the lid" : std::string(flag) == "--size-vertex" ? "corner" : "steel")) << run.err;
    }
}

TEST(sizes, out_of_range_are_usage_errors_that_say_the_range) {
    const ScratchFolder scratch;
    const RunOptions here = {.folder = scratch.path()};
    (void)scratch.write("boxes.poly", two_boxes());
    const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
        {{"--size-region", "2"}, "ID=H"},           {{"--size-region", "2=0"}, "above 0"},      {{"--size-region", "x=1"}, "no names"},   {{"--size-region", "2=nan"}, "ID=H"},
        {{"--size-facet", "99=1"}, "the markers"},  {{"--size-region", "99=1"}, "regions 1, 2"}, {{"--size-segment", "5=1"}, "marker 5"}, {{"--gradation", "2"}, "between 0"},
        {{"--gradation", "-1"}, "between 0"},       {{"--gradation", "x"}, "number or off"},    {{"--lfs", "0"}, "above 0"},            {{"--curvature", "2"}, "at least 3"},
        {{"--min-size", "-1"}, "above 0"},          {{"--vertex-sizes", "on"}, "auto nor off"}, {{"--gradation", "off", "--size-vertex", "4=1"}, "gradation"}};
    for (const auto& [arguments, words] : cases) {
        std::vector<std::string> all{"mesh", "boxes.poly", "-o", "boxes.mesh"};
        all.insert(all.end(), arguments.begin(), arguments.end());
        const Outcome run = run_wellmesh(all, here);
        EXPECT_EQ(run.status, 3) << fmt::format("{} {}", arguments[0], arguments[1]) << run.err;
        EXPECT_TRUE(contains(run.err, words)) << run.err;
    }
    EXPECT_EQ(scratch.listing(), (std::vector<std::string>{"boxes.poly"}));
}

}  // namespace
}  // namespace wellmesh::testing
