// SPDX-License-Identifier: Apache-2.0
// Cuts a triangle, or triangulates a polygon, along lines that may cross each other.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "repair/vertex_pool.hpp"

namespace wellmesh {

/// What to triangulate, in numbers of the pool.
struct CutTask {
    std::vector<std::array<std::uint32_t, 2>> border;  ///< what can't be reached from outside without crossing a line belongs to the result
    std::vector<std::array<std::uint32_t, 2>> lines;
    std::vector<std::uint32_t> points;
    std::vector<Vec3> holes;
    Vec3 normal{};  ///< of the plane; the results turn counter-clockwise about it
};

struct CutResult {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::array<std::uint32_t, 2>> lines;    ///< border and lines, in pieces
    std::vector<std::array<std::uint32_t, 2>> stacked;  ///< pairs of vertices on top of each other, of which only the first was used
};

/// Lines that cross get a vertex of the pool where they do; lines that pass a vertex within half the pool's reach lead through it. Triangulations
/// of the same vertices and lines are the same: among equally good diagonals that of the vertex with the lowest number is taken, so that
/// overlapping triangles fall into the same pieces.
[[nodiscard]] CutResult cut(CutTask task, VertexPool& pool);

/// The border of a triangle whose edges lead through further vertices; parts where it runs back into itself cancel. Empty if nothing is left.
[[nodiscard]] std::vector<std::array<std::uint32_t, 2>> border_of(std::vector<std::uint32_t> loop);

}  // namespace wellmesh
