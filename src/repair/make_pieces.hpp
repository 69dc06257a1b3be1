// SPDX-License-Identifier: Apache-2.0
// An input as triangles and segments over merged vertices.
#pragma once

#include <span>

#include "repair/pieces.hpp"
#include "wellmesh/plc.hpp"

namespace wellmesh {

struct StatedPieces {
    explicit StatedPieces(double reach) : pieces(reach) {}
    Pieces pieces;
    std::vector<std::uint32_t> of_input;  ///< pool vertex of each input vertex; kUnusable where its coordinates are
    std::vector<char> facet_changed;      ///< for each input facet, whether its polygons no longer say what its pieces are
    static constexpr std::uint32_t kUnusable = static_cast<std::uint32_t>(-1);
};

/// Merges vertices within `reach`, leaves out what has unusable vertices, and triangulates facets that are not triangles; edges of theirs that cross get
/// a vertex there. A facet that is not planar becomes the triangles that it has in its best plane.
[[nodiscard]] StatedPieces make_pieces(const Plc& plc, double reach);

/// Turns triangles so that neighbours run in opposite directions along their common edge, wherever exactly two triangles meet: in each connected part,
/// the smaller area is turned. Parts that have no orientation are left alone.
void orient_consistently(StatedPieces& stated);

}  // namespace wellmesh
