// SPDX-License-Identifier: Apache-2.0
// O(n) self-checks of a triangulation, for tests and self-checking runs.
#pragma once

#include <string>

#include "delaunay/triangulation.hpp"

namespace wellmesh {

/// Empty if opposite() is an involution over equal faces, every finite tetrahedron is positive and vertex_tet is right; else what is wrong.
[[nodiscard]] std::string check_adjacency(const Triangulation& mesh);

/// Empty if every face is locally Delaunay under the perturbed test, hull faces included; else what is wrong.
[[nodiscard]] std::string check_delaunay(const Triangulation& mesh);

}  // namespace wellmesh
