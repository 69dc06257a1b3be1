// SPDX-License-Identifier: Apache-2.0
#include "certify/mesh_survey.hpp"

#include <cstddef>
#include <utility>

namespace wellmesh::certifying {
namespace {

/// One flag a vertex: whether it is a corner of one of the triangles.
template <class Triangles, class CornersOf>
std::vector<std::uint8_t> corners_of(const SuspectMesh& mesh, const Triangles& triangles, CornersOf&& corners) {
    std::vector<std::uint8_t> result(mesh.vertex_count(), 0);
    for (const auto& t : triangles)
        for (const std::uint32_t v : corners(t)) result[v] = 1;
    return result;
}

}  // namespace

// What is at the boundary is known when the faces are, but mostly the mesh lists all that is: then one visit of every star does for faces and edges.
MeshSurvey survey_mesh(const SuspectMesh& mesh, const TetsByCorner& stars, const std::vector<ShapeBound>& bounds,
                       const std::vector<std::uint64_t>& exempt) {
    MeshSurvey survey;
    std::vector<std::uint8_t> expected;
    if (mesh.mesh().subfaces.empty()) {  // surely not all of them
        survey.shapes.classes.resize(mesh.tet_count());
        for (std::size_t t = 0; t < mesh.tet_count(); ++t) survey.shapes.classes[t] = mesh.positive(t) ? TetClass::interior : TetClass::left_out;
    } else {
        expected = corners_of(mesh, mesh.mesh().subfaces, [](const Triangle& t) { return t; });
        survey.shapes = survey_shapes(mesh, expected, bounds, exempt);
    }
    survey.faces = survey_faces(mesh, stars, survey.shapes.classes);
    survey.on_constraint = corners_of(mesh, survey.faces.constraints, [](const ConstraintTriangle& t) { return t.v; });
    const bool as_expected = survey.on_constraint == expected;
    if (!as_expected) survey.shapes = survey_shapes(mesh, survey.on_constraint, bounds, exempt);
    survey.edges = as_expected && survey.faces.edges ? *survey.faces.edges : measure_edges(mesh, stars, survey.shapes.classes);
    return survey;
}

}  // namespace wellmesh::certifying
