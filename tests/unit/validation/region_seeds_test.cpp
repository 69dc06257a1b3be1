// SPDX-License-Identifier: Apache-2.0
// Seeds find their cells wherever a domain lies, however it is turned and whatever its scale; seeds that can't be obeyed say where.
#include "plc_helpers.hpp"

#include "core/rng.hpp"

namespace wellmesh::testing {
namespace {

struct Place {
    std::uint64_t rotation;
    double shift, scale;
};
constexpr Place kPlaces[] = {{0, 0, 1}, {0, 1e3, 1e-6}, {3, 0, 1e6}, {4, 1e3, 1e-6}, {5, 1e6, 1}, {6, 1e3, 1e6}};

TEST(RegionSeeds, NameTheCellsOfRandomPolycubesEverywhere) {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        const RandomPolycube cubes = random_polycube(seed);
        const Place& place = kPlaces[seed % std::size(kPlaces)];
        SCOPED_TRACE(seed);
        const ValidPlc valid = validate(transformed(cubes.plc, place.rotation, place.shift, place.scale));
        std::map<std::int32_t, double> volumes;
        for (const ValidCell& c : valid.cells)
            if (c.filled) volumes[c.region] += c.volume / std::pow(place.scale, 3);
        for (const auto& [region, cells] : cubes.cells_of_region) EXPECT_NEAR(volumes[region], cells, 1e-8 * cells) << region;
        EXPECT_EQ(volumes.size(), cubes.cells_of_region.size());
    }
}

TEST(RegionSeeds, ThePointInsideACellNamesIt) {
    for (const Place& place : kPlaces) {
        Plc plc = transformed(cube_with_internal_facet(), place.rotation, place.shift, place.scale);
        plc.region_seeds.clear();
        const Diagnosis before = diagnose(plc);
        ASSERT_FALSE(before.has_errors()) << listing(before);
        ASSERT_EQ(before.cells.size(), 3U);
        for (std::size_t c = 1; c < 3; ++c) plc.region_seeds.push_back({before.cells[c].inside, static_cast<std::int32_t>(100 * c), 0});
        plc.names.of_dimension[3] = {{100, "oil"}, {200, "water"}};
        const Diagnosis after = diagnose(plc);
        ASSERT_FALSE(after.has_errors()) << listing(after);
        EXPECT_EQ(after.cells[1].region, 100);
        EXPECT_EQ(after.cells[2].region, 200);
        EXPECT_EQ(after.cells[1].name, "oil");
        EXPECT_EQ(after.cells[2].name, "water");
        EXPECT_EQ(after.cells[0].name, "");
        EXPECT_EQ(after.cells[1].volume, before.cells[1].volume);
    }
}

/// Adds a seed to the domain as it stands at the origin; then the whole is moved.
Diagnosis with_seed(const Place& place, const Vec3& seed) {
    Plc plc = cube_with_internal_facet();
    plc.region_seeds.push_back({seed, 9, 0});
    return diagnose(transformed(plc, place.rotation, place.shift, place.scale));
}

TEST(RegionSeeds, ConflictsSayWhere) {
    for (const Place& place : kPlaces) {
        SCOPED_TRACE(std::to_string(place.rotation) + " " + std::to_string(place.shift) + " " + std::to_string(place.scale));
        struct Case {
            DefectKind kind;
            Vec3 seed;
        };
        for (const Case& c : {Case{DefectKind::seed_conflict, {0.25, 0.5, 0.5}}, Case{DefectKind::seed_conflict, {1.75, 0.01, 0.99}},
                              Case{DefectKind::seed_outside, {1, 1, 1.001}}, Case{DefectKind::seed_outside, {-3, 0.5, 0.5}},
                              Case{DefectKind::seed_on_facet, {1, 0.5, 0.5}}, Case{DefectKind::seed_on_facet, {0.5, 0.25, 1}},
                              Case{DefectKind::seed_on_facet, {2, 1, 0.5}}, Case{DefectKind::seed_on_facet, {0, 0, 0}}}) {
            const Diagnosis d = with_seed(place, c.seed);
            std::size_t errors = 0;
            for (const Defect& defect : d.defects) {
                if (defect.severity != Severity::error) continue;
                ++errors;
                EXPECT_EQ(defect.kind, c.kind) << defect.message;
                const auto names_seed = [](const ElementRef& e) { return e.kind == EntityKind::region && e.number == 3 && e.where; };
                EXPECT_TRUE(std::any_of(defect.elements.begin(), defect.elements.end(), names_seed)) << defect.message;
                EXPECT_NE(defect.message.find("seed"), std::string::npos);
                EXPECT_NE(defect.message.find("("), std::string::npos) << "coordinates";
            }
            EXPECT_EQ(errors, 1U) << listing(d);
        }
    }
}

/// The digits of a file may put a seed on the other side of a facet, but say where it is; rounding of doubles does not.
TEST(RegionSeeds, AreTakenAsTheyAreWithinTheRoundingOfAFile) {
    for (const double off : {1e-6, 1e-15}) {
        Plc plc = cube_with_internal_facet();
        plc.relative_rounding = 1e-6;
        plc.region_seeds.clear();
        plc.region_seeds.push_back({{1 - off, 0.5, 0.5}, 9, 0});
        const Diagnosis d = diagnose(plc);
        EXPECT_EQ(count(d, DefectKind::seed_on_facet), 1U) << listing(d);
        EXPECT_EQ(d.has_errors(), off < 1e-12) << listing(d);
        if (!d.has_errors()) {
            EXPECT_EQ(d.cells[1].region, 9);
        }
    }
}

TEST(RegionSeeds, OpenSurfacesOfComplexesAreLocated) {
    Plc plc = cube();
    plc.facets.pop_back();
    const Diagnosis d = diagnose(plc);
    EXPECT_EQ(count(d, DefectKind::no_cell), 1U);
    EXPECT_EQ(count(d, DefectKind::open_edge), 4U) << "the rim of the side that lacks";
}

TEST(Markers, FirstOfSeveralVerticesAtOnePlace) {
    Plc plc = cube();
    plc.vertices.push_back(plc.vertices[2]);
    plc.vertex_markers.assign(plc.vertices.size(), 0);
    plc.vertex_markers[5] = 7;
    plc.vertex_markers.back() = 4;
    const ValidPlc valid = validate(plc);
    ASSERT_EQ(valid.vertex_markers.size(), 8U);
    EXPECT_EQ(valid.vertex_markers[2], 4);
    EXPECT_EQ(valid.vertex_markers[5], 7);
}

}  // namespace
}  // namespace wellmesh::testing
