// SPDX-License-Identifier: Apache-2.0
// Takes the vertices of a mesh that any tool made for the vertices of a conforming mesh: each gets the input vertex, segment or facet that it
// lies on, is moved onto it where the mesh's own rounding left it beside, and all are triangulated together. What is Delaunay of the given
// tetrahedra comes back, as the triangulation is a function of its points; what isn't is replaced.
#pragma once

#include "conforming/conforming_mesh.hpp"
#include "wellmesh/result.hpp"

namespace wellmesh {

/// How far a boundary vertex of the mesh may be off the input, in input units: what the certificate allows a subface (1e-9 of the diagonal),
/// or what the rounding of either does, if that is more: 16 ulp of the largest coordinate, and what the text of the files lost.
[[nodiscard]] double adoption_tolerance(const TetMesh& mesh, const Plc& plc);

/// @return  the Delaunay triangulation of the mesh's and the input's vertices, those with their carriers; nothing is labelled yet, and the
///          carrier of vertices off the boundary is any cell: see settle_regions().
/// @throws MeshError  bad_input, coordinate_range as inspect_given_mesh(); bad_input that names the vertices (from 1) on the hull of the mesh
///          that lie on no facet, or the faces of the hull that do not, or the input vertices that are missing, if the volumes differ.
[[nodiscard]] ConformingMesh adopt_mesh(const TetMesh& mesh, const ValidPlc& plc, double tolerance, GivenMeshStatistics& statistics, const Checkpoint& checkpoint = {});

/// Once the cells of tetrahedra are known: gives vertices off the boundary the cell that they lie in.
/// @throws MeshError{bad_input}  naming the place, if one lies outside the domain.
void settle_regions(ConformingMesh& mesh);

}  // namespace wellmesh
