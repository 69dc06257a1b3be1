// SPDX-License-Identifier: Apache-2.0
// The mesh does not depend on the number of threads.
#include <gtest/gtest.h>

#include <stop_token>
#include <string>
#include <vector>

#include "support/acute_plcs.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/delaunay.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh::testing {
namespace {

void expect_same(const TetMesh& a, const TetMesh& b) {
    EXPECT_TRUE(a.vertices == b.vertices);
    EXPECT_TRUE(a.tets == b.tets);
    EXPECT_TRUE(a.tet_regions == b.tet_regions);
    EXPECT_TRUE(a.subfaces == b.subfaces);
    EXPECT_TRUE(a.subsegments == b.subsegments);
}

class ThreadsOn : public ::testing::TestWithParam<std::size_t> {};

TEST_P(ThreadsOn, TheSameMesh) {
    const NamedPlc domain = all_synthetic_plcs().at(GetParam());
    for (const std::uint64_t rotation : {0U, 3U}) {
        const Plc plc = transformed(domain.plc, rotation, 0, 1);
        MeshOptions options;
        options.size.edge_length = diagonal(plc) / 60;  // enough vertices inside for several zones
        options.threads = 1;
        const MeshResult alone = generate(plc, options);
        EXPECT_TRUE(alone.certificate.proven());
        EXPECT_EQ(alone.termination, Termination::goals_met);
        for (const unsigned threads : {2U, 3U, 8U}) {
            SCOPED_TRACE(domain.name + ", " + std::to_string(threads) + " threads");
            options.threads = threads;
            expect_same(alone.mesh, generate(plc, options).mesh);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Domains, ThreadsOn, ::testing::Range<std::size_t>(0, 5));

/// Angles that take many moves, in zones, with an acute edge and without.
TEST(Threads, TheSameMeshOfLargeAngles) {
    for (const Plc& plc : {cube(), wedge(40)}) {
        MeshOptions options;
        options.size.edge_length = diagonal(plc) / 80;
        options.quality.min_dihedral_angle_deg = 30;
        options.threads = 1;
        const MeshResult alone = generate(plc, options);
        EXPECT_TRUE(alone.certificate.proven());
        EXPECT_GT(alone.mesh.tets.size(), 33'000U);  // enough for two zones
        EXPECT_GT(alone.statistics.moved_vertices, 500U);
        for (const unsigned threads : {2U, 3U, 8U}) {
            SCOPED_TRACE(threads);
            options.threads = threads;
            expect_same(alone.mesh, generate(plc, options).mesh);
        }
    }
}

TEST(ThreadsAndLimits, AsManyVerticesAsAllowedForAnyNumberOfThreads) {
    const Plc plc = cube();
    MeshOptions options;
    options.size.edge_length = 0.03;
    options.limits.max_vertices = 30'000;
    options.threads = 1;
    const MeshResult alone = generate(plc, options);
    EXPECT_LE(alone.mesh.vertices.size(), 30'000U);
    options.threads = 3;
    expect_same(alone.mesh, generate(plc, options).mesh);
}

TEST(ThreadsAndLimits, GradedSizesAreTheSame) {
    const Plc plc = cube();
    MeshOptions options;
    options.size.at = [](const Vec3& p) { return 0.02 + 0.1 * p.x; };
    options.threads = 1;
    const MeshResult alone = generate(plc, options);
    EXPECT_TRUE(alone.certificate.proven());
    options.threads = 2;
    expect_same(alone.mesh, generate(plc, options).mesh);
}

}  // namespace
}  // namespace wellmesh::testing
