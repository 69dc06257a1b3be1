// SPDX-License-Identifier: Apache-2.0
// Closes what is thinner than the rounding of the coordinates. Unlike repair(), no vertex moves or vanishes, and every facet knows its source.
#pragma once

#include <optional>
#include <vector>

#include "validation/report.hpp"
#include "wellmesh/plc.hpp"
#include "wellmesh/result.hpp"

namespace wellmesh {

/// An input with its thin places closed. Vertices and facets of the input keep their numbers, new ones follow; a facet that is closed up has no polygon.
struct JoinedPlc {
    Plc plc;
    SourceNumbers source;
    JoinStatistics statistics;
};

/// `plc` as it is, everything its own source.
[[nodiscard]] JoinedPlc nothing_joined(const Plc& plc, double tolerance);

/// Closes what `found`, the diagnosis of joined.plc, calls too thin, and edges within the tolerance:
/// - a facet or an edge near a vertex is led through it;
/// - of vertices with an edge in between, only one keeps its facets; those of the others run into its facets within two lengths of that edge
///   (taper_edges.hpp), so that slits as narrow as that edge, and as long as the model, are shut.
/// False if it can't: then `joined` is of no use. The result is not yet known to be valid.
[[nodiscard]] bool join_thin(JoinedPlc& joined, const Diagnosis& found);

}  // namespace wellmesh
