// SPDX-License-Identifier: Apache-2.0
#include "wellmesh/improve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "support/expect_result.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh::testing {
namespace {

MeshOptions with_angle(double degrees) {
    MeshOptions options;
    options.quality.min_dihedral_angle_deg = degrees;
    return options;
}

/// With slivers, about a thousand tetrahedra. Carriers and labels are taken away, as other tools know none.
TetMesh almost_good_mesh(const Plc& plc) {
    MeshOptions options = with_angle(0);
    options.size.edge_length = 0.12 * diagonal(plc);
    options.seeding = Seeding::off;
    TetMesh mesh = generate(plc, options).mesh;
    mesh.vertex_carriers.clear();
    mesh.subfaces.clear();
    mesh.subface_facets.clear();
    mesh.subface_markers.clear();
    mesh.subsegments.clear();
    mesh.subsegment_segments.clear();
    return mesh;
}

/// The same mesh as another tool would number and orient it.
TetMesh shuffled(const TetMesh& mesh, std::uint64_t seed) {
    TetMesh out;
    std::vector<std::uint32_t> place(mesh.vertices.size());
    for (std::uint32_t v = 0; v < place.size(); ++v) place[v] = v;
    std::sort(place.begin(), place.end(), [&](std::uint32_t a, std::uint32_t b) { return mix64(seed, a) < mix64(seed, b); });
    out.vertices.resize(mesh.vertices.size());
    for (std::size_t v = 0; v < place.size(); ++v) out.vertices[place[v]] = mesh.vertices[v];
    for (const auto& t : mesh.tets) out.tets.push_back({place[t[1]], place[t[0]], place[t[2]], place[t[3]]});
    std::reverse(out.tets.begin(), out.tets.end());
    out.tet_regions.assign(out.tets.size(), 0);
    return out;
}

using Places = std::vector<Vec3>;
Places sorted_vertices(const TetMesh& mesh) {
    Places places = mesh.vertices;
    std::sort(places.begin(), places.end(), lexicographically_less);
    return places;
}

/// @return the message of the MeshError{bad_input} that improve() throws, with how many places it names.
std::pair<std::string, std::size_t> refusal(const TetMesh& mesh, const Plc& plc) {
    try {
        (void)improve(mesh, plc);
    } catch (const MeshError& e) {
        EXPECT_EQ(e.code(), ErrorCode::bad_input);
        return {e.what(), e.offenders().size()};
    }
    ADD_FAILURE() << "not refused";
    return {};
}

TEST(ImproveMesh, AnglesAreReachedWhoeverNumberedTheMesh) {
    for (const NamedPlc& named : all_synthetic_plcs())
        for (const std::uint64_t rotation : {0U, 3U}) {
            SCOPED_TRACE(fmt::format("{} rotation {}", named.name, rotation));
            const Plc plc = transformed(named.plc, rotation, rotation == 0 ? 0 : 1e3, 1);
            const TetMesh given = shuffled(almost_good_mesh(plc), 5);
            const MeshResult result = improve(given, plc, with_angle(25));
            expect_goals_met(result);
            EXPECT_GE(result.certificate.all.min_dihedral_angle_deg, 25);
            ASSERT_TRUE(result.statistics.given.has_value());
            const GivenMeshStatistics& s = *result.statistics.given;
            EXPECT_EQ(s.vertices, given.vertices.size());
            EXPECT_EQ(s.delaunay_tets, given.tets.size());
            EXPECT_EQ(s.added_input_vertices + s.added_for_conformity + s.added_for_refinement + s.dropped_vertices + s.moved_onto_input, 0U);
            EXPECT_LE(static_cast<double>(result.mesh.vertices.size()), 1.02 * static_cast<double>(given.vertices.size()));
        }
}

TEST(ImproveMesh, AGoodMeshKeepsItsVertices) {
    for (const NamedPlc& named : all_synthetic_plcs()) {
        SCOPED_TRACE(named.name);
        const Plc plc = transformed(named.plc, 7, 10, 1);
        MeshOptions options = with_angle(20);
        options.size.edge_length = 0.12 * diagonal(plc);
        const TetMesh good = generate(plc, options).mesh;
        const MeshResult result = improve(good, plc, with_angle(20));
        expect_goals_met(result);
        EXPECT_EQ(sorted_vertices(result.mesh), sorted_vertices(good));
        EXPECT_EQ(result.mesh.tets.size(), good.tets.size());
        const MeshResult again = improve(result.mesh, plc, with_angle(20));
        EXPECT_EQ(again.mesh.vertices, result.mesh.vertices);
        EXPECT_EQ(again.mesh.tets, result.mesh.tets);
    }
}

TEST(ImproveMesh, SameMeshOptionsAndSeedSameResult) {
    const Plc plc = transformed(l_block(), 2, 0, 1);
    const TetMesh given = almost_good_mesh(plc);
    const MeshResult a = improve(given, plc, with_angle(25)), b = improve(given, plc, with_angle(25));
    EXPECT_EQ(a.mesh.vertices, b.mesh.vertices);
    EXPECT_EQ(a.mesh.tets, b.mesh.tets);
    EXPECT_EQ(a.mesh.subfaces, b.mesh.subfaces);
}

TEST(ImproveMesh, RegionsAreTheInputs) {
    const Plc plc = transformed(cube_with_internal_facet(), 4, 0, 1);
    TetMesh given = almost_good_mesh(plc);
    given.tet_regions.assign(given.tets.size(), 77);
    const MeshResult result = improve(given, plc, with_angle(20));
    expect_goals_met(result);
    ASSERT_EQ(result.certificate.regions.size(), 2U);
    for (const RegionVolume& r : result.certificate.regions) EXPECT_NEAR(r.volume, 1, 1e-9);
    const std::set<std::int32_t> regions(result.mesh.tet_regions.begin(), result.mesh.tet_regions.end());
    EXPECT_EQ(regions.size(), 2U);
    EXPECT_EQ(regions.count(77), 0U);
    for (std::size_t t = 0; t < result.mesh.tets.size(); ++t)
        for (const std::uint32_t v : result.mesh.tets[t])
            if (const VertexCarrier& c = result.mesh.vertex_carriers[v]; c.kind == CarrierKind::region) { EXPECT_EQ(static_cast<std::int32_t>(c.id), result.mesh.tet_regions[t]); }
}

/// A grid of cubes, each cut into six tetrahedra along one diagonal. Jittered that much it is neither Delaunay nor Gabriel, and some tetrahedra are
/// inverted.
TetMesh jittered_grid(std::uint32_t n, double jitter) {
    TetMesh mesh;
    const auto number = [n](std::uint32_t x, std::uint32_t y, std::uint32_t z) { return (z * (n + 1) + y) * (n + 1) + x; };
    for (std::uint32_t z = 0; z <= n; ++z)
        for (std::uint32_t y = 0; y <= n; ++y)
            for (std::uint32_t x = 0; x <= n; ++x) {
                const auto at = [&](std::uint32_t i, std::uint64_t axis) {
                    const bool moves = i > 0 && i < n;
                    return (i + (moves ? jitter * (2 * unit_double(mix64(number(x, y, z), axis)) - 1) : 0)) / n;
                };
                mesh.vertices.push_back({at(x, 1), at(y, 2), at(z, 3)});
            }
    constexpr std::array<std::array<unsigned, 2>, 6> kPaths{{{1, 3}, {5, 1}, {3, 2}, {2, 6}, {4, 5}, {6, 4}}};  // corners between 0 and 7, as bits xyz, so that all are oriented alike
    for (std::uint32_t z = 0; z < n; ++z)
        for (std::uint32_t y = 0; y < n; ++y)
            for (std::uint32_t x = 0; x < n; ++x) {
                const auto corner = [&](unsigned bits) { return number(x + (bits & 1U), y + ((bits >> 1U) & 1U), z + ((bits >> 2U) & 1U)); };
                for (const auto& path : kPaths) mesh.tets.push_back({corner(0), corner(path[0]), corner(path[1]), corner(7)});
            }
    return mesh;
}

TEST(ImproveMesh, WhatIsNotDelaunayIsTriangulatedAgainAndMadeGabriel) {
    const TetMesh given = jittered_grid(8, 0.45);
    for (const std::uint64_t rotation : {0U, 6U}) {
        TetMesh turned = given;
        Plc as_plc;
        as_plc.vertices = turned.vertices;
        // Rotated about the cube's own middle, with the cube.
        turned.vertices = transformed(as_plc, rotation, 0, 1).vertices;
        const Plc plc = transformed(cube(), rotation, 0, 1);
        const MeshResult result = improve(turned, plc, with_angle(20));
        expect_goals_met(result);
        const GivenMeshStatistics& s = *result.statistics.given;
        EXPECT_LT(s.delaunay_tets, given.tets.size());
        EXPECT_GT(s.delaunay_tets, 0U);
        EXPECT_GT(s.added_for_conformity, 0U);
        EXPECT_LT(s.added_for_conformity + s.added_for_refinement, given.vertices.size() / 2);
    }
}

TEST(ImproveMesh, VerticesBesideTheInputAreMovedOntoIt) {
    const Plc plc = transformed(cube_with_internal_facet(), 5, 0, 1);
    TetMesh given = almost_good_mesh(plc);
    for (std::size_t v = 0; v < given.vertices.size(); ++v) {
        const auto off = [&](std::uint64_t axis) { return 5e-10 * (2 * unit_double(mix64(v, axis)) - 1); };
        given.vertices[v] = given.vertices[v] + Vec3{off(1), off(2), off(3)};
    }
    const MeshResult result = improve(given, plc, with_angle(20));
    expect_goals_met(result);
    EXPECT_GT(result.statistics.given->moved_onto_input, 100U);
    EXPECT_GT(result.statistics.given->farthest_vertex, 1e-10);
    EXPECT_LT(result.statistics.given->farthest_vertex, result.statistics.given->tolerance);
    // Input vertices are the input's own, to the bit.
    for (std::size_t v = 0; v < plc.vertices.size(); ++v) EXPECT_EQ(result.mesh.vertices[v], plc.vertices[v]);
}

TEST(ImproveMesh, RoundedTextIsAcceptedWhenItSaysSo) {
    const Plc plc = transformed(l_block(), 5, 0, 1);
    TetMesh given = almost_good_mesh(plc);
    for (Vec3& p : given.vertices) p = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    EXPECT_NE(refusal(given, plc).first.find("lie on no facet"), std::string::npos);
    given.relative_rounding = 0x1p-24;
    expect_goals_met(improve(given, plc, with_angle(20)));
}

TEST(ImproveMesh, MissingInputVerticesAreAddedAndSpareVerticesDropped) {
    TetMesh given = almost_good_mesh(cube());
    Plc plc = cube();
    plc.vertices.push_back({0.5, 0.25, 0});  // a point on the bottom that the mesh knows nothing of
    const auto bottom = std::find_if(plc.facets.begin(), plc.facets.end(), [&](const PlcFacet& f) {
        return std::all_of(f.polygons[0].begin(), f.polygons[0].end(), [&](std::uint32_t v) { return plc.vertices[v].z == 0; });
    });
    ASSERT_NE(bottom, plc.facets.end());
    bottom->polygons.push_back({8});
    given.vertices.push_back({5, 5, 5});                // of no tetrahedron
    // At the places of an input vertex and of another one, and used for them once.
    for (const std::uint32_t twice : {given.tets.front()[0], given.tets.back()[0]}) {
        given.vertices.push_back(given.vertices[twice]);
        auto& tet = twice == given.tets.front()[0] ? given.tets.front() : given.tets.back();
        tet[0] = static_cast<std::uint32_t>(given.vertices.size() - 1);
    }
    const MeshResult result = improve(given, plc, with_angle(20));
    expect_goals_met(result);
    EXPECT_EQ(result.statistics.given->added_input_vertices, 1U);
    EXPECT_EQ(result.statistics.given->dropped_vertices, 3U);
    EXPECT_EQ(result.mesh.vertices[8], plc.vertices[8]);
}

TEST(ImproveMesh, MeshesOfOtherDomainsAreRefusedAndItIsSaidWhere) {
    const TetMesh given = almost_good_mesh(cube());
    EXPECT_NE(refusal(given, cube(2)).first.find("lie on no facet"), std::string::npos);
    EXPECT_NE(refusal(given, transformed(cube(), 1, 0, 1)).first.find("lie on no facet"), std::string::npos);
    // One of the two cubes only: everything that is there is right.
    const auto [half, missing] = refusal(given, cube_with_internal_facet());
    EXPECT_NE(half.find("does not fill"), std::string::npos) << half;
    EXPECT_EQ(missing, 4U);
    // A tetrahedron is missing inside: then its corners are on the hull.
    TetMesh holed = given;
    const auto inside = std::find_if(holed.tets.begin(), holed.tets.end(), [&](const auto& t) {
        return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) {
            const Vec3& p = given.vertices[v];
            return std::min({p.x, p.y, p.z, 1 - p.x, 1 - p.y, 1 - p.z}) > 1e-3;
        });
    });
    ASSERT_NE(inside, holed.tets.end());
    holed.tets.erase(inside);
    EXPECT_EQ(refusal(holed, cube()).second, 4U);
    // The notch of the L is filled: all vertices are on its facets.
    TetMesh filled;
    filled.vertices = l_block().vertices;
    Plc block = l_block();
    MeshOptions coarse = with_angle(0);
    filled = generate(block, coarse).mesh;
    filled.tets.push_back(filled.tets[0]);  // overlaps
    EXPECT_NE(refusal(filled, block).first.find("does not fill"), std::string::npos);
}

TEST(ImproveMesh, MalformedMeshesAreErrors) {
    const TetMesh given = almost_good_mesh(cube());
    EXPECT_NE(refusal(TetMesh{}, cube()).first.find("no tetrahedra"), std::string::npos);
    TetMesh broken = given;
    broken.tets[3][2] = 1'000'000;
    EXPECT_NE(refusal(broken, cube()).first.find("corner 1000001"), std::string::npos);
    broken = given;
    broken.tets[3][2] = broken.tets[3][1];
    EXPECT_NE(refusal(broken, cube()).first.find("twice"), std::string::npos);
    broken = given;
    broken.vertices[1].y = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(refusal(broken, cube()).first.find("not finite"), std::string::npos);
}

TEST(ImproveMesh, OptionsLimitsAndStops) {
    const Plc plc = cube();
    const TetMesh given = almost_good_mesh(plc);
    MeshOptions options = certified_options();
    EXPECT_THROW((void)improve(given, plc, options), MeshError);
    options = with_angle(20);
    options.invariants = true;
    EXPECT_THROW((void)improve(given, plc, options), MeshError);
    options = with_angle(60);
    options.limits.max_vertices = given.vertices.size();
    EXPECT_EQ(improve(given, plc, options).termination, Termination::vertex_budget_reached);
    std::stop_source stop;
    stop.request_stop();
    RunControl control;
    control.stop = stop.get_token();
    try {
        (void)improve(given, plc, with_angle(20), control);
        ADD_FAILURE() << "stopped before there is anything to hand out";
    } catch (const MeshError& e) {
        EXPECT_EQ(e.code(), ErrorCode::cancelled);
    }
}

TEST(ImproveMesh, ASizeIsRefinedTo) {
    const Plc plc = transformed(cube(), 3, 0, 1);
    MeshOptions options = with_angle(20);
    options.size.edge_length = 0.15;
    const MeshResult result = improve(almost_good_mesh(plc), plc, options);
    expect_goals_met(result);
    EXPECT_GT(result.statistics.given->added_for_refinement, 0U);
}

}  // namespace
}  // namespace wellmesh::testing
