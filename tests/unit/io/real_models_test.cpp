// SPDX-License-Identifier: Apache-2.0
// Every model of the shared collection is read, or rejected for the reason that its manifest knows.
#include <fstream>
#include <map>
#include <sstream>

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "sample_files.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh {
namespace {

const std::filesystem::path kModels = WELLMESH_SHARED_MODELS;

/// Rows of manifest.tsv as column name -> text.
std::vector<std::map<std::string, std::string>> manifest() {
    std::ifstream in(kModels / "manifest.tsv");
    std::vector<std::string> columns;
    std::vector<std::map<std::string, std::string>> rows;
    for (std::string line; std::getline(in, line);) {
        std::istringstream cells(line);
        std::size_t column = 0;
        if (!columns.empty()) rows.emplace_back();
        for (std::string cell; std::getline(cells, cell, '\t'); ++column) {
            if (rows.empty())
                columns.push_back(cell);
            else if (column < columns.size())
                rows.back()[columns[column]] = cell;
        }
    }
    return rows;
}

/// The malformed files that must not be read, and words of the reason.
const std::map<std::string, std::vector<std::string>> kRejected{{"malformed/OutOfMemory.off", {":2:", "353535235358"}},
                                                                {"malformed/L.smesh", {":8:", "repeats"}},
                                                                {"malformed/malformed.obj", {"vertex"}},
                                                                {"malformed/invalid.off", {"vertex 20"}},
                                                                {"malformed/invalidvertex.stl", {":89:", "'blah'"}},
                                                                {"malformed/unparseable.stl", {":4:", "\\x10"}},
                                                                {"malformed/cgal_simple_bad.mesh", {":1:", "MeshVersionFormatted"}}};

TEST(RealModels, AreReadWithTheNumbersOfTheManifest) {
    if (!std::filesystem::exists(kModels / "manifest.tsv")) GTEST_SKIP() << "no model collection at " << kModels;
    std::size_t read = 0, rejected = 0;
    for (const auto& row : manifest()) {
        const std::string& file = row.at("file");
        if (const auto known = kRejected.find(file); known != kRejected.end()) {
            ++rejected;
            testing::expect_error(ErrorCode::bad_input, {file, known->second.front(), known->second.back()}, [&] { (void)read_plc(kModels / file); });
            continue;
        }
        SCOPED_TRACE(file);
        Plc plc;
        ASSERT_NO_THROW(plc = read_plc(kModels / file));
        ++read;
        // The manifest counts the facets of a surface after coincident vertices were merged, so those may be fewer there.
        if (row.at("dup_vertices") == "0") {
            EXPECT_EQ(plc.vertices.size(), std::stoul(row.at("vertices")));
        } else {
            EXPECT_GE(plc.vertices.size(), std::stoul(row.at("vertices")));
        }
        EXPECT_EQ(plc.facets.size() + plc.segments.size(), std::stoul(row.at("facets")));
        EXPECT_EQ(plc.region_seeds.size(), std::stoul(row.at("regions")));
        EXPECT_EQ(plc.hole_seeds.size(), std::stoul(row.at("holes")));
        EXPECT_LT(plc.relative_rounding, 1e-4);
        const bool complex = row.at("format") == "poly" || row.at("format") == "smesh";
        EXPECT_EQ(plc.fill, complex ? FillRule::bounded_cells : FillRule::nonzero_winding);
    }
    EXPECT_EQ(rejected, kRejected.size());
    EXPECT_EQ(read, 72 - kRejected.size());
}

// What is written as .poly is the same complex.
TEST(RealModels, SurviveARoundTrip) {
    if (!std::filesystem::exists(kModels / "manifest.tsv")) GTEST_SKIP() << "no model collection at " << kModels;
    const testing::TemporaryDirectory directory;
    for (const auto& row : manifest()) {
        const std::string& file = row.at("file");
        if (kRejected.contains(file)) continue;
        SCOPED_TRACE(file);
        const Plc plc = read_plc(kModels / file);
        write_plc(plc, directory / "copy.poly");
        const Plc back = read_plc(directory / "copy.poly");
        EXPECT_TRUE(back.vertices == plc.vertices);
        ASSERT_EQ(back.facets.size(), plc.facets.size());
        for (std::size_t f = 0; f < plc.facets.size(); ++f) {
            ASSERT_EQ(back.facets[f].polygons, plc.facets[f].polygons);
            ASSERT_EQ(back.facets[f].marker, plc.facets[f].marker);
        }
        EXPECT_EQ(back.region_seeds.size(), plc.region_seeds.size());
    }
}

}  // namespace
}  // namespace wellmesh
