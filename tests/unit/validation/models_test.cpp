// SPDX-License-Identifier: Apache-2.0
// Models made by others, compared with what is known of them. Skipped where the folder of models is absent.
#include "plc_helpers.hpp"

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "wellmesh/io.hpp"

namespace wellmesh::testing {
namespace {

const std::filesystem::path kModels = WELLMESH_SHARED_MODELS;
const std::vector<std::string> kRightAngled{"plc/bar2.poly", "plc/crux.poly", "cad/u_arch.off", "cad/part1.stl", "multimat/cubes.off", "multimat/eight_cubes.poly",
                                            "geosemi/dike_mod.poly", "geosemi/seissol_loh1.poly", "geosemi/gmsh_mos3d.poly"};

using Row = std::map<std::string, std::string>;

std::vector<Row> read_manifest() {
    std::ifstream in(kModels / "manifest.tsv");
    const auto fields = [](const std::string& line) {
        std::vector<std::string> all;
        std::istringstream s(line);
        for (std::string f; std::getline(s, f, '\t');) all.push_back(f);
        return all;
    };
    std::string line;
    std::getline(in, line);
    const auto names = fields(line);
    std::vector<Row> rows;
    while (std::getline(in, line)) {
        const auto values = fields(line);
        Row row;
        for (std::size_t i = 0; i < values.size() && i < names.size(); ++i) row[names[i]] = values[i];
        rows.push_back(std::move(row));
    }
    return rows;
}

class Models : public ::testing::Test {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(kModels / "manifest.tsv")) GTEST_SKIP() << "no folder of models at " << kModels;
    }
};

double smallest(const Diagnosis& d, DefectKind kind) {
    double angle = 90;
    for (const Defect& x : d.defects)
        if (x.kind == kind) angle = std::min(angle, x.value);
    return angle;
}

TEST_F(Models, RightAngledOnesHaveNoAcuteFeatureInAnyOrientation) {
    for (const std::string& name : kRightAngled) {
        const Plc plc = read_plc(kModels / name);
        const ValidPlc reference = validate(plc);
        expect_consistent(reference);
        for (const auto& [rotation, shift, scale] : {std::tuple{0U, 0.0, 1.0}, std::tuple{1U, 0.0, 1.0}, std::tuple{2U, 1e3, 1.0}, std::tuple{3U, 1e6, 1.0},
                                                     std::tuple{4U, 0.0, 1e-6}, std::tuple{5U, 0.0, 1e6}}) {
            SCOPED_TRACE(name + " " + std::to_string(rotation));
            const ValidPlc valid = validate(transformed(plc, rotation, shift, scale));
            EXPECT_TRUE(valid.acute_features.empty()) << valid.acute_features[0].angle_deg;
            EXPECT_EQ(valid.vertices.size(), reference.vertices.size());
            EXPECT_EQ(valid.segments.size(), reference.segments.size());
            EXPECT_EQ(valid.facets.size(), reference.facets.size());
            EXPECT_EQ(valid.cells.size(), reference.cells.size());
        }
    }
}

TEST_F(Models, FindingsAgreeWithTheManifest) {
    std::size_t compared = 0;
    for (const Row& row : read_manifest()) {
        const std::string file = row.at("file");
        if (row.at("class") == "malformed") continue;
        SCOPED_TRACE(file);
        const Diagnosis d = diagnose(read_plc(kModels / file));
        ++compared;
        // the manifest's counts are of the file as it stands; needles that were closed change them in these
        const bool mended = count(d, DefectKind::degenerate_facet) != 0;
        const std::size_t pairs = count(d, DefectKind::self_intersection), known = std::stoul(row.at("n_si_pairs"));
        const std::size_t copies = std::stoul(row.at("dup_faces"));
        if (row.at("format") != "smesh" && !mended) {
            EXPECT_EQ(pairs + copies * (known != 0), known);
        }
        if (pairs != 0) {
            EXPECT_EQ(row.at("self_intersecting"), "yes");
            continue;
        }
        const bool surface_file = row.at("format") != "poly" && row.at("format") != "smesh";
        if (surface_file && !mended) {
            EXPECT_EQ(count(d, DefectKind::open_edge), std::stoul(row.at("boundary_edges")));
        }
        if (d.has_errors()) continue;
        EXPECT_EQ(d.cells.size() - 1, std::stoul(row.at("cells")));
        const double dihedral = std::stod(row.at("min_dihedral_deg"));
        if (dihedral < 89 && !mended) {
            EXPECT_NEAR(smallest(d, DefectKind::acute_dihedral_angle), dihedral, 1e-3);
        }
        if (dihedral >= 90) {
            EXPECT_EQ(smallest(d, DefectKind::acute_dihedral_angle), 90);
        }
    }
    EXPECT_GT(compared, 55U);
}

}  // namespace
}  // namespace wellmesh::testing
