// SPDX-License-Identifier: Apache-2.0
// Bounds on the shape of positive tetrahedra, and their statistics. Rounded arithmetic.
#pragma once

#include <vector>

#include "certify/mesh_faces.hpp"
#include "certify/suspect_mesh.hpp"
#include "wellmesh/certificate.hpp"

namespace wellmesh::certifying {

/// Sets `all`, `interior` and `boundary`. Tetrahedra that are not positive are left out.
void measure_shapes(const SuspectMesh& mesh, const TetsByCorner& stars, const std::vector<ConstraintTriangle>& triangles, Certificate& certificate);

/// The same, and radius_edge, dihedral, aspect_ratio, sigma and max_volume: not checked where no bound is given.
/// The bounds are compared without tolerance with values rounded a few times.
[[nodiscard]] std::vector<Claim> shape_claims(const SuspectMesh& mesh, const TetsByCorner& stars, const std::vector<ConstraintTriangle>& triangles,
                                              const CertifyOptions& options, Certificate& certificate);

}  // namespace wellmesh::certifying
