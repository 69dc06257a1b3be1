// SPDX-License-Identifier: Apache-2.0
// What a tetrahedron is worth to the shape stage: its smallest dihedral angle, if it keeps the bounds that refinement established.
#pragma once

#include <algorithm>
#include <vector>

#include "conforming/conforming_mesh.hpp"
#include "quality/tet_shape.hpp"
#include "refinement/sizing.hpp"

namespace wellmesh {

class TetJudge {
public:
    TetJudge(const ConformingMesh& mesh, const std::vector<CellSize>& sizes, double max_radius_edge)
        : mesh_(mesh), sizes_(sizes), squared_radius_edge_(max_radius_edge * max_radius_edge) {}

    /// Cosine of the smallest dihedral angle of abcd, a tetrahedron of `cell`; larger is worse. kNoAngleCosine if it is flat or inverted, its
    /// radius-edge ratio or volume exceeds the bound, or its circumradius exceeds kSizeTolerance times the bound.
    [[nodiscard]] double cosine(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, CellId cell) const {
        const Vec3 u = b - a, v = c - a, w = d - a;
        const Vec3 vw = cross(v, w), wu = cross(w, u), uv = cross(u, v);
        const double det = dot(u, vw);
        if (!(det > 0)) return kNoAngleCosine;
        const double lu = squared_norm(u), lv = squared_norm(v), lw = squared_norm(w);
        const double radius = squared_norm(lu * vw + lv * wu + lw * uv) / (4 * det * det);
        const double edge = std::min({lu, lv, lw, squared_norm(v - u), squared_norm(w - u), squared_norm(w - v)});
        const CellSize& size = sizes_[cell.index()];
        if (!(radius <= squared_radius_edge_ * edge) || radius > kSizeTolerance * kSizeTolerance * size.max_squared_circumradius || det > 6 * size.max_volume)
            return kNoAngleCosine;
        return max_cos_dihedral(a, b, c, d);
    }
    [[nodiscard]] double cosine(TetId t) const {
        const auto& c = mesh_.tets().corners(t);
        return cosine(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]), mesh_.cell(t));
    }
    /// Of the angle alone, bounds or not.
    [[nodiscard]] double angle_cosine(TetId t) const {
        const auto& c = mesh_.tets().corners(t);
        return max_cos_dihedral(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]));
    }
    [[nodiscard]] bool counts(TetId t) const { return mesh_.tets().is_finite(t) && mesh_.in_domain(t); }

private:
    const ConformingMesh& mesh_;
    const std::vector<CellSize>& sizes_;
    double squared_radius_edge_;
};

}  // namespace wellmesh
