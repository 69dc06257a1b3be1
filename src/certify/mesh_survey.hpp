// SPDX-License-Identifier: Apache-2.0
// Faces, edges and shapes of all tetrahedra.
#pragma once

#include <cstdint>
#include <vector>

#include "certify/edge_lengths.hpp"
#include "certify/mesh_faces.hpp"
#include "certify/shape_survey.hpp"
#include "certify/suspect_mesh.hpp"
#include "certify/tets_by_corner.hpp"

namespace wellmesh::certifying {

struct MeshSurvey {
    FaceSurvey faces;
    std::vector<std::uint8_t> on_constraint;  ///< one flag a vertex: whether it is a corner of a constraint triangle
    ShapeSurvey shapes;                       ///< at the boundary is what has such a corner
    EdgeLengths edges;
};

/// @param exempt  ascending.
[[nodiscard]] MeshSurvey survey_mesh(const SuspectMesh& mesh, const TetsByCorner& stars, const std::vector<ShapeBound>& bounds,
                                     const std::vector<std::uint64_t>& exempt);

}  // namespace wellmesh::certifying
