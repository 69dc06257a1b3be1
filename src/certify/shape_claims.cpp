// SPDX-License-Identifier: Apache-2.0
#include "certify/shape_claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "certify/shape_survey.hpp"
#include "quality/tet_shape.hpp"

namespace wellmesh::certifying {
namespace {

struct BoundClaim {
    const char *name, *statement;
    ShapeBound bound;
    double ShapeStatistics::* achieved;
};

/// What an input angle forces is at the boundary: between two cells of the input.
Claim claim_exemptions(const SuspectMesh& mesh, std::vector<std::uint8_t> on_constraint, const std::vector<std::uint64_t>& exempt) {
    ClaimBuilder claim("exemptions", "Every tetrahedron that is exempt from the bounds has two vertices on constraint triangles or listed subsegments.");
    if (exempt.empty()) return claim.undecided("none is exempt");
    for (const auto& edge : mesh.mesh().subsegments)
        for (const std::uint32_t v : edge)
            if (v < on_constraint.size()) on_constraint[v] = 1;
    claim.checked(exempt.size());
    for (const std::uint64_t t : exempt) {
        if (t >= mesh.tet_count()) {
            claim.violated(EntityKind::tetrahedron, t + 1, Vec3{}, [&] { return fmt::format("there are only {} tetrahedra", mesh.tet_count()); });
            continue;
        }
        const auto& v = mesh.mesh().tets[t];
        const auto on = std::count_if(v.begin(), v.end(), [&](std::uint32_t c) { return on_constraint[c] != 0; });
        if (on < 2) claim.violated(EntityKind::tetrahedron, t + 1, mesh.tet_centroid(t), [&] { return fmt::format("{} of its vertices are", on); });
    }
    return claim.decided();
}

std::vector<BoundClaim> wanted_claims(const CertifyOptions& options) {
    using S = ShapeStatistics;
    using Where = ShapeBound::Where;
    const Where angles = options.min_dihedral_boundary_deg ? Where::interior : Where::everywhere, sigmas = options.min_sigma_boundary ? Where::interior : Where::everywhere;
    constexpr const char *kAngle = "smallest dihedral angle [deg]", *kSigma = "sigma";
    std::vector<BoundClaim> wanted{
        {"radius_edge", "Every tetrahedron's circumradius is at most the bound times its shortest edge.",
         {options.max_radius_edge_ratio, true, &TetShape::radius_edge, "radius-edge ratio"}, &S::max_radius_edge_ratio},
        {"dihedral", "Every dihedral angle is at least the bound.", {options.min_dihedral_angle_deg, false, &TetShape::min_dihedral_deg, kAngle, angles},
         &S::min_dihedral_angle_deg},
        {"aspect_ratio", "Every tetrahedron's circumradius is at most the bound times its inradius.", {options.max_aspect_ratio, true, &TetShape::aspect, "aspect ratio"},
         &S::max_aspect_ratio},
        {"sigma", "Every tetrahedron's volume is at least the bound times the cube of its shortest edge.", {options.min_sigma, false, &TetShape::sigma, kSigma, sigmas},
         &S::min_sigma},
        {"max_volume", "Every tetrahedron's volume is at most the bound.", {options.max_volume, true, &TetShape::volume, "volume"}, &S::max_volume},
    };
    if (options.min_dihedral_boundary_deg)
        wanted.push_back({"dihedral_boundary", "Every dihedral angle of a tetrahedron at the boundary is at least its own bound.",
                          {options.min_dihedral_boundary_deg, false, &TetShape::min_dihedral_deg, kAngle, Where::boundary}, &S::min_dihedral_angle_deg});
    if (options.min_sigma_boundary)
        wanted.push_back({"sigma_boundary", "The volume of every tetrahedron at the boundary is at least its own bound times the cube of its shortest edge.",
                          {options.min_sigma_boundary, false, &TetShape::sigma, kSigma, Where::boundary}, &S::min_sigma});
    return wanted;
}

}  // namespace

void store_statistics(const MeshSurvey& survey, Certificate& certificate) {
    certificate.all = survey.shapes.all;
    certificate.interior = survey.shapes.interior;
    certificate.boundary = survey.shapes.boundary;
    certificate.unexempt = survey.shapes.unexempt;
    survey.edges.store(certificate.all, certificate.interior, certificate.boundary);
}

std::vector<ShapeBound> wanted_bounds(const CertifyOptions& options) {
    std::vector<ShapeBound> bounds;
    for (const BoundClaim& w : wanted_claims(options)) bounds.push_back(w.bound);
    return bounds;
}

std::vector<Claim> shape_claims(const SuspectMesh& mesh, const CertifyOptions& options, MeshSurvey&& survey) {
    using S = ShapeStatistics;
    using Where = ShapeBound::Where;
    ShapeSurvey& shapes = survey.shapes;
    const std::vector<BoundClaim> wanted = wanted_claims(options);
    std::vector<Claim> claims;
    for (std::size_t k = 0; k < wanted.size(); ++k) {
        const auto& [name, statement, bound, achieved] = wanted[k];
        const Where where = bound.where;
        const auto of = [&](const S& everywhere, const S& interior, const S& boundary) -> const S& {
            return where == Where::everywhere ? everywhere : where == Where::interior ? interior : boundary;
        };
        ClaimBuilder claim(name, statement);
        claim.absorb(std::move(shapes.exceedances[k]));
        if (bound.limit) claim.checked(of(shapes.unexempt, shapes.unexempt_interior, shapes.unexempt_boundary).tets);
        claim.note(fmt::format("{} {:.6g}", bound.upper ? "largest" : "smallest", of(shapes.unexempt, shapes.interior, shapes.boundary).*achieved));
        claims.push_back(bound.limit ? claim.decided() : claim.undecided("no bound given"));
    }
    claims.push_back(claim_exemptions(mesh, std::move(survey.on_constraint), options.exempt));
    return claims;
}

}  // namespace wellmesh::certifying
