// SPDX-License-Identifier: Apache-2.0
// What a user should know of a run beyond its goals: result.statistics.notes.
#pragma once

#include <string>

#include "validation/valid_plc.hpp"
#include "wellmesh/options.hpp"
#include "wellmesh/plc.hpp"
#include "wellmesh/result.hpp"

namespace wellmesh {

/// What validation found; of the acute features only how many there are and which is the sharpest: surfaces have tens of thousands.
void note_input(MeshResult& result, const MeshOptions& options, const Plc& plc, const ValidPlc& valid);

/// One sentence on the gaps that were left.
[[nodiscard]] std::string describe(const GapStatistics& gaps);

/// Where a mesh was given and the result's smallest angle is smaller than its. @pre the result is certified
void note_lower_angle(MeshResult& result);

}  // namespace wellmesh
