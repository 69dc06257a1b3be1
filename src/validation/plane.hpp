// SPDX-License-Identifier: Apache-2.0
// A plane through points that rounding moved, and exact turning in its projection.
#pragma once

#include <array>
#include <span>

#include "wellmesh/predicates.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh {

struct FittedPlane {
    Vec3 origin{};                  ///< near the points' centroid
    Vec3 normal{};                  ///< unit length; its sign is arbitrary
    Vec3 axis_u{}, axis_v{};        ///< unit; (axis_u, axis_v, normal) is right-handed
    double residual = 0;            ///< largest distance of a point
    std::size_t worst = 0;          ///< that point
    double width = 0;               ///< extent of the points across their longest direction; 0 for collinear points

    [[nodiscard]] double distance_of(const Vec3& p) const;  ///< signed
    void flip();
};

/// Least squares in a frame that the points span, so that the relative precision does not suffer from the distance to the origin
/// or from the aspect ratio of the set. Collinear points give some plane through them.
[[nodiscard]] FittedPlane fit_plane(std::span<const Vec3> points);

/// Drops the coordinate along which `normal` is longest. Exact: the kept coordinates are the stored ones.
class PlaneProjection {
public:
    explicit PlaneProjection(const Vec3& normal);
    [[nodiscard]] std::array<double, 2> operator()(const Vec3& p) const {
        const std::array<double, 3> c{p.x, p.y, p.z};
        return {c[first_], c[second_]};
    }

private:
    std::size_t first_ = 0, second_ = 1;
};

/// Positive iff a, b, c turn counter-clockwise. Exact.
[[nodiscard]] Sign orient2d(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& c);

/// True iff a, b, c lie on one line. Exact.
[[nodiscard]] bool collinear(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace wellmesh
