// SPDX-License-Identifier: Apache-2.0
// Mends an input within a stated distance, and says what was done.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>

#include "wellmesh/diagnosis.hpp"
#include "wellmesh/plc.hpp"

namespace wellmesh {

struct RepairOptions {
    /// What comes closer than this is joined: vertices are merged, edges and facets are led through vertices and edges nearby. Nothing of the
    /// result is farther than twice this from the input. Input units; at least least_repair_tolerance(). Default: default_repair_tolerance().
    std::optional<double> tolerance{};
    /// Leave out facets between two filled cells, so that overlapping or touching solids become one body without walls inside.
    bool drop_inner_facets = false;
    /// MeshOptions::coplanar_tolerance of the run that the result is meant for; decides about the diagnosis of the result only.
    std::optional<double> coplanar_tolerance{};
};

/// How often each thing was done. Zero throughout: the result is the input.
struct RepairActions {
    std::uint64_t unusable_dropped = 0;         ///< facets and segments that name a vertex that is missing, not finite or out of range
    std::uint64_t vertices_merged = 0;
    std::uint64_t unused_vertices_dropped = 0;  ///< of surface files only: in a complex that is no surface they are points to keep
    std::uint64_t degenerate_dropped = 0;       ///< triangles without area, or lower than the tolerance
    std::uint64_t duplicates_dropped = 0;       ///< triangles that repeat others
    std::uint64_t folds_dropped = 0;            ///< pairs of opposite triangles that enclose nothing
    std::uint64_t inner_dropped = 0;            ///< triangles between filled cells, if asked for
    std::uint64_t facets_turned = 0;
    std::uint64_t vertices_joined_to_edges = 0;   ///< edges split at a vertex that lay on them
    std::uint64_t vertices_joined_to_facets = 0;  ///< facets split at a vertex that lay on them
    std::uint64_t intersection_points = 0;        ///< new vertices
    std::uint64_t facets_cut = 0;                 ///< facets that were split into several triangles for any of these reasons
};

struct RepairResult {
    Plc plc;               ///< valid iff !diagnosis.has_errors(); the input itself unless `resolved`
    Diagnosis diagnosis;   ///< of `plc`
    RepairActions actions;
    double tolerance = 0;         ///< that was used, input units
    double max_displacement = 0;  ///< largest distance of a point of the result from the facet, segment or vertex that it stems from
    Vec3 displaced_most{};        ///< where that is
    unsigned rounds = 0;          ///< of joining and cutting, the last without finding anything
    bool resolved = false;        ///< whether a round found nothing more to do; otherwise given up
    /// One or several sentences: what was done; what is left to do, and why it was left.
    std::string summary;
};

/// Rounding of the source or 1e-8 of the bounding box' diagonal, whichever is more, and never less than least_repair_tolerance().
[[nodiscard]] double default_repair_tolerance(const Plc& plc);

/// 64 units in the last place of the largest coordinate: what is closer cannot be told from rounding.
[[nodiscard]] double least_repair_tolerance(const Plc& plc);

/// Merges vertices within the tolerance, drops degenerate and duplicate facets, splits edges and facets at vertices on them, cuts
/// intersecting facets along their intersections and orients closed surfaces consistently. Closes no gap wider than the tolerance and invents no facet.
/// Vertices that need not move keep their bits and their order; facets that nothing touches are kept as stated.
/// @throws MeshError{bad_options} for a tolerance that is out of range, {bad_input} if no facet or segment is usable, {cancelled}.
[[nodiscard]] RepairResult repair(const Plc& plc, const RepairOptions& options = {}, const std::stop_token& stop = {});

}  // namespace wellmesh
