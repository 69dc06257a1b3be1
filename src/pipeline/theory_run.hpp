// SPDX-License-Identifier: Apache-2.0
// What certified mode and --invariants add to a run: constants, the recorder, its report.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "conforming/boundary_refiner.hpp"
#include "refinement/refine.hpp"
#include "theory/run_recorder.hpp"
#include "wellmesh/options.hpp"
#include "wellmesh/result.hpp"

namespace wellmesh {

/// Constants in use: the options', the mode's own where they are empty.
[[nodiscard]] TheoryConstants paper_constants(const MeshOptions& options);
/// What is wrong with them, one sentence each.
[[nodiscard]] std::vector<std::string> check_paper_constants(const MeshOptions& options);

/// Sets the rules of the mode; a recorder if one is asked for. To be called before anything is inserted.
[[nodiscard]] std::unique_ptr<RunRecorder> prepare_theory(const ConformingMesh& mesh, BoundaryRefiner& boundary, const MeshOptions& options);
/// @pre the mesh conforms, nothing was refined yet.
void set_sliver_rule(Refiner& refiner, const MeshOptions& options);
/// Ends the account: detaches the recorder and puts its report into the result. Recorder may be null.
void finish_theory(RunRecorder* recorder, BoundaryRefiner& boundary, MeshResult& result);
/// @throws MeshError{internal_invariant} for a violated claim in certified mode; the existence of points is a goal instead (docs/theory.md).
void judge_invariants(MeshResult& result, const MeshOptions& options);

}  // namespace wellmesh
