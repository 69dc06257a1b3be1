// SPDX-License-Identifier: Apache-2.0
// Why a run ends without a mesh, where no stage says so itself.
#pragma once

#include <cstddef>

#include "core/run_guard.hpp"
#include "validation/valid_plc.hpp"
#include "wellmesh/certificate.hpp"
#include "wellmesh/error.hpp"
#include "wellmesh/options.hpp"
#include "wellmesh/plc.hpp"

namespace wellmesh {

/// @param given  a mesh to start from is given. @throws MeshError{bad_options} that tells all that is wrong
void require_valid_options(const MeshOptions& options, bool given);

/// @throws MeshError{bad_input} for sizes at vertices that are no sizes.
void check_vertex_sizes(const Plc& plc);

/// Were facets merged within a rounding that the source's format has and doubles don't?
[[nodiscard]] bool may_unmerge(const MeshOptions& options, const Plc& plc);
/// The coplanar tolerance of coordinates that were doubles all along.
[[nodiscard]] double rounding_of_doubles(const Plc& plc);

/// An input may conform without any new vertex, and have more than were allowed.
/// @throws MeshError{budget_exhausted}
void require_room(const Limits& limits, std::size_t vertices, Stage stage);

/// A size that asks for more than a mesh can hold is told at once, not when memory ends. A limit of the user's may end the run before.
/// @param expected  vertices. @throws MeshError{mesh_too_large}
void refuse_hopeless(const Limits& limits, double expected);

/// Vertices that may be spent on gaps between features of the input: the user's limit, or else ten times what the mesh has anyway; gaps that would take more
/// are left. @param vertices  of the conforming mesh, or of the input  @param for_size  that the sizes ask for
[[nodiscard]] double most_for_gaps(const Limits& limits, double vertices, double for_size = 0);

/// Whether a claim about anything but goals is.
[[nodiscard]] bool is_refuted(const Certificate& certificate);

/// Delaunay, conforming and Gabriel hold or the run fails; shape and size are asked and achieved instead.
/// @throws MeshError{internal_invariant}
void fail_if_refuted(const Certificate& certificate);

/// Names the sharpest angle, which is the likely reason, also where it was the user's limit that ended the run.
/// @pre the input has acute features.
[[nodiscard]] MeshError acute_failure(const ValidPlc& plc, const MeshError& cause, const RunGuard& guard);

}  // namespace wellmesh
