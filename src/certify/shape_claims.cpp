// SPDX-License-Identifier: Apache-2.0
#include "certify/shape_claims.hpp"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>

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

    void look(const SuspectMesh& mesh, std::size_t tet, const TetShape& shape) {
        if (!limit) return;
        claim.checked(1);
        const double have = shape.*value;
        if (upper ? have <= *limit : have >= *limit) return;
        claim.violated(EntityKind::tetrahedron, tet + 1, mesh.tet_centroid(tet), [&] { return fmt::format("{} {:.6g}, bound {:g}", words, have, *limit); });
    }
};

template <class Look>
void measure(const SuspectMesh& mesh, const std::vector<ConstraintTriangle>& triangles, Certificate& certificate, Look&& look) {
    std::vector<bool> on_constraint(mesh.vertex_count(), false);
    for (const ConstraintTriangle& t : triangles)
        for (const std::uint32_t v : t.v) on_constraint[v] = true;
    ShapeAccumulator all, interior, boundary;
    std::vector<TetClass> classes(mesh.tet_count(), TetClass::left_out);
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        if (!mesh.positive(t)) continue;
        const auto& v = mesh.mesh().tets[t];
        const TetShape shape = shape_of(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3]));
        const bool touches = on_constraint[v[0]] || on_constraint[v[1]] || on_constraint[v[2]] || on_constraint[v[3]];
        classes[t] = touches ? TetClass::boundary : TetClass::interior;
        all.add(shape);
        (touches ? boundary : interior).add(shape);
        look(t, shape);
    }
    certificate.all = all.result();
    certificate.interior = interior.result();
    certificate.boundary = boundary.result();
    measure_edges(mesh.mesh(), classes, certificate.all, certificate.interior, certificate.boundary);
}

}  // namespace

void measure_shapes(const SuspectMesh& mesh, const std::vector<ConstraintTriangle>& triangles, Certificate& certificate) {
    measure(mesh, triangles, certificate, [](std::size_t, const TetShape&) {});
}

void append_shape_claims(const SuspectMesh& mesh, const std::vector<ConstraintTriangle>& triangles, const CertifyOptions& options, Certificate& certificate) {
    std::array<Bound, 5> bounds{{
        {{"radius_edge", "Every tetrahedron's circumradius is at most the bound times its shortest edge."}, options.max_radius_edge_ratio, true, &TetShape::radius_edge, "radius-edge ratio"},
        {{"dihedral", "Every dihedral angle is at least the bound."}, options.min_dihedral_angle_deg, false, &TetShape::min_dihedral_deg, "smallest dihedral angle [deg]"},
        {{"aspect_ratio", "Every tetrahedron's circumradius is at most the bound times its inradius."}, options.max_aspect_ratio, true, &TetShape::aspect, "aspect ratio"},
        {{"sigma", "Every tetrahedron's volume is at least the bound times the cube of its shortest edge."}, options.min_sigma, false, &TetShape::sigma, "sigma"},
        {{"max_volume", "Every tetrahedron's volume is at most the bound."}, options.max_volume, true, &TetShape::volume, "volume"},
    }};
    measure(mesh, triangles, certificate, [&](std::size_t t, const TetShape& shape) {
        for (Bound& b : bounds) b.look(mesh, t, shape);
    });
    const ShapeStatistics& s = certificate.all;
    const std::array<double, 5> achieved{s.max_radius_edge_ratio, s.min_dihedral_angle_deg, s.max_aspect_ratio, s.min_sigma, s.max_volume};
    for (std::size_t i = 0; i < bounds.size(); ++i) {
        bounds[i].claim.note(fmt::format("{} {:.6g}", bounds[i].upper ? "largest" : "smallest", achieved[i]));
        certificate.claims.push_back(bounds[i].limit ? bounds[i].claim.decided() : bounds[i].claim.undecided("no bound given"));
    }
}

}  // namespace wellmesh::certifying
