// SPDX-License-Identifier: Apache-2.0
// Does the mesh fill the PLC, with its facets, segments and vertices? All distances are rounded; tolerances are relative to the PLC's diagonal.
#pragma once

#include <vector>

#include "certify/mesh_faces.hpp"
#include "certify/suspect_mesh.hpp"
#include "certify/tets_by_corner.hpp"
#include "certify/vertex_places.hpp"
#include "wellmesh/certificate.hpp"
#include "wellmesh/plc.hpp"

namespace wellmesh::certifying {

/// A mesh and what was found out about it.
struct SurveyedMesh {
    const SuspectMesh& mesh;
    const TetsByCorner& stars;
    const VertexPlaces& places;
    const std::vector<ConstraintTriangle>& triangles;
};

/// Appends plc_distance, plc_area, plc_vertices, plc_segments, plc_isolated_vertices, plc_filled, holes_empty
/// and region_volumes, and sets plc_volume of the regions.
///
/// What all claims but plc_filled forgive: parts of the PLC that are neither near a constraint triangle nor inside the mesh (they bound only
/// cells that are not filled). Triangles of facets are judged by their centroids, vertices by themselves, segments by the facets they are on and by
/// their midpoints. Volumes: the mesh's region is the sum of its tetrahedra; the PLC's is the divergence theorem over those triangles of
/// the PLC's facets that have the region on one side only, where the side is that of the constraint triangle nearest to the
/// triangle's centroid. The two sums share no term.
/// @param plc  nullptr: the claims are appended as not checked.
void append_plc_claims(const SurveyedMesh& surveyed, const CertifyOptions& options, const Plc* plc, Certificate& certificate);

}  // namespace wellmesh::certifying
