// SPDX-License-Identifier: Apache-2.0
#include "exudation/boundary_spheres.hpp"

#include "support/synthetic_plcs.hpp"
#include "weighted_checks.hpp"

namespace wellmesh::testing {
namespace {

/// The limit is where the boundary stops to stay, for vertices inside and on facets and segments; beyond it is refused exactly.
TEST(BoundarySpheres, LimitIsWhereEncroachingBegins) {
    TetMesh mesh = almost_good_mesh(transformed(l_block(), 2, 0, 1), 0.35);
    const WeightedMesh weighted_mesh(mesh);
    std::vector<double> reach(mesh.vertices.size(), 0.01);
    const BoundarySpheres boundary(weighted_mesh, mesh, reach);
    std::size_t limited = 0, on_boundary = 0;
    mesh.weights.assign(mesh.vertices.size(), 0);
    const auto encroached_by_weight_of = [&](std::size_t v) {
        const auto concerns_v = [&](const auto& corners, std::size_t q) { return q == v || std::find(corners.begin(), corners.end(), v) != corners.end(); };
        return count_encroached(mesh, concerns_v);
    };
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const double limit = boundary.limit(VertexId{v});
        ASSERT_LE(limit, reach[v]);
        if (limit > 1e-9) {
            mesh.weights[v] = limit * (1 - 1e-6);
            EXPECT_TRUE(boundary.allows(VertexId{v}, mesh.weights[v]));
            EXPECT_EQ(encroached_by_weight_of(v), 0U) << v;
        }
        if (limit < reach[v]) {
            ++limited;
            on_boundary += mesh.vertex_carriers[v].kind != CarrierKind::region;
            mesh.weights[v] = std::max(limit, 0.0) + 1e-6;
            EXPECT_FALSE(boundary.allows(VertexId{v}, mesh.weights[v]));
            EXPECT_GT(encroached_by_weight_of(v), 0U) << v;
        }
        mesh.weights[v] = 0;
    }
    EXPECT_GT(limited, 3U);
    EXPECT_GT(on_boundary, 0U);
    EXPECT_LT(limited, mesh.vertices.size());
}

}  // namespace
}  // namespace wellmesh::testing
