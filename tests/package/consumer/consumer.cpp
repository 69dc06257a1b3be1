// SPDX-License-Identifier: Apache-2.0
// Meshes a cube with the installed library, through public headers alone.
#include <array>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <wellmesh/wellmesh.hpp>

int main() try {
    wellmesh::Plc plc;
    for (int i = 0; i < 8; ++i) plc.vertices.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2 & 1)});
    for (const auto& [a, b, c, d] : {std::array<std::uint32_t, 4>{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}})
        plc.facets.push_back({.polygons = {{a, b, c, d}}});

    wellmesh::MeshOptions options;
    options.size.edge_length = 0.5;
    const wellmesh::MeshResult result = wellmesh::generate(plc, options);
    std::printf("wellmesh %s: %zu vertices, %zu tetrahedra, %s\n", WELLMESH_VERSION, result.mesh.vertices.size(), result.mesh.tets.size(),
                wellmesh::to_string(result.termination));
    return result.termination == wellmesh::Termination::goals_met && result.certificate.proven() && !result.mesh.tets.empty() ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
