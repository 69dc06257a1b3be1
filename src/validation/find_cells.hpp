// SPDX-License-Identifier: Apache-2.0
// The cells into which the triangles cut space, found without seeds.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "validation/line_query.hpp"
#include "validation/working_complex.hpp"

namespace wellmesh {

struct CellMap {
    std::vector<std::uint32_t> cell_of_side;  ///< 2 for each triangle, see SideId; cell 0 is the outer one
    std::vector<double> volume;               ///< of each cell, input units cubed; infinite for the outer one
    std::vector<std::vector<SideId>> sides;   ///< of each cell, ascending
    [[nodiscard]] std::size_t size() const { return volume.size(); }
};

/// Sorts the triangles about each edge by angle and glues facing sides; pieces that share no edge are then placed into each other
/// by lines through them. All decisions are exact. Bounded cells are numbered by their lexicographically smallest corner.
/// @pre triangles meet only in common vertices and edges (no self-intersection).
[[nodiscard]] CellMap find_cells(std::span<const Vec3> points, std::span<const SoupTriangle> triangles, const EdgeTable& edges, const LineQuery& lines);

/// Winding number of each cell, 0 outside.
/// @param weights  by how much each triangle winds about what lies behind its front: how often it is stated, less how often turned over
/// @return nothing where weights contradict each other: they do not sum to zero about some edge
[[nodiscard]] std::optional<std::vector<int>> winding_numbers(const CellMap& map, std::span<const int> weights);

/// The corners (3 t + slot) at `edge` in counter-clockwise order about the direction from edge_ends(key)[0] to [1]. Exact.
[[nodiscard]] std::vector<std::uint32_t> radial_order(std::span<const Vec3> points, std::span<const SoupTriangle> triangles, const EdgeTable& edges, std::size_t edge);

/// The side of the triangle at `corner` that faces the next triangle in radial_order, and the one that faces the previous one.
struct FacingSides {
    SideId next = 0, previous = 0;
};
[[nodiscard]] FacingSides facing_sides(std::span<const SoupTriangle> triangles, const EdgeTable& edges, std::uint32_t corner);

}  // namespace wellmesh
