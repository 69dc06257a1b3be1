// SPDX-License-Identifier: Apache-2.0
// A box of n x n x n cells of six tetrahedra each (Kuhn's subdivision), with two regions, its six sides as facets and its
// twelve edges as segments: something to write whose every array is known.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

#include "core/rng.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh::testing {

inline TetMesh sample_mesh(std::uint32_t n) {
    TetMesh mesh;
    const std::uint32_t m = n + 1;
    // Coordinates with full mantissas, increasing in each direction, so that tetrahedra stay positive: monotone jitter below 0.3.
    const auto coordinate = [&](std::uint32_t axis, std::uint32_t i) {
        return -0.1 + (static_cast<double>(i) + 0.3 * unit_double(mix64(axis, i))) / 3.0;
    };
    for (std::uint32_t k = 0; k < m; ++k)
        for (std::uint32_t j = 0; j < m; ++j)
            for (std::uint32_t i = 0; i < m; ++i) mesh.vertices.push_back({coordinate(0, i), coordinate(1, j), coordinate(2, k)});
    const auto id = [&](const std::array<std::uint32_t, 3>& at) { return at[0] + m * (at[1] + m * at[2]); };
    const auto face_side = [&](const std::array<std::array<std::uint32_t, 3>, 3>& corners) -> std::int32_t {
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const std::uint32_t plane : {0U, n})
                if (std::all_of(corners.begin(), corners.end(), [&](const auto& c) { return c[axis] == plane; }))
                    return static_cast<std::int32_t>(2 * axis + (plane == 0 ? 1 : 2));
        return 0;
    };
    for (std::uint32_t k = 0; k < n; ++k)
        for (std::uint32_t j = 0; j < n; ++j)
            for (std::uint32_t i = 0; i < n; ++i) {
                std::array<std::size_t, 3> path{0, 1, 2};  // order in which the axes are walked from one corner to the opposite
                do {
                    std::array<std::array<std::uint32_t, 3>, 4> c{{{i, j, k}, {}, {}, {}}};
                    for (std::size_t s = 0; s < 3; ++s) {
                        c[s + 1] = c[s];
                        ++c[s + 1][path[s]];
                    }
                    const bool even = (path[1] + 3 - path[0]) % 3 == 1;
                    if (!even) std::swap(c[2], c[3]);
                    mesh.tets.push_back({id(c[0]), id(c[1]), id(c[2]), id(c[3])});
                    mesh.tet_regions.push_back(2 * i < n ? -10 : 20);
                    for (std::size_t omit = 0; omit < 4; ++omit) {
                        const std::array<std::array<std::uint32_t, 3>, 3> f{c[(omit + 1) % 4], c[(omit + 2) % 4], c[(omit + 3) % 4]};
                        if (const std::int32_t side = face_side(f); side != 0) {
                            mesh.subfaces.push_back({id(f[0]), id(f[1]), id(f[2])});
                            mesh.subface_facets.push_back(side);
                            mesh.subface_markers.push_back(side < 3 ? 100 : -7);
                        }
                    }
                } while (std::next_permutation(path.begin(), path.end()));
            }
    std::int32_t segment = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const std::uint32_t a : {0U, n})
            for (const std::uint32_t b : {0U, n}) {
                ++segment;
                for (std::uint32_t i = 0; i < n; ++i) {
                    std::array<std::uint32_t, 3> from{};
                    from[axis] = i;
                    from[(axis + 1) % 3] = a;
                    from[(axis + 2) % 3] = b;
                    std::array<std::uint32_t, 3> to = from;
                    ++to[axis];
                    mesh.subsegments.push_back({id(from), id(to)});
                    mesh.subsegment_segments.push_back(segment);
                }
            }
    return mesh;
}

}  // namespace wellmesh::testing
