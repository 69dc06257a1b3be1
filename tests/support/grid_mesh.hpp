// SPDX-License-Identifier: Apache-2.0
// A mesh of any size in no time: cubes of a grid, each cut into six tetrahedra around its diagonal.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "wellmesh/plc.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh::testing {

struct GridMesh {
    Plc plc;
    TetMesh mesh;
};

/// The cube [0, n]^3 in n^3 unit cubes, 6 n^3 tetrahedra; its six sides are listed, no edges.
inline GridMesh grid_mesh(std::uint32_t n) {
    GridMesh grid;
    const double size = n;
    grid.plc.vertices = {{0, 0, 0}, {size, 0, 0}, {size, size, 0}, {0, size, 0}, {0, 0, size}, {size, 0, size}, {size, size, size}, {0, size, size}};
    for (const auto& side : {std::array<std::uint32_t, 4>{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}) {
        PlcFacet facet;
        facet.polygons.push_back({side.begin(), side.end()});
        grid.plc.facets.push_back(facet);
    }
    TetMesh& mesh = grid.mesh;
    const std::uint32_t row = n + 1;
    const auto number = [&](const std::array<std::uint32_t, 3>& p) { return (p[0] * row + p[1]) * row + p[2]; };
    for (std::uint32_t i = 0; i <= n; ++i)
        for (std::uint32_t j = 0; j <= n; ++j)
            for (std::uint32_t k = 0; k <= n; ++k) mesh.vertices.push_back({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
    for (std::uint32_t i = 0; i < n; ++i)
        for (std::uint32_t j = 0; j < n; ++j)
            for (std::uint32_t k = 0; k < n; ++k) {
                std::array<std::size_t, 3> axes{0, 1, 2};
                do {  // from one end of the diagonal to the other, an axis at a time
                    std::array<std::uint32_t, 3> p{i, j, k};
                    std::array<std::uint32_t, 4> tet{number(p), 0, 0, 0};
                    for (std::size_t step = 0; step < 3; ++step) {
                        ++p[axes[step]];
                        tet[step + 1] = number(p);
                    }
                    const bool even = axes == std::array<std::size_t, 3>{0, 1, 2} || axes == std::array<std::size_t, 3>{1, 2, 0} || axes == std::array<std::size_t, 3>{2, 0, 1};
                    if (!even) std::swap(tet[2], tet[3]);
                    mesh.tets.push_back(tet);
                    mesh.tet_regions.push_back(1);
                    for (const auto& f : {std::array<std::size_t, 3>{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}) {
                        const auto on_side = [&](auto coordinate) {
                            const double x = coordinate(mesh.vertices[tet[f[0]]]);
                            return (x == 0 || x == size) && coordinate(mesh.vertices[tet[f[1]]]) == x && coordinate(mesh.vertices[tet[f[2]]]) == x;
                        };
                        if (!on_side([](const Vec3& v) { return v.x; }) && !on_side([](const Vec3& v) { return v.y; }) && !on_side([](const Vec3& v) { return v.z; })) continue;
                        mesh.subfaces.push_back({tet[f[0]], tet[f[1]], tet[f[2]]});
                        mesh.subface_facets.push_back(1);
                        mesh.subface_markers.push_back(0);
                    }
                } while (std::next_permutation(axes.begin(), axes.end()));
            }
    return grid;
}

}  // namespace wellmesh::testing
