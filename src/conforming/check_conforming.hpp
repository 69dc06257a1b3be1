// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "conforming/conforming_mesh.hpp"

namespace wellmesh {

/// Empty if labelled edges and faces cover every segment and facet once (lengths and areas to a relative 1e-6), labels agree on both
/// sides of a face and around an edge, cells change only across labelled faces, and (when `gabriel`) no labelled edge or face is
/// encroached; else what is wrong. O(n).
[[nodiscard]] std::string check_conforming(ConformingMesh& mesh, bool gabriel);

}  // namespace wellmesh
