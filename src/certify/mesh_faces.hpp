// SPDX-License-Identifier: Apache-2.0
// The faces of the mesh, found at their lowest vertices: who shares what, and which faces are constraints.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "certify/edge_lengths.hpp"
#include "certify/suspect_mesh.hpp"
#include "certify/tets_by_corner.hpp"

namespace wellmesh::certifying {

struct FaceSurvey {
    std::uint64_t faces = 0, interior_faces = 0, boundary_faces = 0;  ///< distinct; of two or more, and of exactly one tetrahedron
    /// Of exactly two positive tetrahedra: the apex of one is strictly inside the circumsphere of the other (in conflict, with weights).
    std::uint64_t locally_not_delaunay = 0;
    std::uint64_t two_sided_faces = 0;             ///< of exactly two tetrahedra, looked at for `opposite_sides`
    std::vector<ConstraintTriangle> constraints;   ///< ascending by vertices, each triangle once
    Claim face_sharing, opposite_sides, distinct_tets, listed_subfaces_exist;
    std::optional<EdgeLengths> edges;              ///< if the faces are in order everywhere: then it takes no time to speak of
};

/// O(n) time on graded meshes.
/// @param classes  one entry a tetrahedron, left_out those that are not positive.
[[nodiscard]] FaceSurvey survey_faces(const SuspectMesh& mesh, const TetsByCorner& stars, const std::vector<TetClass>& classes);

/// Edges where constraint triangles meet other than as two that are flat together, and all listed ones; ascending, each once.
///
/// Two triangles at an edge are flat together if they bend by less than `flat_angle` radians, or by less than 32 roundings of the
/// largest coordinate seen from the lower of their heights over the edge (rounded Steiner points bend a facet that much).
struct ConstraintSegment {
    Edge v{};                      ///< ascending
    std::uint32_t listed = kNone;  ///< lowest number in TetMesh::subsegments
};
[[nodiscard]] std::vector<ConstraintSegment> find_constraint_segments(const SuspectMesh& mesh, const std::vector<ConstraintTriangle>& triangles, double flat_angle);

/// Listed edges that no tetrahedron has.
[[nodiscard]] Claim claim_listed_subsegments_exist(const SuspectMesh& mesh, const TetsByCorner& stars);

}  // namespace wellmesh::certifying
