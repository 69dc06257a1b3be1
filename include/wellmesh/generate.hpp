// SPDX-License-Identifier: Apache-2.0
// The one entry point.
#pragma once

#include "wellmesh/options.hpp"
#include "wellmesh/plc.hpp"
#include "wellmesh/result.hpp"
#include "wellmesh/run_control.hpp"

namespace wellmesh {

/// Fills `plc` with a Delaunay, boundary-conforming mesh that meets the goals of `options`, and certifies it.
///
/// @return  always a conforming mesh, Delaunay, or weighted Delaunay if it has weights (strategy exude); `termination` and `goals` say
///          which goals it misses, if any.
/// @throws MeshError  bad_input, coordinate_range (with all defects found), bad_options, unsupported_acute,
///                    budget_exhausted or cancelled (before the mesh conformed), internal_invariant.
/// Deterministic; no globals, no output; safe to call from several threads at once.
[[nodiscard]] MeshResult generate(const Plc& plc, const MeshOptions& options = {}, const RunControl& control = {});

}  // namespace wellmesh
