// SPDX-License-Identifier: Apache-2.0
// The complex while it is being repaired: triangles and segments over one pool of vertices, each of which knows what it is a piece of.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "repair/edge_chain.hpp"
#include "repair/vertex_pool.hpp"
#include "wellmesh/repair.hpp"

namespace wellmesh {

/// A triangle as the input states it, before anything moved.
struct SourceTriangle {
    std::array<Vec3, 3> p{};
    std::uint32_t facet = 0;  ///< input facet
};

struct Piece {
    std::array<std::uint32_t, 3> v{};  ///< turns as its source does
    std::uint32_t source = 0;          ///< into Pieces::sources
    int winding = 1;                   ///< copies that turn as it does minus copies that turn the other way
    bool fresh = true;                 ///< may touch something that nobody has looked at yet
};

struct WirePiece {
    std::array<std::uint32_t, 2> v{};
    std::uint32_t owner = 0;  ///< input segment, or facet whose polygon it belongs to
    bool stated = true;       ///< a segment of the input; otherwise an edge of a polygon, which must stay a segment
    bool fresh = true;
};

struct Pieces {
    explicit Pieces(double reach) : pool(reach) {}
    VertexPool pool;
    std::vector<SourceTriangle> sources;
    std::vector<Piece> triangles;
    std::vector<WirePiece> wires;
    std::vector<std::uint32_t> lone;       ///< vertices that must be kept though nothing may use them
    std::uint32_t first_fresh_vertex = 0;  ///< this and later ones nobody has looked at yet
    bool join_needles = true;              ///< whether a triangle that touches itself, being lower than the reach, is a contact
    RepairActions actions;
};

/// Merges triangles with the same corners (the windings add up) and wires with the same ends.
void merge_copies(Pieces& pieces);

}  // namespace wellmesh
