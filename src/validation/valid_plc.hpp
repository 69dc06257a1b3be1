// SPDX-License-Identifier: Apache-2.0
// The checked input: cells of dimension 0 to 3 that meet only in shared cells. Only validate() makes one.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/checkpoint.hpp"
#include "core/ids.hpp"
#include "wellmesh/diagnosis.hpp"
#include "wellmesh/plc.hpp"

namespace wellmesh {

struct SourceNumbers;

/// Input 1-cell between two vertices, with no vertex in its interior.
struct ValidSegment {
    std::array<VertexId, 2> ends{};
    std::vector<FacetId> facets;  ///< facets whose closure contains it, ascending
    std::int32_t marker = 0;
};

/// Input 2-cell: a connected piece of a plane, possibly with holes, slits and points inside.
struct ValidFacet {
    std::vector<SegmentId> segments;  ///< on its boundary and (slits) inside it
    std::vector<VertexId> vertices;   ///< every input vertex on it, boundary and isolated ones, ascending
    /// Triangles over `vertices` that cover the facet and respect its segments, all counter-clockwise about `normal`.
    std::vector<std::array<VertexId, 3>> triangles;
    Vec3 origin{};                  ///< a point of the fitted plane, near the facet
    Vec3 normal{};                  ///< unit length
    Vec3 axis_u{}, axis_v{};        ///< unit vectors of the plane; (axis_u, axis_v, normal) is right-handed
    double tolerance = 0;           ///< bound on the distance of the facet's input vertices from the plane, input units
    std::array<CellId, 2> cells{};  ///< the cell on the side that `normal` points to, and the one behind
    std::uint32_t source_facet = 0; ///< lowest number, from 0, of the input facets that were merged into it
    std::int32_t marker = 0;
};

/// Input 3-cell.
struct ValidCell {
    bool filled = false;     ///< part of the domain
    std::int32_t region = 0; ///< reference of its tetrahedra; 0 when not filled
    double max_volume = 0;   ///< from its region seed; <= 0: none
    double volume = 0;       ///< input units cubed; infinite for the outer cell
    Vec3 inside{};           ///< a point strictly inside (filled cells)
};

/// Two features that meet at less than 90 degrees.
struct AcuteFeature {
    EntityKind kind = EntityKind::vertex;  ///< vertex: two segments (or segment and facet) at it; segment: two facets at it
    std::uint32_t id = 0;                  ///< VertexId or SegmentId value
    double angle_deg = 0;
};

class ValidPlc {
public:
    std::vector<Vec3> vertices;                ///< bit-distinct; only vertices that some cell uses
    std::vector<std::uint32_t> source_vertex;  ///< for each, the first input vertex number (from 0) that it stands for
    std::vector<std::int32_t> vertex_markers;  ///< empty, or one a vertex
    std::vector<double> vertex_sizes;          ///< empty, or one a vertex; 0: none
    std::vector<VertexId> isolated_vertices;   ///< on no segment and no facet, inside a filled cell
    std::vector<ValidSegment> segments;
    std::vector<ValidFacet> facets;
    std::vector<ValidCell> cells;              ///< cells[0] is the outer, unbounded one
    std::vector<AcuteFeature> acute_features;  ///< sorted by angle
    double coplanar_tolerance = 0;             ///< largest facet tolerance
    Diagnosis diagnosis;                       ///< notes and warnings; no errors

private:
    friend struct ValidPlcBuilder;  // src/validation/validate.cpp
    ValidPlc() = default;
};

/// @throws MeshError{bad_input | coordinate_range} whose message lists every error found.
/// @param checkpoint  passed between the checks and, of those that may take long, between pieces.
/// @param source  what the diagnosis calls the entities of `plc`; null: by their own numbers. source_vertex and source_facet are numbers of `plc` all the same.
[[nodiscard]] ValidPlc validate(const Plc& plc, const MeshOptions& options = {}, const Checkpoint& checkpoint = {}, const SourceNumbers* source = nullptr);

}  // namespace wellmesh
