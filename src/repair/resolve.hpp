// SPDX-License-Identifier: Apache-2.0
// Joins and cuts until pieces meet in common vertices and edges only.
#pragma once

#include <stop_token>

#include "repair/make_pieces.hpp"

namespace wellmesh {

struct Resolution {
    bool complete = false;  ///< pieces meet in common vertices and edges only
    unsigned rounds = 0;
};

/// A round finds all contacts of what the last one changed and cuts accordingly. Cutting rounds vertices, and rounding may make new contacts, so it
/// takes some rounds; there is no proof that it ends, hence a limit on rounds and on growth. The reach of the pool holds in the first round,
/// `least_reach` from then on. @throws MeshError{cancelled}
[[nodiscard]] Resolution resolve(StatedPieces& stated, double least_reach, const std::stop_token& stop);

}  // namespace wellmesh
