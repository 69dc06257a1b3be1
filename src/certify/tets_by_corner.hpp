// SPDX-License-Identifier: Apache-2.0
// Where faces and edges are looked up: at their lowest vertex.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "certify/suspect_mesh.hpp"

namespace wellmesh::certifying {

/// The corners of a tetrahedron in ascending order.
struct AscendingTet {
    std::array<std::uint32_t, 4> v;
    bool odd;  ///< an odd permutation of those of the mesh: if these are distinct, orient3d changes its sign

    explicit AscendingTet(const std::array<std::uint32_t, 4>& corners) : v(corners), odd(false) {
        order(0, 1), order(2, 3), order(0, 2), order(1, 3), order(1, 2);
    }

private:
    void order(std::size_t i, std::size_t j) {
        const std::uint32_t a = v[i], b = v[j];
        v[i] = a < b ? a : b;
        v[j] = a < b ? b : a;
        odd ^= a > b;
    }
};

/// For every vertex the tetrahedra with a face or an edge of which it is the lowest corner: those of which it is the lowest corner, then those of which
/// it is the second, then the third; ascending in each, so that which comes next is no surprise to the processor.
/// O(n), 12 bytes a tetrahedron and 24 a vertex; while being made 12 more a vertex and thread, up to eight of them.
class TetsByCorner {
public:
    explicit TetsByCorner(const SuspectMesh& mesh);
    [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t v) const {
        return {tets_.data() + first_[3 * std::size_t{v}], static_cast<std::size_t>(first_[3 * std::size_t{v} + 3] - first_[3 * std::size_t{v}])};
    }
    /// Those of all vertices, one vertex after the other.
    [[nodiscard]] std::span<const std::uint32_t> of_all() const { return tets_; }

private:
    std::vector<std::uint64_t> first_;  // in tets_, of those of which vertex i / 3 is corner i % 3
    std::vector<std::uint32_t> tets_;
};

/// How many vertices, each with its tetrahedra, make a piece of work.
inline constexpr std::size_t kVertexGrain = std::size_t{1} << 11;

/// Is the ascending edge one of a tetrahedron?
[[nodiscard]] bool has_edge(const SuspectMesh& mesh, const TetsByCorner& stars, const Edge& edge);

}  // namespace wellmesh::certifying
