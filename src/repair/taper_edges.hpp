// SPDX-License-Identifier: Apache-2.0
// Edges within rounding: the slits that begin at them are shut a little way off, where the mesh is still as fine as the edge is short.
#pragma once

#include "repair/join_thin.hpp"

namespace wellmesh {

/// Where edges of at most the tolerance join vertices, the first of them, v, stands for all. A facet from another one, w, to far vertices x and y
/// becomes one from v to x and y, but for its corner: at two lengths of the edge from v, the edges vx and vy get vertices p and q, the facet keeps what is beyond,
/// and the triangle wpq leads back to w. A triangle vwx, as narrow as the edge, becomes vwp. So every vertex stays and nothing is farther than
/// the edge's length from where it was. Edges of few ulp have no room for new vertices and are left alone.
/// @pre vertices are bit-distinct. False if another vertex is in the way.
[[nodiscard]] bool taper_short_edges(JoinedPlc& joined);

/// Without repeated neighbours, and without edges there and back.
void drop_spurs(std::vector<std::uint32_t>& polygon);

}  // namespace wellmesh
