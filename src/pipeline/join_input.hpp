// SPDX-License-Identifier: Apache-2.0
// Input that is refused for nothing but gaps within its own rounding: closed, and everything named as the input names it.
#pragma once

#include <optional>
#include <string>

#include "repair/join_thin.hpp"
#include "validation/valid_plc.hpp"
#include "wellmesh/options.hpp"
#include "wellmesh/result.hpp"

namespace wellmesh {

/// Empty if something else is wrong with the input, if what is too thin can't be joined, or if that does not make a valid complex. What rounding could
/// explain is closed then, and the coordinates of the result count as exact: without options.coplanar_tolerance it is valid.
[[nodiscard]] std::optional<JoinedPlc> join_input(const Plc& plc, const MeshOptions& options, bool assumed_single_precision = false);

/// The same with the rounding that coordinates have which were single precision once, and have been moved since.
[[nodiscard]] Plc as_if_single_precision(const Plc& plc);

/// "2 gaps thinner than ... were closed: vertex 9 (line 13) at (...) and ..."
[[nodiscard]] std::string describe(const JoinStatistics& joined, const Plc& plc);

/// Facets by the numbers of the input. Vertices that were made keep theirs, after the input's own.
void name_facets(ValidPlc& valid, const JoinedPlc& joined);

/// Carriers and exemptions by the numbers of the input: a vertex that was made lies on a segment or, if there is none, on a facet.
void name_vertices(MeshResult& result, const JoinedPlc& joined, const Plc& plc);

}  // namespace wellmesh
