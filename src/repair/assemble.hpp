// SPDX-License-Identifier: Apache-2.0
// The repaired pieces as an input again.
#pragma once

#include <optional>

#include "repair/make_pieces.hpp"

namespace wellmesh {

/// Counts pieces that are left out. @pre pieces meet in common vertices and edges only.
///
/// Where the facets of a surface file have consistent winding numbers, triangles that together with their opposite enclose nothing and separate nothing
/// are left out, and, if asked for, all that do not separate a filled cell from one that is not.
void drop_idle_pieces(Pieces& pieces, bool drop_inner);

/// `plc` with the pieces for facets. Vertices that need not move keep bits and order; facets that did not change stay as stated.
[[nodiscard]] Plc assemble(const Plc& plc, StatedPieces& stated);

/// The largest distance of a point of the pieces from what it stems from, and of an input vertex from where it went.
struct Displacement {
    double distance = 0;
    Vec3 where{};
    void note(double d, const Vec3& p) {
        if (d > distance) *this = {d, p};
    }
};
[[nodiscard]] Displacement displacement_of(const Plc& plc, const StatedPieces& stated);

}  // namespace wellmesh
