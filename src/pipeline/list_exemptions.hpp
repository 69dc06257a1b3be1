// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "conforming/conforming_mesh.hpp"
#include "refinement/refine.hpp"
#include "wellmesh/exemption.hpp"
#include "wellmesh/options.hpp"

namespace wellmesh {

/// The tetrahedra, in the order of the output, that miss a quality goal and touch an acute feature of the input. Others that miss one are not
/// excused.
/// @param first_number  of vertices in the source's own counting.
[[nodiscard]] std::vector<Exemption> list_exemptions(const ConformingMesh& mesh, const std::vector<TetId>& order, Refiner& refiner, const MeshOptions& options,
                                                     std::uint32_t first_number);

}  // namespace wellmesh
