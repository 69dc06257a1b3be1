// SPDX-License-Identifier: Apache-2.0
// Bounds on the shape of positive tetrahedra, and their statistics. Rounded arithmetic.
#pragma once

#include <vector>

#include "certify/mesh_survey.hpp"
#include "certify/suspect_mesh.hpp"
#include "wellmesh/certificate.hpp"

namespace wellmesh::certifying {

/// Sets `all`, `interior`, `boundary` and `unexempt`. Tetrahedra that are not positive are left out.
void store_statistics(const MeshSurvey& survey, Certificate& certificate);

/// What the options ask for, to be surveyed.
[[nodiscard]] std::vector<ShapeBound> wanted_bounds(const CertifyOptions& options);

/// radius_edge, dihedral, aspect_ratio, sigma and max_volume: not checked where no bound is given; and exemptions.
/// The bounds are compared without tolerance with values rounded a few times.
/// @param survey  with wanted_bounds(options).
[[nodiscard]] std::vector<Claim> shape_claims(const SuspectMesh& mesh, const CertifyOptions& options, MeshSurvey&& survey);

}  // namespace wellmesh::certifying
