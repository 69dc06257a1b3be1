// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/workers.hpp"
#include "sizing/size_field.hpp"
#include "validation/valid_plc.hpp"
#include "wellmesh/options.hpp"
#include "wellmesh/result.hpp"

namespace wellmesh {

/// Edge lengths asked and achieved where they differ from place to place: a row a region, one for all of it, and one for the smallest length allowed. Notes
/// in result.statistics say where the input makes shorter edges than that. Reads result.mesh. O(n)
[[nodiscard]] std::vector<AskedAchieved> report_sizes(MeshResult& result, const MeshOptions& options, const ValidPlc& plc, const SizeField& sizes, Workers& workers);

}  // namespace wellmesh
