// SPDX-License-Identifier: Apache-2.0
// Cuts a triangle, or triangulates a polygon, along lines that may cross each other.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "repair/vertex_pool.hpp"

namespace wellmesh {

/// A line in a triangle, and the number of the triangle (or wire) that it is the intersection with.
struct CutLine {
    std::array<std::uint32_t, 2> ends{};
    std::uint32_t with = 0;
};

/// Where three triangles meet: computed once, whichever of them is cut first, because for almost coplanar ones the three answers differ.
using TriplePoints = std::map<std::array<std::uint32_t, 3>, std::uint32_t>;

/// What to triangulate, in numbers of the pool.
struct CutTask {
    std::vector<std::array<std::uint32_t, 2>> border;
    /// Whether the result is what the border runs about, so and so often, which makes triangles that were cut fit together again; otherwise it is all
    /// that can't be reached from outside, or from a hole, without crossing a border or a line.
    bool only_border_encloses = false;
    std::vector<CutLine> lines;
    std::uint32_t self = 0;  ///< number of the triangle
    std::vector<std::uint32_t> points;
    std::vector<Vec3> holes;
    Vec3 normal{};  ///< of the plane; the results turn counter-clockwise about it
};

struct CutResult {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<int> windings;                          ///< of the border about each triangle, not 0; empty unless only_border_encloses
    std::vector<std::array<std::uint32_t, 2>> lines;    ///< border and lines, in pieces
    struct Split {
        std::array<std::uint32_t, 2> edge{};
        std::uint32_t inside = 0;
    };
    std::vector<Split> splits;                          ///< of border and lines, in the order made
    std::vector<std::array<std::uint32_t, 2>> stacked;  ///< pairs of vertices on top of each other, of which only the first is used
};

/// Lines that cross get a vertex of the pool where they do; lines that pass a vertex within half the pool's reach lead through it. Triangulations
/// of the same vertices and lines are the same: among equally good diagonals that of the vertex with the lowest number is taken, so that
/// overlapping triangles fall into the same pieces.
[[nodiscard]] CutResult cut(CutTask task, VertexPool& pool, TriplePoints& triples);

/// The border of a triangle whose edges lead through further vertices; parts where it runs back into itself cancel. Empty if nothing is left.
[[nodiscard]] std::vector<std::array<std::uint32_t, 2>> border_of(std::vector<std::uint32_t> loop);

}  // namespace wellmesh
