// SPDX-License-Identifier: Apache-2.0
#include "pipeline/certify_result.hpp"

#include <algorithm>

#include "core/vec3_math.hpp"
#include "pipeline/extract_mesh.hpp"
#include "pipeline/theory_run.hpp"

namespace wellmesh {
namespace {

double input_extent(const Plc& plc) {
    Vec3 lo, hi;
    bounding_box(plc.vertices, lo, hi);
    return std::hypot(hi.x - lo.x, hi.y - lo.y, hi.z - lo.z);
}

}  // namespace

CertifyOptions certificate_bounds(MeshResult& result, const MeshOptions& options, const Plc& plc, const ValidPlc& valid, const std::stop_token& stop) {
    CertifyOptions bounds;
    bounds.max_radius_edge_ratio = options.quality.max_radius_edge_ratio;
    if (options.quality.min_dihedral_angle_deg > 0) bounds.min_dihedral_angle_deg = options.quality.min_dihedral_angle_deg;
    bounds.min_dihedral_boundary_deg = options.quality.min_dihedral_boundary_deg;
    bounds.max_volume = options.size.max_volume;
    bounds.stop = stop;
    bounds.threads = options.threads;
    for (const Exemption& e : result.exemptions) bounds.exempt.push_back(e.tet);
    if (const double sigma0 = paper_constants(options).sigma0; sigma0 > 0) bounds.min_sigma = sigma0;
    bounds.min_sigma_boundary = options.paper.sigma0_boundary;
    const double extent = input_extent(plc);
    // Beyond the defaults only by what the input's own rounding did: the facets' tolerance, and the bend that it makes in the mesh.
    bounds.tolerance = std::max(bounds.tolerance, 4 * valid.coplanar_tolerance / extent);
    if (result.statistics.joined) bounds.tolerance = std::max(bounds.tolerance, 1.01 * result.statistics.joined->largest_move / extent + 4 * valid.coplanar_tolerance / extent);
    if (4 * valid.coplanar_tolerance > 1e-12 * extent) bounds.flat_angle_rad = std::max(bounds.flat_angle_rad, 1.01 * largest_bend_rad(result.mesh));
    result.statistics.certificate_tolerance = bounds.tolerance;
    result.statistics.certificate_flat_angle_rad = bounds.flat_angle_rad;
    return bounds;
}

}  // namespace wellmesh
