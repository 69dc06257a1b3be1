// SPDX-License-Identifier: Apache-2.0
// Where pieces touch, cross or come closer than the reach of their pool without sharing a vertex there.
#pragma once

#include <unordered_map>
#include <utility>
#include <vector>

#include "repair/cut_triangle.hpp"
#include "repair/pieces.hpp"

namespace wellmesh {

/// What must be done so that pieces share vertices and edges where they meet. New vertices are in the pool already.
struct Contacts {
    std::unordered_map<EdgeKey, std::vector<std::uint32_t>> on_edge;  ///< vertices inside edges, from the lower end to the higher one
    std::vector<std::vector<std::uint32_t>> inside;                   ///< for each triangle, vertices in its interior
    std::vector<std::vector<CutLine>> lines;                          ///< for each triangle, edges that it must contain
    [[nodiscard]] bool empty() const { return is_empty; }
    bool is_empty = true;
};

/// Pairs in which nothing is fresh are not looked at. Vertices near an edge or triangle are put on it; edges near each other get a common vertex
/// where they are closest; edges that pierce a triangle, which is decided exactly, get one there. Two triangles that have two such vertices
/// in common, or corners and such, must both contain the line between them.
/// After a call that finds nothing, pieces meet in common vertices and edges only: every intersection is one of the cases above.
/// `splits` are edges that one of their triangles has led through a vertex: the others must follow, wherever it is.
[[nodiscard]] Contacts find_contacts(Pieces& pieces, const EdgeSplits& splits);

}  // namespace wellmesh
