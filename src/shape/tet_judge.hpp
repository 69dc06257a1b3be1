// SPDX-License-Identifier: Apache-2.0
// How bad a tetrahedron is to the shape stage: by its smallest dihedral angle, and where asked by its aspect ratio too, if it keeps the
// bounds that refinement established.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "conforming/conforming_mesh.hpp"
#include "quality/shape_lanes.hpp"
#include "quality/tet_shape.hpp"
#include "sizing/size_field.hpp"

namespace wellmesh {

/// Badness is the cosine of the smallest dihedral angle, larger is worse; kNoAngleCosine is worst of all.
class TetJudge {
public:
    TetJudge(const ConformingMesh& mesh, const SizeField& sizes, double max_radius_edge)
        : mesh_(mesh), sizes_(sizes), squared_radius_edge_(max_radius_edge * max_radius_edge) {}

    /// The same judge for a view of the mesh.
    TetJudge(const ConformingMesh& view, const TetJudge& whole)
        : mesh_(view), sizes_(whole.sizes_), squared_radius_edge_(whole.squared_radius_edge_), goal_(whole.goal_), max_aspect_(whole.max_aspect_) {}

    /// From now on the goal is this cosine, and a circumradius over inradius of at most `max_aspect`: beyond that a tetrahedron is as bad as
    /// kAspectWeight (aspect / max_aspect - 1) above the goal.
    void set_goal(double cosine, double max_aspect) {
        goal_ = cosine;
        max_aspect_ = max_aspect;
    }
    [[nodiscard]] double goal() const { return goal_; }

    /// Badness of abcd, a tetrahedron of `cell`; kNoAngleCosine if it is flat or inverted, its radius-edge ratio or volume exceeds the
    /// bound, or its circumradius exceeds kSizeTolerance times the bound.
    [[nodiscard]] double badness(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, CellId cell) const {
        const Vec3 u = b - a, v = c - a, w = d - a;
        const Vec3 vw = cross(v, w), wu = cross(w, u), uv = cross(u, v);
        const double det = dot(u, vw);
        if (!(det > 0)) return kNoAngleCosine;
        const double lu = squared_norm(u), lv = squared_norm(v), lw = squared_norm(w);
        const double squared_radius = squared_norm(lu * vw + lv * wu + lw * uv) / (4 * det * det);
        const double squared_edge = std::min({lu, lv, lw, squared_norm(v - u), squared_norm(w - u), squared_norm(w - v)});
        if (!(squared_radius <= squared_radius_edge_ * squared_edge)) return kNoAngleCosine;
        const TetSize size = sizes_.of(a, b, c, d, cell);
        if (squared_radius > kSizeTolerance * kSizeTolerance * size.max_squared_circumradius ||
            det > 6 * size.max_volume)
            return kNoAngleCosine;
        const std::array<Vec3, 4> normals{cross(d - b, c - b), vw, wu, uv};
        return std::max(max_cos_of_normals(normals), aspect_badness(squared_radius / (det * det), normals));
    }
    /// Is badness() of abcd certainly more than this cosine by one of its angles? Without a division or a root, for those that fail: most do.
    [[nodiscard]] static bool is_surely_worse(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double cosine) {
        if (!(cosine > 0 && cosine < 1)) return false;
        const std::array<Vec3, 4> n = inward_face_normals(a, b, c, d);
        if (!(dot(b - a, n[1]) > 0)) return true;
        const std::array<double, 4> q{squared_norm(n[0]), squared_norm(n[1]), squared_norm(n[2]), squared_norm(n[3])};
        const double bound = kMargin * cosine * cosine;
        const auto below = [&](std::size_t i, std::size_t j) {
            const double s = -dot(n[i], n[j]), square = s * s;
            return s > 0 && square > kLeastCertain && square > bound * (q[i] * q[j]);
        };
        return below(0, 1) || below(0, 2) || below(0, 3) || below(1, 2) || below(1, 3) || below(2, 3);
    }
    [[nodiscard]] double badness(TetId t) const {
        const auto& c = mesh_.tets().corners(t);
        return badness(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]), mesh_.cell(t));
    }
    /// Is t within the bounds of the size field, whatever its shape?
    [[nodiscard]] bool keeps_size(TetId t) const {
        const auto& k = mesh_.tets().corners(t);
        const TetSize size = sizes_.of(mesh_.point(k[0]), mesh_.point(k[1]), mesh_.point(k[2]), mesh_.point(k[3]), mesh_.cell(t));
        const Vec3 &a = mesh_.point(k[0]), u = mesh_.point(k[1]) - a, v = mesh_.point(k[2]) - a, w = mesh_.point(k[3]) - a;
        const double det = determinant(u, v, w);
        return squared_norm(scaled_circumcentre(u, v, w)) <= 4 * det * det * kSizeTolerance * kSizeTolerance * size.max_squared_circumradius && det <= 6 * size.max_volume;
    }
    [[nodiscard]] bool keeps_radius_edge(TetId t) const {
        const auto& k = mesh_.tets().corners(t);
        const Vec3 &a = mesh_.point(k[0]), u = mesh_.point(k[1]) - a, v = mesh_.point(k[2]) - a, w = mesh_.point(k[3]) - a;
        const double det = determinant(u, v, w);
        const double squared_edge = std::min({squared_norm(u), squared_norm(v), squared_norm(w), squared_norm(v - u), squared_norm(w - u), squared_norm(w - v)});
        return squared_norm(scaled_circumcentre(u, v, w)) <= 4 * det * det * squared_radius_edge_ * squared_edge;
    }
    /// Badness of the shape alone, bounds or not.
    [[nodiscard]] double shape_badness(TetId t) const {
        const auto& k = mesh_.tets().corners(t);
        const Vec3 &a = mesh_.point(k[0]), &b = mesh_.point(k[1]), &c = mesh_.point(k[2]), &d = mesh_.point(k[3]);
        const double cosine = max_cos_dihedral(a, b, c, d);
        if (cosine > goal_ || max_aspect_ == kNoAspect) return cosine;
        const Vec3 u = b - a, v = c - a, w = d - a;
        const double det = determinant(u, v, w), scaled = squared_norm(scaled_circumcentre(u, v, w)), fourth = 4 * det * det * det * det;
        // In tiny domains that power is zero, or too coarse.
        return std::max(cosine, aspect_badness(is_certain(fourth) ? scaled / fourth : scaled / (4 * det * det) / (det * det), inward_face_normals(a, b, c, d)));
    }
    /// Do edges and volume alone show that no dihedral angle has a larger cosine than this, which is positive? The sine at an edge is 6 V times its length over
    /// four times the product of the areas beside it, neither of them larger than an equilateral triangle of the longest edge. They do up to 35 degrees for
    /// a lattice's tetrahedra.
    [[nodiscard]] static bool has_even_edges(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double cosine) {
        const Vec3 u = b - a, v = c - a, w = d - a;
        const std::array<double, 6> squares{squared_norm(u), squared_norm(v), squared_norm(w), squared_norm(v - u), squared_norm(w - u), squared_norm(w - v)};
        const double shortest = std::min({squares[0], squares[1], squares[2], squares[3], squares[4], squares[5]});
        const double longest = std::max({squares[0], squares[1], squares[2], squares[3], squares[4], squares[5]});
        const double det = determinant(u, v, w), least = (1 - cosine) * (1 + cosine) * (longest * longest) * (longest * longest);
        return det > 0 && cosine > 0 && least > kLeastCertain && (16.0 / 9) * (det * det) * shortest > kMargin * least;
    }
    /// Is shape_badness(t) certainly at most the goal? Without a division or a root, for those that are good: most are.
    [[nodiscard]] bool is_surely_good(TetId t) const {
        const auto& k = mesh_.tets().corners(t);
        const Vec3 &a = mesh_.point(k[0]), &b = mesh_.point(k[1]), &c = mesh_.point(k[2]), &d = mesh_.point(k[3]);
        if (max_aspect_ == kNoAspect && has_even_edges(a, b, c, d, goal_)) return true;
        const std::array<Vec3, 4> n = inward_face_normals(a, b, c, d);
        const double det = dot(b - a, n[1]), fourth = (det * det) * (det * det);
        if (!(det > 0 && is_certain(fourth) && goal_ > 0)) return false;
        const std::array<double, 4> q{squared_norm(n[0]), squared_norm(n[1]), squared_norm(n[2]), squared_norm(n[3])};
        const double bound = goal_ * goal_ / kMargin;
        const auto above = [&](std::size_t i, std::size_t j) {
            const double s = -dot(n[i], n[j]);
            return s <= 0 || s * s <= bound * (q[i] * q[j]);
        };
        if (!(above(0, 1) && above(0, 2) && above(0, 3) && above(1, 2) && above(1, 3) && above(2, 3))) return false;
        // As in aspect_badness().
        return max_aspect_ == kNoAspect || kMargin * squared_norm(scaled_circumcentre(b - a, c - a, d - a)) * (q[0] + q[1] + q[2] + q[3]) <= fourth * (max_aspect_ * max_aspect_);
    }
    /// The same of one of several that were measured at once, and where asked that it keeps the radius-edge ratio, too.
    [[nodiscard]] bool is_surely_good(const SquaredShapes& s, std::size_t lane, bool keeps_radius_edge) const {
        const double six = s.six_volumes[lane], fourth = (six * six) * (six * six);
        if (!(may_trust(s, lane) && six > 0 && goal_ > 0 && s.largest_cosine[lane] < goal_ * goal_ - kLaneSlack)) return false;
        if (keeps_radius_edge && !(s.radius_edge[lane] < squared_radius_edge_ * (1 - kLaneSlack))) return false;
        // As in aspect_badness().
        return max_aspect_ == kNoAspect ||
               (is_certain(fourth) && (1 + kLaneSlack) * s.scaled_radius[lane] * (s.areas[0][lane] + s.areas[1][lane] + s.areas[2][lane] + s.areas[3][lane]) <= fourth * (max_aspect_ * max_aspect_));
    }
    /// Cosine of the smallest dihedral angle, nothing else.
    [[nodiscard]] double cosine(TetId t) const {
        const auto& c = mesh_.tets().corners(t);
        return max_cos_dihedral(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]));
    }
    [[nodiscard]] bool counts(TetId t) const { return mesh_.tets().is_finite(t) && mesh_.in_domain(t); }

    static constexpr double kNoAspect = std::numeric_limits<double>::infinity();

private:
    /// Far beyond rounding; and where products, of two squared areas or so, leave the range of doubles nothing is certain.
    static constexpr double kMargin = 1 + 1e-12, kLeastCertain = 1e-280;
    static bool is_certain(double product) { return product > kLeastCertain && product < 1 / kLeastCertain; }

    /// An aspect ratio half above its bound counts as three degrees below an angle of 30: angles come first.
    static constexpr double kAspectWeight = 0.05;

    /// @param squared_radius_by_det  (R / (6 V))^2; the inradius is 6 V over the sum of the normals' lengths.
    [[nodiscard]] double aspect_badness(double squared_radius_by_det, const std::array<Vec3, 4>& normals) const {
        if (max_aspect_ == kNoAspect) return 0;
        const std::array<double, 4> squares{squared_norm(normals[0]), squared_norm(normals[1]), squared_norm(normals[2]), squared_norm(normals[3])};
        // The sum of four lengths is at most twice the root of the sum of their squares: no root is needed for most.
        if (squared_radius_by_det * 4 * (squares[0] + squares[1] + squares[2] + squares[3]) <= max_aspect_ * max_aspect_) return 0;
        const double aspect = std::sqrt(squared_radius_by_det) * (std::sqrt(squares[0]) + std::sqrt(squares[1]) + std::sqrt(squares[2]) + std::sqrt(squares[3]));
        if (aspect <= max_aspect_) return 0;
        return std::min(goal_ * (1 + kAspectWeight * (aspect / max_aspect_ - 1)), 1.0);
    }

    const ConformingMesh& mesh_;
    const SizeField& sizes_;
    double squared_radius_edge_, goal_ = 1, max_aspect_ = kNoAspect;
};

}  // namespace wellmesh
