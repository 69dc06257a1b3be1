// SPDX-License-Identifier: Apache-2.0
// Tetrahedra between four vertices of one facet, coplanar but for rounding: their circumradius is noise.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"

namespace wellmesh::testing {
namespace {

TEST(Refine, FlatTetrahedraAreSplitWhateverTheirRoundedRadius) {
    for (std::uint64_t rotation = 1; rotation <= 30; ++rotation)
        for (const NamedPlc& named : all_synthetic_plcs()) {
            SCOPED_TRACE(fmt::format("{} rotation {}", named.name, rotation));
            MeshOptions options;
            StagedMesh staged(transformed(named.plc, rotation, 0, 1), options);
            staged.conform();
            Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
            ASSERT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
            staged.for_domain([&](TetId t) {
                const TetShape s = staged.shape(t);
                EXPECT_LE(s.radius_edge, 2 * (1 + 1e-12));
                EXPECT_GT(s.volume, 1e-9 * s.shortest_edge * s.shortest_edge * s.shortest_edge);
            });
        }
}

/// Far from the origin any tetrahedron is as thin as coordinates are rounded coarsely; only between points of the boundary does that make it noise.
TEST(Refine, ThinTetrahedraInsideAreNotFlatFarAway) {
    MeshOptions options;
    options.size.edge_length = 0.05;
    options.limits.max_vertices = 50000;  // against a cascade
    const auto vertices = [&](double shift) {
        StagedMesh staged(transformed(cube(), 0, shift, 1), options);
        staged.conform();
        Refiner refiner(staged.mesh, staged.boundary, staged.guard, options);
        EXPECT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
        return static_cast<double>(staged.mesh.vertex_count());
    };
    EXPECT_NEAR(vertices(1e12) / vertices(0), 1, 0.1);
}

}  // namespace
}  // namespace wellmesh::testing
