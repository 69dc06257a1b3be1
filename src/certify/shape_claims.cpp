// SPDX-License-Identifier: Apache-2.0
#include "certify/shape_claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "quality/shape_statistics.hpp"
#include "quality/tet_shape.hpp"

namespace wellmesh::certifying {
namespace {

/// One bound: which value, which way.
struct Bound {
    ClaimBuilder claim;
    std::optional<double> limit;
    bool upper;
    double TetShape::* value;
    const char* words;
    double ShapeStatistics::* achieved;
    enum class Where : std::uint8_t { everywhere, interior, boundary } where = Where::everywhere;

    void look(const SuspectMesh& mesh, std::size_t tet, const TetShape& shape, bool touches_boundary) {
        if (!limit || (where != Where::everywhere && touches_boundary != (where == Where::boundary))) return;
        claim.checked(1);
        const double have = shape.*value;
        if (upper ? have <= *limit : have >= *limit) return;
        claim.violated(EntityKind::tetrahedron, tet + 1, mesh.tet_centroid(tet), [&] { return fmt::format("{} {:.6g}, bound {:g}", words, have, *limit); });
    }
};

std::vector<bool> vertices_on(const SuspectMesh& mesh, const std::vector<ConstraintTriangle>& triangles) {
    std::vector<bool> on_constraint(mesh.vertex_count(), false);
    for (const ConstraintTriangle& t : triangles)
        for (const std::uint32_t v : t.v) on_constraint[v] = true;
    return on_constraint;
}

/// @param exempt  ascending.
template <class Look>
void measure(const SuspectMesh& mesh, const std::vector<ConstraintTriangle>& triangles, const std::vector<std::uint64_t>& exempt, Certificate& certificate, Look&& look) {
    const std::vector<bool> on_constraint = vertices_on(mesh, triangles);
    ShapeAccumulator all, interior, boundary, unexempt;
    auto next_exempt = exempt.begin();
    std::vector<TetClass> classes(mesh.tet_count(), TetClass::left_out);
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        if (!mesh.positive(t)) continue;
        const auto& v = mesh.mesh().tets[t];
        const TetShape shape = shape_of(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3]));
        const bool touches = on_constraint[v[0]] || on_constraint[v[1]] || on_constraint[v[2]] || on_constraint[v[3]];
        classes[t] = touches ? TetClass::boundary : TetClass::interior;
        all.add(shape);
        (touches ? boundary : interior).add(shape);
        while (next_exempt != exempt.end() && *next_exempt < t) ++next_exempt;
        if (next_exempt != exempt.end() && *next_exempt == t) continue;
        unexempt.add(shape);
        look(t, shape, touches);
    }
    certificate.all = all.result();
    certificate.interior = interior.result();
    certificate.boundary = boundary.result();
    certificate.unexempt = unexempt.result();
    measure_edges(mesh.mesh(), classes, certificate.all, certificate.interior, certificate.boundary);
}

/// What an input angle forces is at the boundary: between two cells of the input.
Claim claim_exemptions(const SuspectMesh& mesh, const std::vector<ConstraintTriangle>& triangles, const std::vector<std::uint64_t>& exempt) {
    ClaimBuilder claim("exemptions", "Every tetrahedron that is exempt from the bounds has two vertices on constraint triangles or listed subsegments.");
    if (exempt.empty()) return claim.undecided("none is exempt");
    std::vector<bool> on_constraint = vertices_on(mesh, triangles);
    for (const auto& edge : mesh.mesh().subsegments)
        for (const std::uint32_t v : edge)
            if (v < on_constraint.size()) on_constraint[v] = true;
    claim.checked(exempt.size());
    for (const std::uint64_t t : exempt) {
        if (t >= mesh.tet_count()) {
            claim.violated(EntityKind::tetrahedron, t + 1, Vec3{}, [&] { return fmt::format("there are only {} tetrahedra", mesh.tet_count()); });
            continue;
        }
        const auto& v = mesh.mesh().tets[t];
        const auto on = std::count_if(v.begin(), v.end(), [&](std::uint32_t c) { return on_constraint[c]; });
        if (on < 2) claim.violated(EntityKind::tetrahedron, t + 1, mesh.tet_centroid(t), [&] { return fmt::format("{} of its vertices are", on); });
    }
    return claim.decided();
}

}  // namespace

void measure_shapes(const SuspectMesh& mesh, const std::vector<ConstraintTriangle>& triangles, Certificate& certificate) {
    measure(mesh, triangles, {}, certificate, [](std::size_t, const TetShape&, bool) {});
}

void append_shape_claims(const SuspectMesh& mesh, const std::vector<ConstraintTriangle>& triangles, const CertifyOptions& options, Certificate& certificate) {
    using S = ShapeStatistics;
    using Where = Bound::Where;
    const Where angles = options.min_dihedral_boundary_deg ? Where::interior : Where::everywhere, sigmas = options.min_sigma_boundary ? Where::interior : Where::everywhere;
    std::vector<Bound> bounds{
        {{"radius_edge", "Every tetrahedron's circumradius is at most the bound times its shortest edge."}, options.max_radius_edge_ratio, true, &TetShape::radius_edge,
         "radius-edge ratio", &S::max_radius_edge_ratio},
        {{"dihedral", "Every dihedral angle is at least the bound."}, options.min_dihedral_angle_deg, false, &TetShape::min_dihedral_deg, "smallest dihedral angle [deg]",
         &S::min_dihedral_angle_deg, angles},
        {{"aspect_ratio", "Every tetrahedron's circumradius is at most the bound times its inradius."}, options.max_aspect_ratio, true, &TetShape::aspect, "aspect ratio",
         &S::max_aspect_ratio},
        {{"sigma", "Every tetrahedron's volume is at least the bound times the cube of its shortest edge."}, options.min_sigma, false, &TetShape::sigma, "sigma", &S::min_sigma,
         sigmas},
        {{"max_volume", "Every tetrahedron's volume is at most the bound."}, options.max_volume, true, &TetShape::volume, "volume", &S::max_volume},
    };
    if (options.min_dihedral_boundary_deg)
        bounds.push_back({{"dihedral_boundary", "Every dihedral angle of a tetrahedron at the boundary is at least its own bound."}, options.min_dihedral_boundary_deg, false,
                          &TetShape::min_dihedral_deg, "smallest dihedral angle [deg]", &S::min_dihedral_angle_deg, Where::boundary});
    if (options.min_sigma_boundary)
        bounds.push_back({{"sigma_boundary", "The volume of every tetrahedron at the boundary is at least its own bound times the cube of its shortest edge."},
                          options.min_sigma_boundary, false, &TetShape::sigma, "sigma", &S::min_sigma, Where::boundary});
    measure(mesh, triangles, options.exempt, certificate, [&](std::size_t t, const TetShape& shape, bool touches_boundary) {
        for (Bound& b : bounds) b.look(mesh, t, shape, touches_boundary);
    });
    for (Bound& b : bounds) {
        const ShapeStatistics& s = b.where == Where::everywhere ? certificate.unexempt : b.where == Where::interior ? certificate.interior : certificate.boundary;
        b.claim.note(fmt::format("{} {:.6g}", b.upper ? "largest" : "smallest", s.*(b.achieved)));
        certificate.claims.push_back(b.limit ? b.claim.decided() : b.claim.undecided("no bound given"));
    }
    certificate.claims.push_back(claim_exemptions(mesh, triangles, options.exempt));
}

}  // namespace wellmesh::certifying
