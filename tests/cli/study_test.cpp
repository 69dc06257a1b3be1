// SPDX-License-Identifier: Apache-2.0
// wellmesh study: what is in its table and page, and what is left when it fails or is stopped.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "cli/run_program.hpp"

namespace wellmesh::testing {
namespace {

using nlohmann::json;
using Table = std::vector<std::map<std::string, std::string>>;

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
}

/// RFC 4180, strictly: fails on anything else.
Table read_csv(const std::string& text) {
    std::vector<std::vector<std::string>> lines(1, std::vector<std::string>(1));
    bool quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        std::string& field = lines.back().back();
        const char c = text[i];
        if (quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"') {
            field += text[++i];
        } else if (c == '"') {
            EXPECT_TRUE(quoted || field.empty());
            quoted = !quoted;
        } else if (!quoted && c == ',') {
            lines.back().emplace_back();
        } else if (!quoted && c == '\n') {
            lines.emplace_back(1);
        } else {
            field += c;
        }
    }
    EXPECT_FALSE(quoted);
    EXPECT_EQ(lines.back(), std::vector<std::string>(1)) << "the last line is not ended";
    lines.pop_back();
    Table table;
    for (std::size_t i = 1; i < lines.size(); ++i) {
        EXPECT_EQ(lines[i].size(), lines[0].size()) << "line " << i + 1;
        std::map<std::string, std::string> row;
        for (std::size_t k = 0; k < std::min(lines[i].size(), lines[0].size()); ++k) row[lines[0][k]] = lines[i][k];
        table.push_back(std::move(row));
    }
    return table;
}

json page_data(const std::string& page) {
    const std::string start = "<script type=\"application/json\" id=\"data\">";
    const std::size_t from = page.find(start) + start.size();
    return json::parse(page.substr(from, page.find("</script>", from) - from));
}

void expect_self_contained(const std::string& page) {
    for (const char* part : {"http:", "https:", "src=", "href=", "url(", "@import", "import(", "fetch(", "XMLHttpRequest", "{{"}) EXPECT_FALSE(contains(page, part)) << part;
}

TEST(study_command, every_run_is_a_row_of_the_table_and_of_the_page) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const std::vector<std::string> arguments{"study", cube, "--strategies", "none,best", "--theta", "15:10:25", "--seeds", "1:2", "--size", "0.4", "-o"};
    auto first = arguments, second = arguments;
    first.push_back(scratch.file("new/folder"));
    second.push_back(scratch.file("again"));
    const Outcome run = run_wellmesh(first);
    ASSERT_EQ(run.status, 0) << run.out << run.err;
    EXPECT_TRUE(contains(run.out, "Medians over seeds"));
    EXPECT_TRUE(contains(run.err, "6/6 "));
    Table table = read_csv(read_text(scratch.file("new/folder/study.csv")));
    ASSERT_EQ(table.size(), 6U);
    std::size_t with_goal = 0;
    for (const auto& row : table) {
        EXPECT_EQ(row.at("model"), cube);
        EXPECT_EQ(row.at("status"), "goals_met");
        EXPECT_EQ(row.at("certificate"), "proven");
        EXPECT_EQ(row.at("error"), "");
        EXPECT_EQ(row.at("size"), "0.4");
        EXPECT_GT(std::stoi(row.at("tets")), 0);
        EXPECT_GE(std::stoi(row.at("tets_below_20_deg")), std::stoi(row.at("tets_below_5_deg")));
        EXPECT_LE(std::stod(row.at("max_radius_edge")), 2);
        EXPECT_GT(std::stod(row.at("min_sigma")), 0);
        EXPECT_LT(std::stod(row.at("max_dihedral_boundary_deg")), 180);
        const double ratio = std::stod(row.at("vertices_over_almost_good"));
        EXPECT_NEAR(ratio, std::stod(row.at("vertices")) / std::stod(row.at("almost_good_vertices")), 1e-12);
        double seconds = 0;
        for (const char* stage : {"validate", "delaunay", "conform", "refine", "shape", "extract", "certify"}) seconds += std::stod(row.at(std::string("seconds_") + stage));
        EXPECT_NEAR(seconds, std::stod(row.at("seconds")), 1e-3);
        if (row.at("strategy") == "none") {
            EXPECT_EQ(row.at("theta_deg"), "");
            EXPECT_EQ(ratio, 1);
            continue;
        }
        ++with_goal;
        EXPECT_EQ(row.at("strategy"), "best");
        EXPECT_GE(std::stod(row.at("min_dihedral_boundary_deg")), std::stod(row.at("theta_deg")));
    }
    EXPECT_EQ(with_goal, 4U);

    const std::string page = read_text(scratch.file("new/folder/study.html"));
    EXPECT_EQ(count(page, "<tr>"), table.size() + 1);
    expect_self_contained(page);
    const json data = page_data(page);
    ASSERT_EQ(data.size(), table.size());
    for (std::size_t i = 0; i < table.size(); ++i) {
        for (const auto& [column, value] : table[i]) EXPECT_EQ(data[i].at(column), value) << column;
        std::uint64_t tets = 0;
        for (const json& bin : data[i].at("histogram")) tets += bin.get<std::uint64_t>();
        EXPECT_EQ(std::to_string(tets), table[i].at("tets"));
    }

    // The same again, but for the times.
    ASSERT_EQ(run_wellmesh(second).status, 0);
    Table again = read_csv(read_text(scratch.file("again/study.csv")));
    for (Table* t : {&table, &again})
        for (auto& row : *t) std::erase_if(row, [](const auto& cell) { return cell.first.starts_with("seconds"); });
    EXPECT_EQ(again, table);
}

TEST(study_command, a_run_that_fails_is_a_row) {
    const ScratchFolder scratch;
    (void)scratch.write("cube.off", kCubeOff);
    // Its name needs quotes in the table and escapes in the page.
    (void)scratch.write("a,\"b\"<i>&.off", "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n");
    const Outcome run = run_wellmesh({"study", "a,\"b\"<i>&.off", "missing.off", "cube.off", "--strategies", "best", "--theta", "20", "--seeds", "3", "-o", "out"}, {.folder = scratch.path()});
    EXPECT_EQ(run.status, 1) << run.err;
    const Table table = read_csv(read_text(scratch.file("out/study.csv")));
    ASSERT_EQ(table.size(), 3U);
    EXPECT_EQ(table[0].at("model"), "a,\"b\"<i>&.off");
    EXPECT_EQ(table[0].at("status"), "bad_input");
    EXPECT_EQ(table[0].at("vertices"), "");
    EXPECT_NE(table[0].at("error"), "");
    EXPECT_EQ(table[1].at("status"), "cannot_read");
    EXPECT_EQ(table[2].at("status"), "goals_met");
    const std::string page = read_text(scratch.file("out/study.html"));
    EXPECT_FALSE(contains(page, "<i>"));
    EXPECT_TRUE(contains(page, "&lt;i&gt;"));
    EXPECT_EQ(page_data(page)[0].at("model"), table[0].at("model"));
    expect_self_contained(page);
}

TEST(study_command, an_interrupted_study_keeps_what_is_done) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const Outcome run = run_wellmesh({"study", cube, "--strategies", "none,best", "--theta", "10", "--size", "0.3", "--seeds", "1:5000", "-o", scratch.file("out")},
                                     {.signal = SIGINT, .signal_after = std::chrono::milliseconds(1500)});
    EXPECT_EQ(run.status, 130) << run.err;
    const Table table = read_csv(read_text(scratch.file("out/study.csv")));
    EXPECT_GT(table.size(), 0U);
    EXPECT_LT(table.size(), 10'000U);
    for (const auto& row : table) EXPECT_EQ(row.at("status"), "goals_met");
    EXPECT_EQ(page_data(read_text(scratch.file("out/study.html"))).size(), table.size());
    EXPECT_TRUE(contains(run.err, "of 10000 runs")) << run.err;
}

TEST(study_command, bad_lists_are_refused_with_the_form) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    const std::vector<std::pair<Names, std::string>> cases = {
        {{"--theta", "5:0:35"}, "FIRST:STEP:LAST"}, {{"--theta", "35:5:5"}, "FIRST:STEP:LAST"}, {{"--theta", "5:"}, "FIRST:STEP:LAST"}, {{"--theta", "1,,2"}, "FIRST:STEP:LAST"},
        {{"--theta", "nan"}, "FIRST:STEP:LAST"},    {{"--theta", "1:2:3:4"}, "FIRST:STEP:LAST"}, {{"--theta", "0:1e-9:70"}, "more than 10000"}, {{"--theta", "80"}, "between 0 and 70.52"},
        {{"--seeds", "-1"}, "whole numbers"},       {{"--seeds", "1.5"}, "whole numbers"},       {{"--seeds", "3:1"}, "whole numbers"},         {{"--seeds", ""}, "whole numbers"},
        {{"--size", "0"}, "above 0"},               {{"--size-over-diagonal", "-1"}, "above 0"}, {{"--strategies", "none,worst"}, "one of none"}, {{"--max-radius-edge", "0"}, "0.6124"},
    };
    for (const auto& [flags, part] : cases) {
        Names arguments{"study", cube, "-o", scratch.file("out")};
        arguments.insert(arguments.end(), flags.begin(), flags.end());
        const Outcome run = run_wellmesh(arguments);
        EXPECT_EQ(run.status, 3) << flags[0] << ' ' << flags[1];
        EXPECT_TRUE(contains(run.err, part)) << flags[1] << ": " << run.err;
    }
    EXPECT_EQ(run_wellmesh({"study", cube}).status, 3);
    EXPECT_EQ(scratch.listing(), Names{"cube.off"});
}

TEST(study_command, published_ways_are_rows_like_any_other) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    // chew needs a size, which is said at once where none is given.
    EXPECT_EQ(run_wellmesh({"study", cube, "--strategies", "chew", "-o", scratch.file("none")}).status, 3);
    const Outcome run = run_wellmesh({"study", cube, "--strategies", "refine,improve,chew,perturb", "--theta", "10", "--seeds", "1", "--size-over-diagonal", "0.25", "-o", scratch.file("out")});
    ASSERT_EQ(run.status, 0) << run.err;
    const Table table = read_csv(read_text(scratch.file("out/study.csv")));
    ASSERT_EQ(table.size(), 4U);
    for (const auto& row : table) {
        EXPECT_NE(row.at("almost_good_vertices"), "");
        EXPECT_NEAR(std::stod(row.at("size")), 0.25 * std::sqrt(3.0), 1e-12);
    }
}

TEST(study_command, lists_and_ranges_mix) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    ASSERT_EQ(run_wellmesh({"study", cube, "--strategies", "best", "--theta", "0.1:0.1:0.3,10,0.2", "--seeds", "7,1:2", "-o", scratch.file("out"), "--quiet"}).status, 0);
    const Table table = read_csv(read_text(scratch.file("out/study.csv")));
    Names theta, seeds;
    for (const auto& row : table) {
        if (std::find(theta.begin(), theta.end(), row.at("theta_deg")) == theta.end()) theta.push_back(row.at("theta_deg"));
        if (std::find(seeds.begin(), seeds.end(), row.at("seed")) == seeds.end()) seeds.push_back(row.at("seed"));
    }
    EXPECT_EQ(seeds, (Names{"7", "1", "2"}));
    ASSERT_EQ(theta.size(), 4U);
    EXPECT_NEAR(std::stod(theta[2]), 0.3, 1e-12);
    EXPECT_EQ(table.size(), 12U);
}

TEST(study_command, a_folder_that_cannot_be_written_is_told_first) {
    const ScratchFolder scratch;
    const std::string cube = scratch.write("cube.off", kCubeOff);
    (void)scratch.write("file", "");
    EXPECT_EQ(run_wellmesh({"study", cube, "-o", scratch.file("file")}).status, 5);
    EXPECT_EQ(run_wellmesh({"study", cube, "-o", "/proc/study"}).status, 5);
    // A full disk: nothing is left half written.
    const Outcome full = run_wellmesh({"study", cube, "--strategies", "none", "--seeds", "1", "-o", scratch.file("out")}, {.file_size_limit = 300});
    EXPECT_EQ(full.status, 5) << full.err;
    EXPECT_TRUE(contains(full.err, "study.csv")) << full.err;
    for (const auto& entry : std::filesystem::directory_iterator(scratch.file("out"))) ADD_FAILURE() << entry.path();
}

}  // namespace
}  // namespace wellmesh::testing
