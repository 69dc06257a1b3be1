// SPDX-License-Identifier: Apache-2.0
// Extremes and histogram of shape over sets of tetrahedra.
#pragma once

#include <cstdint>
#include <vector>

#include "quality/tet_shape.hpp"
#include "wellmesh/certificate.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh {

/// Adds tetrahedra one by one. Edge lengths are not its business: see measure_edges.
class ShapeAccumulator {
public:
    void add(const TetShape& shape);
    /// All fields but the three of the edges. Without a tetrahedron every field is 0.
    [[nodiscard]] ShapeStatistics result() const;

private:
    ShapeStatistics extremes_;
};

/// What a tetrahedron counts as in statistics.
enum class TetClass : std::uint8_t { left_out, interior, boundary };

/// Fills min_edge, mean_edge and max_edge of the three statistics: each edge counts once in `all`, and once in each of `interior` and
/// `boundary` that has a tetrahedron at it. O(n) time on graded meshes, 24 bytes a tetrahedron of scratch memory.
/// @pre `classes` has one entry a tetrahedron, and the corners of those not left out are valid vertex numbers.
void measure_edges(const TetMesh& mesh, const std::vector<TetClass>& classes, ShapeStatistics& all, ShapeStatistics& interior, ShapeStatistics& boundary);

}  // namespace wellmesh
