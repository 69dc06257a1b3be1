// SPDX-License-Identifier: Apache-2.0
#include "certify/edge_lengths.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh::certifying {
namespace {

TEST(MeasureEdges, CountsEachEdgeOnceInEachClass) {
    // Random tetrahedra over few vertices, so that most edges are shared, within and across classes.
    TetMesh mesh;
    for (std::uint64_t v = 0; v < 30; ++v) mesh.vertices.push_back({unit_double(mix64(v, 0)), unit_double(mix64(v, 1)), unit_double(mix64(v, 2))});
    std::vector<TetClass> classes;
    for (std::uint64_t t = 0; t < 200; ++t) {
        std::array<std::uint32_t, 4> tet{};
        for (std::uint64_t k = 0; k < 4; ++k) {
            do tet[k] = static_cast<std::uint32_t>(mix64(t, 100 * k + (++tet[k])) % 30);
            while (std::find(tet.begin(), tet.begin() + static_cast<std::ptrdiff_t>(k), tet[k]) != tet.begin() + static_cast<std::ptrdiff_t>(k));
        }
        mesh.tets.push_back(tet);
        classes.push_back(static_cast<TetClass>(mix64(t, 7) % 3));
    }
    std::array<std::set<std::pair<std::uint32_t, std::uint32_t>>, 3> edges;  // all, interior, boundary
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        if (classes[t] == TetClass::left_out) continue;
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = i + 1; j < 4; ++j) {
                const std::pair<std::uint32_t, std::uint32_t> e = std::minmax(mesh.tets[t][i], mesh.tets[t][j]);
                edges[0].insert(e);
                edges[classes[t] == TetClass::interior ? 1 : 2].insert(e);
            }
    }
    std::array<ShapeStatistics, 3> s;
    const SuspectMesh suspect(mesh);
    measure_edges(suspect, TetsByCorner(suspect), classes).store(s[0], s[1], s[2]);
    for (std::size_t k = 0; k < 3; ++k) {
        double low = 1e300, high = 0, sum = 0;
        for (const auto& [a, b] : edges[k]) {
            const double length = distance(mesh.vertices[a], mesh.vertices[b]);
            low = std::min(low, length), high = std::max(high, length), sum += length;
        }
        EXPECT_GT(edges[k].size(), 100U);
        EXPECT_EQ(s[k].min_edge, low);
        EXPECT_EQ(s[k].max_edge, high);
        EXPECT_NEAR(s[k].mean_edge, sum / static_cast<double>(edges[k].size()), 1e-14);
    }
}

}  // namespace
}  // namespace wellmesh::certifying
