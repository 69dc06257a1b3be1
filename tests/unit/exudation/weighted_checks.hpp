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

/// Is vertex q in conflict with the sphere orthogonal to the tetrahedron? By long doubles where they are sure, else by big integers.
inline bool in_conflict(const TetMesh& mesh, const std::array<std::uint32_t, 4>& tet, std::size_t q) {
    using Long = long double;
    std::array<std::array<Long, 4>, 4> rows{};
    Long magnitude = 1;
    const WeightedPoint e = weighted(mesh, q);
    for (std::size_t i = 0; i < 4; ++i) {
        const WeightedPoint p = weighted(mesh, tet[i]);
        const Long x = Long{p.point.x} - Long{e.point.x}, y = Long{p.point.y} - Long{e.point.y}, z = Long{p.point.z} - Long{e.point.z};
        rows[i] = {x, y, z, x * x + y * y + z * z - (Long{p.weight} - Long{e.weight})};
        magnitude *= std::abs(x) + std::abs(y) + std::abs(z) + std::sqrt(std::abs(rows[i][3]));
    }
    // Gaussian elimination with full pivoting over the 4 x 4 determinant, which is negative in conflict.
    Long value = -1;
    auto m = rows;
    for (std::size_t k = 0; k < 4; ++k) {
        std::size_t pr = k, pc = k;
        for (std::size_t i = k; i < 4; ++i)
            for (std::size_t j = k; j < 4; ++j)
                if (std::abs(m[i][j]) > std::abs(m[pr][pc])) pr = i, pc = j;
        if (pr != k) { std::swap(m[pr], m[k]); value = -value; }
        if (pc != k) { for (auto& row : m) std::swap(row[pc], row[k]); value = -value; }
        value *= m[k][k];
        if (m[k][k] == 0) break;
        for (std::size_t i = k + 1; i < 4; ++i) {
            const Long by = m[i][k] / m[k][k];
            for (std::size_t j = k; j < 4; ++j) m[i][j] -= by * m[k][j];
        }
    }
    Long longest = 0;
    for (const auto& row : rows) longest = std::max(longest, std::sqrt(std::abs(row[3])));
    if (std::abs(value) > 1e-12L * magnitude * longest) return value > 0;
    return oracle::power_test({weighted(mesh, tet[0]), weighted(mesh, tet[1]), weighted(mesh, tet[2]), weighted(mesh, tet[3]), e}) == Sign::positive;
}

/// Tetrahedra with a vertex of the mesh in conflict. All pairs: for small meshes.
inline std::size_t count_conflicts(const TetMesh& mesh) {
    std::size_t count = 0;
    for (const auto& tet : mesh.tets) {
        bool found = false;
        for (std::size_t q = 0; q < mesh.vertices.size() && !found; ++q)
            found = std::find(tet.begin(), tet.end(), q) == tet.end() && in_conflict(mesh, tet, q);
        count += found;
    }
    return count;
}

/// Constraint triangles and edges (listed ones) with a vertex in conflict with their smallest orthogonal sphere, by big integers.
inline std::size_t count_encroached(const TetMesh& mesh) {
    std::size_t count = 0;
    const auto near = [&](std::size_t q, std::uint32_t a, double reach) {
        const Vec3 &p = mesh.vertices[q], &s = mesh.vertices[a];
        return std::hypot(p.x - s.x, p.y - s.y, p.z - s.z) < reach;
    };
    const auto longest = [&](std::uint32_t a, std::uint32_t b) {
        const Vec3 &p = mesh.vertices[a], &s = mesh.vertices[b];
        return std::hypot(p.x - s.x, p.y - s.y, p.z - s.z);
    };
    for (const auto& [a, b, c] : mesh.subfaces) {
        const double reach = 3 * std::max({longest(a, b), longest(b, c), longest(c, a)});
        for (std::size_t q = 0; q < mesh.vertices.size(); ++q)
            if (q != a && q != b && q != c && near(q, a, reach))
                count += oracle::equatorial_power_test(weighted(mesh, a), weighted(mesh, b), weighted(mesh, c), weighted(mesh, q)) == Sign::positive;
    }
    for (const auto& [a, b] : mesh.subsegments)
        for (std::size_t q = 0; q < mesh.vertices.size(); ++q)
            if (q != a && q != b && near(q, a, 3 * longest(a, b)))
                count += oracle::diametral_power_test(weighted(mesh, a), weighted(mesh, b), weighted(mesh, q)) == Sign::positive;
    return count;
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
