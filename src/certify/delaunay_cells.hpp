// SPDX-License-Identifier: Apache-2.0
// Disjoint tetrahedra by way of their circumspheres: what space_claims.hpp (1) would take long to find where thousands of needles meet.
//
// Let no vertex lie strictly inside the circumsphere of a tetrahedron, for all of them. Lift the vertices to the paraboloid (minus their weights):
// each lifted tetrahedron lies on the lower hull of all lifted vertices. Where two tetrahedra overlap, the hull above an inner point of both is inside
// both lifted ones, and the plane that touches it there is that of either. So they have the same circumsphere, and the same vertices on it. It is
// enough to compare tetrahedra with the same set of vertices on their spheres, of which there are few unless the input is made of such sets.
#pragma once

#include "certify/ball_search.hpp"
#include "certify/suspect_mesh.hpp"

namespace wellmesh::certifying {

/// Whether every tetrahedron is positive and its circumsphere empty (with weights: orthogonal sphere and conflict), and no two on the same sphere
/// overlap: proves that no two overlap at all. False proves nothing. Exact; O(n log n) where few vertices are cospherical.
[[nodiscard]] bool disjoint_as_delaunay(const SuspectMesh& mesh, const BallSearch& search);

}  // namespace wellmesh::certifying
