// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "core/vec3_math.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh::testing {
namespace {

TEST(GenerateOnce, TinyModelsAreMeshedLikeLargeOnes) {
    for (const NamedPlc& named : all_synthetic_plcs()) {
        SCOPED_TRACE(named.name);
        MeshOptions options;
        options.size.edge_length = 0.125 * diagonal(named.plc);
        const Plc plc = transformed(named.plc, 9, 0, 1);
        const MeshResult reference = generate(plc, options);
        for (const int power : {-60, -30}) {
            const double scale = std::ldexp(1.0, power);
            MeshOptions scaled = options;
            *scaled.size.edge_length *= scale;
            const MeshResult result = generate(transformed(plc, 0, 0, scale), scaled);
            EXPECT_EQ(result.mesh.tets, reference.mesh.tets) << power;
            EXPECT_EQ(result.mesh.subfaces, reference.mesh.subfaces);
            ASSERT_EQ(result.mesh.vertices.size(), reference.mesh.vertices.size());
            for (std::size_t v = 0; v < result.mesh.vertices.size(); ++v) ASSERT_EQ(result.mesh.vertices[v], scale * reference.mesh.vertices[v]);
        }
    }
}

}  // namespace
}  // namespace wellmesh::testing
