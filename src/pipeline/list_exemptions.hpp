// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "conforming/acute_exemptions.hpp"
#include "conforming/conforming_mesh.hpp"
#include "wellmesh/exemption.hpp"
#include "wellmesh/options.hpp"

namespace wellmesh {

/// The tetrahedra, in the order of the output, that miss a quality goal and touch an acute feature of the input. Others that miss one are not
/// excused.
[[nodiscard]] std::vector<Exemption> list_exemptions(const ConformingMesh& mesh, const std::vector<TetId>& order, const AcuteExemptions& exemptions, const MeshOptions& options);

}  // namespace wellmesh
