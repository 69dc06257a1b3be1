// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "wellmesh/certificate.hpp"
#include "wellmesh/diagnosis.hpp"
#include "wellmesh/error.hpp"
#include "wellmesh/exemption.hpp"
#include "wellmesh/invariants.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh {

enum class Termination { goals_met, goals_unmet, vertex_budget_reached, time_budget_reached, memory_budget_reached, cancelled };
[[nodiscard]] const char* to_string(Termination termination) noexcept;

/// A goal, what was asked, what the mesh has.
struct AskedAchieved {
    std::string goal;  ///< e.g. "min dihedral angle [deg]"
    double asked = 0, achieved = 0;
    bool met = true;
    std::uint64_t elements_missed = 0;
    std::vector<ElementRef> worst{};  ///< a few elements that missed it
};

struct StageTime {
    Stage stage = Stage::read;
    double seconds = 0;
    std::uint64_t vertices_after = 0, tets_after = 0;
};

/// What improve() found in the mesh that it was given, and did to it before shape work began.
struct GivenMeshStatistics {
    std::uint64_t vertices = 0, tets = 0;      ///< of the given mesh
    std::uint64_t delaunay_tets = 0;           ///< of these tetrahedra are Delaunay, hence kept
    double min_dihedral_angle_deg = 180;       ///< of these tetrahedra
    double tolerance = 0;                      ///< how far off the input its boundary may be, input units
    double farthest_vertex = 0;                ///< how far it is
    std::uint64_t moved_onto_input = 0;        ///< vertices that were moved onto their input vertex, segment or facet
    std::uint64_t dropped_vertices = 0;        ///< of no tetrahedron, or at the place of another vertex
    std::uint64_t added_input_vertices = 0;    ///< the input has them, the mesh did not
    std::uint64_t added_for_conformity = 0;    ///< until every segment and facet was there, and Gabriel
    std::uint64_t added_for_refinement = 0;    ///< until radius-edge ratio and size were met
};

/// A vertex and what it was joined with, numbered as the source does: both were thinner than the rounding of the coordinates.
struct JoinedFeature {
    ElementRef vertex;
    ElementRef with;      ///< a vertex, or a facet that was led through the vertex
    double distance = 0;  ///< before, input units
};

/// The input's thin places that were closed before it was meshed. Every input vertex stays where it is; facets and segments were led through them.
struct JoinStatistics {
    double tolerance = 0;     ///< only what was nearer than this was joined, input units: the rounding of the input's coordinates
    double largest_move = 0;  ///< no point of a facet or segment went farther than this
    bool assumed_single_precision = false;  ///< nothing says that the coordinates are that coarse, but as they are they could not be conformed to
    std::vector<JoinedFeature> joined;
};

/// Gaps between features of the input without a common point that are so narrow that filling them with tetrahedra within the goals would take far too
/// many. The mesh conforms there, no more; elsewhere it keeps its goals.
struct GapStatistics {
    ElementRef side, other_side;  ///< of the gap that takes most, with a place on each
    double width = 0;             ///< there, input units
    double narrowest = 0;         ///< width of the narrowest one
    double filled_from = 0;       ///< gaps at least this wide are filled
    double vertices = 0;          ///< that filling the others would take, about
    std::uint64_t tets = 0;       ///< that join the sides of such gaps and miss a goal for their shape; they are among the exemptions
};

struct MeshStatistics {
    std::optional<GapStatistics> gaps{};  ///< if any were left
    std::optional<JoinStatistics> joined{};  ///< if anything was
    std::optional<GivenMeshStatistics> given{};  ///< improve() only
    std::vector<StageTime> stages;
    std::vector<CellSummary> cells;  ///< of the input, the unbounded one first
    std::uint64_t input_vertices = 0, segment_vertices = 0, facet_vertices = 0, interior_vertices = 0;
    std::uint64_t moved_vertices = 0, removed_vertices = 0;
    std::uint64_t weighted_vertices = 0;      ///< with a weight above 0: then the mesh is weighted Delaunay
    std::uint64_t guarded_insertions = 0;     ///< refused: would have made an edge below the bound of Theorem 4.2
    std::uint64_t exact_predicate_calls = 0;  ///< decided by expansion arithmetic on the calling thread: depends on how many there are
    double coplanar_tolerance = 0;            ///< the largest local tolerance that was used, input units
    /// What the certificate allowed because the input's own rounding demands it: distance of a subface from its facet, relative to the
    /// diagonal, and bend between two subfaces of one facet. A checker of rounded input needs the same two numbers.
    double certificate_tolerance = 0, certificate_flat_angle_rad = 0;
    std::vector<std::string> notes;           ///< what was merged, dropped or assumed, one sentence each
};

struct MeshResult {
    TetMesh mesh;
    Termination termination = Termination::goals_met;
    Certificate certificate;
    MeshStatistics statistics;
    std::vector<AskedAchieved> goals;
    /// Tetrahedra that goals and certificate leave out: acute angles of the input, or gaps that were left, keep them from a goal of shape; ascending
    std::vector<Exemption> exemptions;
    std::optional<InvariantReport> invariants{};  ///< if MeshOptions ask for it
};

}  // namespace wellmesh
