// SPDX-License-Identifier: Apache-2.0
#include "certify/hull_proof.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "brute_force.hpp"
#include "certify/mesh_survey.hpp"
#include "certify/space_claims.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "support/grid_mesh.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/certificate.hpp"
#include "wellmesh/delaunay.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh::certifying {
namespace {

/// What a hull proves.
struct Findings {
    bool embedded = false, hull_is_clear = false, interfaces_are_clear = false, segments_are_clear = false;
    std::size_t components = 0;
};

Findings look(const TetMesh& mesh) {
    const SuspectMesh suspect(mesh);
    const TetsByCorner stars(suspect);
    const MeshSurvey survey = survey_mesh(suspect, stars, {}, {});
    const HullProof proof(suspect, survey.faces.constraints, true);
    const bool segments = proof.segments_are_clear(stars, find_constraint_segments(suspect, survey.faces.constraints, 1e-6));
    return {proof.embedded(), proof.hull_is_clear(), proof.interfaces_are_clear(), segments, proof.components().size()};
}

/// The 48 symmetries of the cube with a scale each, exact in doubles; mirrored ones exchange two corners of every tetrahedron.
TetMesh turned(TetMesh mesh, std::uint32_t which) {
    constexpr std::array<std::array<std::size_t, 3>, 6> kOrders{{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
    const std::array<std::size_t, 3>& order = kOrders[which % 6];
    const std::uint32_t signs = which / 6 % 8;
    const double scale = std::array{1.0, 0x1p-40, 0x1p40}[which % 3];
    for (Vec3& p : mesh.vertices) {
        const std::array<double, 3> old{p.x, p.y, p.z};
        const auto at = [&](std::size_t k) { return (signs >> k & 1 ? -scale : scale) * old[order[k]]; };
        p = {at(0), at(1), at(2)};
    }
    const bool mirrored = (which % 6 >= 3) != ((signs & 1) != ((signs >> 1 & 1) != (signs >> 2 & 1)));
    if (mirrored)
        for (auto& t : mesh.tets) std::swap(t[0], t[1]);
    return mesh;
}

void append(TetMesh& mesh, const TetMesh& other, const std::function<Vec3(const Vec3&)>& map) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& p : other.vertices) mesh.vertices.push_back(map(p));
    for (auto t : other.tets) {
        for (std::uint32_t& v : t) v += first;
        mesh.tets.push_back(t);
    }
}

/// Tetrahedra only.
TetMesh bare(const TetMesh& mesh) {
    TetMesh result;
    result.vertices = mesh.vertices;
    result.tets = mesh.tets;
    return result;
}

/// Only those tetrahedra of a grid's mesh whose cell is wanted; without the vertices that none of them uses.
TetMesh cells(std::uint32_t n, const std::function<bool(const Vec3&)>& wanted) {
    const TetMesh grid = testing::grid_mesh(n).mesh;
    TetMesh mesh;
    std::vector<std::uint32_t> number(grid.vertices.size(), kNone);
    for (auto t : grid.tets) {
        Vec3 low = grid.vertices[t[0]];
        for (const std::uint32_t v : t) low = {std::min(low.x, grid.vertices[v].x), std::min(low.y, grid.vertices[v].y), std::min(low.z, grid.vertices[v].z)};
        if (!wanted(low)) continue;
        for (std::uint32_t& v : t) {
            if (number[v] == kNone) {
                number[v] = static_cast<std::uint32_t>(mesh.vertices.size());
                mesh.vertices.push_back(grid.vertices[v]);
            }
            v = number[v];
        }
        mesh.tets.push_back(t);
    }
    return mesh;
}

// Every tetrahedron of the grid has its cell's eight corners on its sphere, and every hull face the fourth corner of its square.
TEST(HullProof, HoldsForGrids) {
    const TetMesh grid = testing::grid_mesh(4).mesh;
    for (std::uint32_t which = 0; which < 48; ++which) {
        const TetMesh mesh = turned(grid, which);
        const Findings found = look(mesh);
        EXPECT_TRUE(found.embedded) << which;
        EXPECT_TRUE(found.hull_is_clear) << which;
        EXPECT_TRUE(found.interfaces_are_clear) << which;
        EXPECT_TRUE(found.segments_are_clear) << which;
        EXPECT_EQ(found.components, 1U) << which;
        EXPECT_TRUE(certify(mesh).proven()) << which;
    }
}

bool within(const Vec3& p, double low, double high) { return std::min({p.x, p.y, p.z}) >= low && std::max({p.x, p.y, p.z}) < high; }

TEST(HullProof, FollowsComponents) {
    const TetMesh with_cavity = cells(5, [&](const Vec3& p) { return !within(p, 1, 4); });
    EXPECT_EQ(look(with_cavity).components, 2U);
    EXPECT_TRUE(certify(with_cavity).proven());
    const TetMesh nested = cells(5, [&](const Vec3& p) { return !within(p, 1, 4) || within(p, 2, 3); });
    EXPECT_EQ(look(nested).components, 3U);
    EXPECT_TRUE(look(nested).embedded);
    EXPECT_TRUE(certify(nested).proven());
    // Two cells that share an edge, or a corner, only: four faces at the edge, so that one doesn't lead to the other.
    const TetMesh pinched = cells(2, [](const Vec3& p) { return p.x == p.y && p.z == 0; });
    EXPECT_EQ(look(pinched).components, 2U);
    EXPECT_TRUE(look(pinched).embedded);
    EXPECT_EQ(certify(pinched).find("disjoint_tets")->state, Claim::State::proven);
}

// A body inside the solid of another one: no hull face meets another one's, and only the side on which they are tells.
TEST(HullProof, BodiesWithinBodiesAreRefuted) {
    for (std::uint32_t which = 0; which < 48; which += 5)
        for (const bool in_cavity : {false, true}) {
            TetMesh mesh = cells(5, [&](const Vec3& p) { return !in_cavity || !within(p, 1, 4); });
            append(mesh, cells(1, [](const Vec3&) { return true; }), [](const Vec3& p) { return Vec3{2.375, 2.375, 2.375} + 0.25 * p; });
            mesh = turned(mesh, which);
            const Findings found = look(mesh);
            EXPECT_TRUE(found.embedded);
            EXPECT_EQ(found.components, in_cavity ? 3U : 2U);
            const Certificate certificate = certify(mesh);
            EXPECT_EQ(certificate.find("disjoint_tets")->state, in_cavity ? Claim::State::proven : Claim::State::refuted);
            EXPECT_EQ(certificate.find("delaunay")->state, in_cavity ? Claim::State::proven : Claim::State::refuted);
        }
}

// Two copies of one grid, by how much they are shifted: they overlap, touch with other vertices than each other's, or are apart, by less than their
// faces' spheres allow or by more.
TEST(HullProof, CopiesAreToldApart) {
    const TetMesh grid = cells(2, [](const Vec3&) { return true; });
    struct Case {
        Vec3 shift;
        bool disjoint, delaunay;
    };
    const std::vector<Case> cases{{{0, 0, 0}, false, true},        {{1, 1, 1}, false, true},      {{0.5, 0.25, 0.125}, false, false}, {{0x1p-40, 0, 0}, false, false},
                                  {{2, 0.5, 0.5}, true, false},    {{2, 2, 0.5}, true, false},    {{2.25, 0.5, 0.5}, true, false},    {{2.25, 0, 0}, true, true},
                                  {{2.75, 0.5, 0.5}, true, true},  {{3, 0, 0}, true, true},       {{2.5, 2.5, 2.5}, true, true}};
    for (const Case& c : cases)
        for (std::uint32_t which = 0; which < 48; which += 7) {
            TetMesh mesh = grid;
            append(mesh, grid, [&](const Vec3& p) { return p + c.shift; });
            mesh = turned(mesh, which);
            SCOPED_TRACE(::testing::Message() << c.shift.x << ' ' << c.shift.y << ' ' << c.shift.z << ", " << which);
            const Certificate certificate = certify(mesh);
            const bool disjoint = certificate.find("disjoint_tets")->state == Claim::State::proven;
            EXPECT_EQ(disjoint, c.disjoint);
            EXPECT_EQ(certificate.find("delaunay")->violations == 0, c.delaunay);
            if (!c.disjoint) {
                EXPECT_FALSE(look(mesh).embedded);
            }
            const auto counts = testing::count_by_brute_force(mesh);
            // With the same weight everywhere spheres are what they are without.
            mesh.weights.assign(mesh.vertices.size(), which % 3 == 0 ? 0.125 : 0);
            const Certificate weighted = certify(mesh);
            EXPECT_EQ(weighted.find("disjoint_tets")->violations, certificate.find("disjoint_tets")->violations);
            for (const std::string name : {"delaunay", "gabriel_subfaces", "gabriel_subsegments"}) {
                EXPECT_EQ(certificate.find(name)->violations, counts.at(name)) << name;
                EXPECT_EQ(weighted.find("weighted_" + name)->violations, counts.at(name)) << name;
            }
        }
}

// Meshes of two bodies whose vertices have been moved a little, so that some are Delaunay and Gabriel, some only here and there: what is proven is
// what trying everything says.
TEST(HullProof, AgreesWithBruteForce) {
    std::array<std::array<int, 2>, 4> seen{};
    int by_hull = 0, partly = 0;
    for (std::uint64_t key = 0; key < 120; ++key) {
        TetMesh mesh = bare(testing::two_region_box().mesh);
        if (key % 3 == 0) mesh.tet_regions = testing::two_region_box().mesh.tet_regions;
        const double gap = 1.5 * unit_double(mix64(key, 1)) - 0.6;
        const auto shift = [&](const Vec3& p) { return Vec3{p.y + 4 + gap, p.x, -p.z}; };  // turned about, mirrored twice
        if (key % 2 == 0) {
            append(mesh, bare(testing::two_region_box().mesh), shift);
            mesh.tet_regions.resize(mesh.tet_regions.empty() ? 0 : mesh.tets.size(), 1);
        }
        const double size = std::array{0.0, 1e-3, 0.05, 0.3}[key / 2 % 4];
        for (std::uint64_t k = 0; k < 6; ++k) {
            Vec3& p = mesh.vertices[mix64(key, 10 + k) % mesh.vertices.size()];
            p = p + size * Vec3{unit_double(mix64(key, 20 + k)) - 0.5, unit_double(mix64(key, 30 + k)) - 0.5, unit_double(mix64(key, 40 + k)) - 0.5};
        }
        auto counts = testing::count_by_brute_force(mesh);
        if (counts.at("positive_tets") > 0) continue;
        const SuspectMesh suspect(mesh);
        for (std::size_t t = 0; t < mesh.tets.size(); ++t)
            for (std::size_t u = 0; u < t; ++u) counts["disjoint_tets"] += overlap(suspect, t, u);
        const Certificate certificate = certify(mesh);
        constexpr std::array<const char*, 4> kNames{"disjoint_tets", "delaunay", "gabriel_subfaces", "gabriel_subsegments"};
        for (std::size_t i = 0; i < kNames.size(); ++i) {
            const Claim& claim = *certificate.find(kNames[i]);
            ++seen[i][claim.violations == 0];
            EXPECT_EQ(claim.state, counts.at(kNames[i]) == 0 ? Claim::State::proven : Claim::State::refuted) << kNames[i] << ' ' << key;
            if (i > 0) {
                EXPECT_EQ(claim.violations, counts.at(kNames[i])) << kNames[i] << ' ' << key;
            }
        }
        const Findings found = look(mesh);
        by_hull += found.embedded && found.hull_is_clear && found.segments_are_clear;
        partly += found.embedded != (found.hull_is_clear && found.segments_are_clear);
    }
    for (const auto& [refuted, proven] : seen) {
        EXPECT_GT(proven, 15);
        EXPECT_GT(refuted, 5);
    }
    EXPECT_GT(by_hull, 10);
    EXPECT_GT(partly, 5);
}

// Edge beside edge of two cells: corners are inside the diametral spheres of edges of the other one, and in no other sphere.
TEST(HullProof, EdgesAcrossAGapCount) {
    for (std::uint32_t which = 0; which < 48; ++which)
        for (const double gap : {0.25, 0.5}) {
            TetMesh mesh = cells(1, [](const Vec3&) { return true; });
            append(mesh, TetMesh(mesh), [&](const Vec3& p) { return p + Vec3{1 + gap, 1 + gap, 0.5}; });
            mesh = turned(mesh, which);
            const Findings found = look(mesh);
            EXPECT_TRUE(found.embedded && found.hull_is_clear);
            EXPECT_EQ(found.segments_are_clear, gap == 0.5);
            EXPECT_EQ(certify(mesh).find("delaunay")->state, Claim::State::proven);
            EXPECT_EQ(certify(mesh).find("gabriel_subsegments")->violations, gap == 0.5 ? 0U : 2U);
        }
}

// Nothing but the vertices inside decides here: apexes of the hull's tetrahedra, or neighbours of its edges, or neither.
TEST(HullProof, ApexesAndNeighboursCount) {
    int only_faces = 0, neither = 0;
    for (std::uint64_t key = 0; key < 200; ++key) {
        std::vector<Vec3> points;
        for (unsigned i = 0; i < 8; ++i) points.push_back({i & 1U ? 1.0 : 0.0, i & 2U ? 1.0 : 0.0, i & 4U ? 1.0 : 0.0});
        // Of the cube's faces' spheres a part of the cube's middle is outside, if the cube is wide enough.
        for (std::size_t i = 0; i < 8; ++i) points[i] = (key % 2 == 0 ? 1 : 2) * points[i];
        if (key % 2 != 0)
            for (int i = 0; i < 27; ++i)
                if (const Vec3 p{static_cast<double>(i % 3), static_cast<double>(i / 3 % 3), static_cast<double>(i / 9)}; p.x == 1 || p.y == 1 || p.z == 1)
                    if (!(p.x == 1 && p.y == 1 && p.z == 1)) points.push_back(p);
        const double width = key % 2 == 0 ? 1 : 2;
        points.push_back({width * unit_double(mix64(key, 0)), width * unit_double(mix64(key, 1)), width * unit_double(mix64(key, 2))});
        const TetMesh mesh = triangulate_points(points).mesh;
        const Certificate certificate = certify(mesh);
        const auto counts = testing::count_by_brute_force(mesh);
        for (const char* name : {"delaunay", "gabriel_subfaces", "gabriel_subsegments"}) EXPECT_EQ(certificate.find(name)->violations, counts.at(name)) << name << ' ' << key;
        only_faces += counts.at("gabriel_subfaces") > 0 && counts.at("gabriel_subsegments") == 0;
        neither += counts.at("gabriel_subfaces") == 0 && counts.at("gabriel_subsegments") == 0;
    }
    EXPECT_GT(only_faces, 10);
    EXPECT_GT(neither, 10);
}

TEST(HullProof, HoldsForGeneratedMeshes) {
    for (const Plc& plc : {testing::cube_with_cavity(), testing::cube_with_internal_facet(), testing::stepped_shaft(), testing::transformed(testing::l_block(), 3, 2, 0.37)}) {
        MeshOptions options;
        options.size.edge_length = 0.4;
        const Findings found = look(generate(plc, options).mesh);
        EXPECT_TRUE(found.embedded);
        EXPECT_TRUE(found.hull_is_clear);
        EXPECT_TRUE(found.interfaces_are_clear);
        EXPECT_TRUE(found.segments_are_clear);
    }
}

TEST(MeetProperly, Cases) {
    TetMesh m;
    m.vertices = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {4, 4, 0}, {-4, 0, 0}, {0, -4, 0}, {1, 1, 0}, {1, 1, 4}, {5, 5, 4}, {2, 0, 0}, {1, 1, -3}, {0, 0, 4}, {2, 2, 0}, {6, 2, 0}};
    m.tets = {{0, 1, 2, 11}};
    constexpr std::uint32_t kTop = 11;
    struct Case {
        Triangle a, b;
        bool proper;
    };
    const std::vector<Case> cases{
        {{0, 1, 2}, {3, 1, 2}, true},    // two halves of a square
        {{0, 1, 2}, {0, 1, 3}, false},   // both on one side of their edge
        {{0, 1, 2}, {0, 4, 5}, true},    // opposite quadrants: each edge goes on in one of the other's
        {{0, 1, 2}, {0, 1, 5}, true},    {{0, 1, 2}, {0, 3, 5}, false},
        {{0, 1, 2}, {0, 3, 1}, false},   {{0, 1, 2}, {6, 7, 8}, false},  // a corner inside of the other one
        {{0, 1, 2}, {7, 8, 10}, false},  // through it
        {{0, 1, 2}, {9, 5, 7}, false},   // a corner on an edge
        {{0, 1, 2}, {12, 3, 13}, false}, // the same, all in one plane
        {{0, 1, 2}, {3, 8, 13}, true},   // apart
        {{0, 1, 2}, {0, 1, 7}, true},    {{0, 1, 2}, {0, 7, 8}, true}, {{0, 1, 2}, {0, 7, 10}, false},
    };
    for (std::uint32_t which = 0; which < 48; ++which) {
        const TetMesh mesh = turned(m, which);
        const SuspectMesh suspect(mesh);
        for (const Case& c : cases)
            for (std::size_t shift = 0; shift < 3; ++shift) {
                const auto with_apex = [&](const Triangle& t) { return std::array<std::uint32_t, 4>{t[shift], t[(shift + 1) % 3], t[(shift + 2) % 3], kTop}; };
                EXPECT_EQ(meet_properly(suspect, with_apex(c.a), with_apex(c.b)), c.proper) << c.b[0] << ' ' << c.b[1] << ' ' << c.b[2];
                EXPECT_EQ(meet_properly(suspect, with_apex(c.b), with_apex(c.a)), c.proper) << c.b[0] << ' ' << c.b[1] << ' ' << c.b[2];
            }
    }
}

}  // namespace
}  // namespace wellmesh::certifying
