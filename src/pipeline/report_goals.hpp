// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/run_guard.hpp"
#include "core/workers.hpp"
#include "validation/valid_plc.hpp"
#include "wellmesh/options.hpp"
#include "wellmesh/result.hpp"

namespace wellmesh {

/// Fills result.goals and, where no budget ended the run, result.termination from the finished mesh and its certificate.
/// @param sizes  what report_sizes() says of goals that differ from place to place
void report_goals(MeshResult& result, const MeshOptions& options, const ValidPlc& plc, const std::vector<AskedAchieved>& sizes, Workers& workers);

/// What ended a run.
[[nodiscard]] Termination termination(RunGuard::Verdict verdict);

}  // namespace wellmesh
