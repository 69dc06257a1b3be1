// SPDX-License-Identifier: Apache-2.0
// What a sliver is, and which new ones a point may not make.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "conforming/conforming_mesh.hpp"
#include "quality/tet_shape.hpp"

namespace wellmesh {

/// By what slivers are told.
enum class SliverMeasure : std::uint8_t {
    dihedral,  ///< smallest dihedral angle: docs/decisions/0003
    sigma      ///< V / L^3 of [LiTeng01, 2.2]
};

/// A sliver has a radius-edge ratio within its bound, but a measure beyond a threshold; a new one is small, and to be avoided, if its
/// circumradius is below b times that of the element that was split [LiTeng01, 2.2 and 3.1], or below `unit` [Chew97].
struct SliverRule {
    SliverMeasure measure = SliverMeasure::sigma;
    /// Thresholds for tetrahedra inside, and for those with a vertex on the boundary: cosine of the least angle, or least V / L^3.
    double inside = 0, at_boundary = 0;
    double b = 0;
    double unit = 0;          ///< input units; 0: b decides
    unsigned candidates = 1;  ///< tries of a picking region; facets get a half, segments a quarter
    bool centre_first = true;  ///< is the circumcentre the first try inside, or only the last resort?
    bool splits = true;       ///< slivers are bad elements themselves; false: they are only kept from being made

    [[nodiscard]] double threshold(bool touches_boundary) const { return touches_boundary ? at_boundary : inside; }
    [[nodiscard]] double smallness(double radius) const { return unit > 0 ? unit : b * radius; }
    /// By how much abcd is worse than its threshold allows, as a ratio of volumes or of squared sines: above 1 for slivers, larger is worse; 0
    /// for others. @param six_volumes  of abcd. @param squared_edge  of its shortest edge.
    [[nodiscard]] double excess(const Vec3& a, const Vec3& b_, const Vec3& c, const Vec3& d, double six_volumes, double squared_edge, bool touches_boundary) const {
        const double limit = threshold(touches_boundary);
        if (measure == SliverMeasure::dihedral) {
            if (!(limit < 1) || !has_dihedral_below(a, b_, c, d, limit)) return 0;
            const double cosine = max_cos_dihedral(a, b_, c, d);
            return cosine < 1 ? (1 - limit * limit) / (1 - cosine * cosine) : std::numeric_limits<double>::infinity();
        }
        const double least = 6 * limit * squared_edge * std::sqrt(squared_edge);
        return six_volumes < least ? least / six_volumes : 0;
    }
};

/// Inside or near the boundary?
[[nodiscard]] inline bool is_on_boundary(const ConformingMesh& mesh, VertexId v) { return mesh.info(v).carrier != CarrierKind::region; }
[[nodiscard]] inline bool touches_boundary(const ConformingMesh& mesh, const TetStore::Corners& corners) {
    for (const VertexId v : corners)
        if (is_on_boundary(mesh, v)) return true;
    return false;
}

/// Calls f(p, q, r, cell, touches_boundary) for every tetrahedron of the domain that the cavity's point would make with a face pqr, until f
/// returns false. @pre cavity is the last one found. @return did f never?
template <class F>
bool visit_new_star(ConformingMesh& mesh, const Cavity& cavity, const Placement& where, F&& f) {
    const bool inside = where.carrier == CarrierKind::region;
    if (!inside) mesh.plan_insertion(cavity, where);
    for (std::size_t i = 0; i < cavity.boundary.size(); ++i) {
        const BoundaryFace& b = cavity.boundary[i];
        const TetId owner = (!inside && mesh.changes_sides(i) ? b.outside : b.inside).tet();
        if (!mesh.in_domain(owner)) continue;
        const auto c = mesh.tets().face_corners(b.inside);
        if (c[0] == kInfiniteVertex || c[1] == kInfiniteVertex || c[2] == kInfiniteVertex) continue;
        const bool touches = !inside || is_on_boundary(mesh, c[0]) || is_on_boundary(mesh, c[1]) || is_on_boundary(mesh, c[2]);
        if (!f(mesh.point(c[0]), mesh.point(c[1]), mesh.point(c[2]), mesh.cell(owner), touches)) return false;
    }
    return true;
}

}  // namespace wellmesh
