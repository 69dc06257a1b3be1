// SPDX-License-Identifier: Apache-2.0
// Slow checks of weighted meshes that share nothing with src/.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "oracle/rational_predicates.hpp"
#include "wellmesh/generate.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh::testing {

inline WeightedPoint weighted(const TetMesh& mesh, std::size_t v) { return {mesh.vertices[v], mesh.weights.empty() ? 0 : mesh.weights[v]}; }

/// Centre and squared radius of the sphere orthogonal to a tetrahedron, relative to its first corner, by Cramer's rule in long doubles.
struct OrthogonalSphere {
    using Long = long double;
    std::array<Long, 3> centre{};
    Long radius_squared = 0, scale = 0;
    OrthogonalSphere(const TetMesh& mesh, const std::array<std::uint32_t, 4>& tet) {
        const WeightedPoint a = weighted(mesh, tet[0]);
        std::array<std::array<Long, 3>, 3> m{};
        std::array<Long, 3> half_lift{};
        for (std::size_t i = 0; i < 3; ++i) {
            const WeightedPoint p = weighted(mesh, tet[i + 1]);
            m[i] = {Long{p.point.x} - Long{a.point.x}, Long{p.point.y} - Long{a.point.y}, Long{p.point.z} - Long{a.point.z}};
            half_lift[i] = (m[i][0] * m[i][0] + m[i][1] * m[i][1] + m[i][2] * m[i][2] - Long{p.weight} + Long{a.weight}) / 2;
        }
        const auto det = [](const auto& r) {
            return r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1]) - r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0]) +
                   r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
        };
        for (std::size_t k = 0; k < 3; ++k) {
            auto column = m;
            for (std::size_t i = 0; i < 3; ++i) column[i][k] = half_lift[i];
            centre[k] = det(column) / det(m);
            scale += centre[k] * centre[k];
        }
        radius_squared = scale - Long{a.weight};
    }
};

/// Tetrahedra with a vertex of the mesh in conflict. All pairs, by long doubles where they are sure (to a millionth of the squares involved:
/// they are good for 1e-9 down to volumes of 1e-9), else by big integers.
inline std::size_t count_conflicts(const TetMesh& mesh) {
    using Long = long double;
    std::size_t count = 0;
    for (const auto& tet : mesh.tets) {
        const OrthogonalSphere sphere(mesh, tet);
        const Vec3& a = mesh.vertices[tet[0]];
        bool found = false;
        for (std::size_t q = 0; q < mesh.vertices.size() && !found; ++q) {
            if (std::find(tet.begin(), tet.end(), q) != tet.end()) continue;
            const WeightedPoint p = weighted(mesh, q);
            const Long x = Long{p.point.x} - Long{a.x} - sphere.centre[0], y = Long{p.point.y} - Long{a.y} - sphere.centre[1];
            const Long z = Long{p.point.z} - Long{a.z} - sphere.centre[2];
            const Long distance = x * x + y * y + z * z, spare = distance - sphere.radius_squared - Long{p.weight};
            if (std::abs(spare) > 1e-6L * (distance + sphere.scale + std::abs(Long{p.weight})))
                found = spare < 0;
            else
                found = oracle::power_test({weighted(mesh, tet[0]), weighted(mesh, tet[1]), weighted(mesh, tet[2]), weighted(mesh, tet[3]), p}) ==
                        Sign::positive;
        }
        count += found;
    }
    return count;
}

/// Pairs of a listed triangle or edge and a vertex in conflict with its smallest orthogonal sphere, by big integers for those that are near.
/// @param wanted  which pairs to look at: (corners, vertex).
template <class Wanted>
std::size_t count_encroached(const TetMesh& mesh, Wanted&& wanted) {
    const auto distance = [&](std::size_t a, std::size_t b) {
        const Vec3 &p = mesh.vertices[a], &s = mesh.vertices[b];
        return std::hypot(p.x - s.x, p.y - s.y, p.z - s.z);
    };
    std::size_t count = 0;
    for (const auto& f : mesh.subfaces) {
        const double reach = 2 * std::max({distance(f[0], f[1]), distance(f[1], f[2]), distance(f[2], f[0])});
        for (std::size_t q = 0; q < mesh.vertices.size(); ++q)
            if (std::find(f.begin(), f.end(), q) == f.end() && wanted(f, q) && distance(q, f[0]) < reach)
                count += oracle::equatorial_power_test(weighted(mesh, f[0]), weighted(mesh, f[1]), weighted(mesh, f[2]), weighted(mesh, q)) == Sign::positive;
    }
    for (const auto& s : mesh.subsegments)
        for (std::size_t q = 0; q < mesh.vertices.size(); ++q)
            if (q != s[0] && q != s[1] && wanted(s, q) && distance(q, s[0]) < 2 * distance(s[0], s[1]))
                count += oracle::diametral_power_test(weighted(mesh, s[0]), weighted(mesh, s[1]), weighted(mesh, q)) == Sign::positive;
    return count;
}

inline std::size_t count_encroached(const TetMesh& mesh) {
    return count_encroached(mesh, [](const auto&, std::size_t) { return true; });
}

/// What refinement makes of the domain, slivers and all.
inline TetMesh almost_good_mesh(const Plc& plc, double edge_length, std::uint64_t seed = 0) {
    MeshOptions options;
    options.slivers = SliverStrategy::none;
    options.quality.min_dihedral_angle_deg = 0;
    options.size.edge_length = edge_length;
    options.seed = seed;
    return generate(plc, options).mesh;
}

}  // namespace wellmesh::testing
