// SPDX-License-Identifier: Apache-2.0
// Certificates are the same for any number of threads, whatever the mesh is like.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "certify/suspect_mesh.hpp"
#include "certify/tets_by_corner.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "support/any_threads.hpp"
#include "support/grid_mesh.hpp"
#include "wellmesh/certificate.hpp"

namespace wellmesh {
namespace {

void expect_same(const ShapeStatistics& a, const ShapeStatistics& b) {
    EXPECT_EQ(a.tets, b.tets);
    EXPECT_EQ(a.max_radius_edge_ratio, b.max_radius_edge_ratio);
    EXPECT_EQ(a.max_aspect_ratio, b.max_aspect_ratio);
    EXPECT_EQ(a.min_sigma, b.min_sigma);
    EXPECT_EQ(a.min_dihedral_angle_deg, b.min_dihedral_angle_deg);
    EXPECT_EQ(a.max_dihedral_angle_deg, b.max_dihedral_angle_deg);
    EXPECT_EQ(a.min_dihedral_histogram, b.min_dihedral_histogram);
    EXPECT_EQ(a.min_edge, b.min_edge);
    EXPECT_EQ(a.mean_edge, b.mean_edge);
    EXPECT_EQ(a.max_edge, b.max_edge);
    EXPECT_EQ(a.min_volume, b.min_volume);
    EXPECT_EQ(a.max_volume, b.max_volume);
}

void expect_same(const Certificate& a, const Certificate& b) {
    ASSERT_EQ(a.claims.size(), b.claims.size());
    for (std::size_t i = 0; i < a.claims.size(); ++i) {
        const Claim &x = a.claims[i], &y = b.claims[i];
        SCOPED_TRACE(x.name);
        EXPECT_EQ(x.name, y.name);
        EXPECT_EQ(x.statement, y.statement);
        EXPECT_EQ(x.state, y.state);
        EXPECT_EQ(x.checked, y.checked);
        EXPECT_EQ(x.violations, y.violations);
        EXPECT_EQ(x.detail, y.detail);
        ASSERT_EQ(x.witness.has_value(), y.witness.has_value());
        if (!x.witness) continue;
        EXPECT_EQ(x.witness->kind, y.witness->kind);
        EXPECT_EQ(x.witness->number, y.witness->number);
        EXPECT_EQ(x.witness->where, y.witness->where);
    }
    expect_same(a.all, b.all);
    expect_same(a.interior, b.interior);
    expect_same(a.boundary, b.boundary);
    expect_same(a.unexempt, b.unexempt);
    ASSERT_EQ(a.regions.size(), b.regions.size());
    for (std::size_t i = 0; i < a.regions.size(); ++i) {
        EXPECT_EQ(a.regions[i].region, b.regions[i].region);
        EXPECT_EQ(a.regions[i].tets, b.regions[i].tets);
        EXPECT_EQ(a.regions[i].volume, b.regions[i].volume);
        EXPECT_EQ(a.regions[i].plc_volume, b.regions[i].plc_volume);
    }
}

/// Several pieces of work of each kind.
constexpr std::uint32_t kCells = 15;

Certificate certify_with_any_threads(const TetMesh& mesh, const Plc& plc) {
    CertifyOptions options;
    options.max_radius_edge_ratio = 0.9;
    options.min_dihedral_angle_deg = 44;
    options.max_aspect_ratio = 6;
    options.min_sigma = 0.16;
    options.min_sigma_boundary = 0.15;
    options.max_volume = 0.17;
    options.exempt = {3, 17000, 17001};
    return testing::compare_for_any_threads(
        [&](unsigned threads) {
            options.threads = threads;
            return certify(mesh, options, &plc);
        },
        [](const Certificate& first, const Certificate& other) { expect_same(first, other); });
}

TEST(CertifyThreads, SoundMesh) {
    const auto [plc, mesh] = testing::grid_mesh(kCells);
    ASSERT_GT(mesh.tets.size(), certifying::kGrain);
    ASSERT_GT(mesh.vertices.size(), certifying::kVertexGrain);
    const Certificate certificate = certify_with_any_threads(mesh, plc);
    for (const char* name : {"positive_tets", "disjoint_tets", "delaunay", "gabriel_subfaces", "plc_distance", "region_volumes"}) {
        SCOPED_TRACE(name);
        EXPECT_EQ(certificate.find(name)->state, Claim::State::proven);
    }
}

TEST(CertifyThreads, BrokenMeshes) {
    std::uint64_t refuted = 0, several = 0;
    for (std::uint64_t damage = 0; damage < 6; ++damage) {
        SCOPED_TRACE(damage);
        auto [plc, mesh] = testing::grid_mesh(kCells);
        for (std::uint64_t k = 0; k < 40; ++k) {
            const std::size_t t = mix64(damage, 2 * k) % mesh.tets.size(), v = mix64(damage, 2 * k + 1) % mesh.vertices.size();
            if (damage == 0 || damage == 5) mesh.vertices[v] = mesh.vertices[v] + 0.3 * Vec3{1, 0.5, unit_double(mix64(k))};
            if (damage == 1 || damage == 5) std::swap(mesh.tets[t][0], mesh.tets[t][1]);
            if (damage == 2 || damage == 5) mesh.tets.push_back(mesh.tets[t]), mesh.tet_regions.push_back(2);
            if (damage == 3) mesh.vertices.push_back(mesh.vertices[v]);
            if (damage == 4) {
                mesh.tets[t] = mesh.tets.back();
                mesh.tets.pop_back();
                mesh.tet_regions.pop_back();
                mesh.subsegments.push_back({static_cast<std::uint32_t>(v), static_cast<std::uint32_t>(v / 2)});
                mesh.subsegment_segments.push_back(1);
                mesh.subfaces.push_back({0, static_cast<std::uint32_t>(v / 2), static_cast<std::uint32_t>(v)});
                mesh.subface_facets.push_back(1);
                mesh.subface_markers.push_back(1);
            }
        }
        mesh.vertex_carriers.clear();
        const Certificate certificate = certify_with_any_threads(mesh, plc);
        for (const Claim& c : certificate.claims) refuted += c.state == Claim::State::refuted, several += c.violations > 1;
    }
    EXPECT_GT(refuted, 40U);
    EXPECT_GT(several, 25U);
}

TEST(TetsByCorner, SameForAnyNumberOfThreads) {
    TetMesh mesh = testing::grid_mesh(kCells).mesh;
    for (std::size_t t = mesh.tets.size() - 1; t > 0; --t) std::swap(mesh.tets[t], mesh.tets[mix64(t) % (t + 1)]);
    mesh.tets[7] = {5, 5, 9, 9};
    const certifying::SuspectMesh one(mesh, 1);
    const certifying::TetsByCorner expected(one);
    std::size_t entries = 0;
    for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) entries += expected.of(v).size();
    EXPECT_EQ(entries, 3 * mesh.tets.size() - 1);
    EXPECT_TRUE(certifying::has_edge(one, expected, {5, 5}));
    EXPECT_TRUE(certifying::has_edge(one, expected, {5, 9}));
    EXPECT_FALSE(certifying::has_edge(one, expected, {5, 6 + kCells * kCells}));
    for (const unsigned threads : {2U, 3U, 8U}) {
        const certifying::SuspectMesh several(mesh, threads);
        const certifying::TetsByCorner found(several);
        for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
            const auto a = expected.of(v), b = found.of(v);
            ASSERT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end())) << v;
        }
    }
}

}  // namespace
}  // namespace wellmesh
