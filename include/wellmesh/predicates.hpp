// SPDX-License-Identifier: Apache-2.0
// Exact geometric predicates on stored doubles.
#pragma once

#include <cstdint>

#include "wellmesh/vec3.hpp"

namespace wellmesh {

enum class Sign : std::int8_t { negative = -1, zero = 0, positive = 1 };
[[nodiscard]] constexpr Sign operator-(Sign s) { return static_cast<Sign>(-static_cast<int>(s)); }

/// Sign of det(b - a, c - a, d - a): positive iff d lies on the side of plane abc from which a, b, c turn counter-clockwise
/// when seen from the *other* side, i.e. (a, b, c, d) is a positive tetrahedron. Zero iff the four points are coplanar.
[[nodiscard]] Sign orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Positive iff e lies strictly inside the circumsphere of the positive tetrahedron (a, b, c, d); zero iff on it.
[[nodiscard]] Sign insphere(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e);

/// Positive iff p lies strictly inside the diametral sphere of segment ab.
[[nodiscard]] Sign side_of_diametral_sphere(const Vec3& a, const Vec3& b, const Vec3& p);

/// Positive iff p lies strictly inside the equatorial sphere of triangle abc (smallest sphere through its corners' circumcircle).
/// @pre a, b, c are not collinear.
[[nodiscard]] Sign side_of_equatorial_sphere(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);

/// A point with a weight, the square of the radius of a ball about it: lengths squared. May be negative; only differences count.
struct WeightedPoint {
    Vec3 point;
    double weight = 0;
};

// The power of p with respect to the sphere about c of radius r is |p - c|^2 - r^2; p is orthogonal to the sphere if that is its weight,
// and *in conflict* with it if it is less. With equal weights, in conflict is strictly inside.

/// Positive iff e is in conflict with the sphere orthogonal to the positive tetrahedron (a, b, c, d), i.e. iff the four are no tetrahedron of
/// the weighted Delaunay triangulation of the five; zero iff it is orthogonal.
[[nodiscard]] Sign power_test(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& d, const WeightedPoint& e);

/// Positive iff p is in conflict with the smallest sphere that is orthogonal to a and b. @pre a, b are not at one place.
[[nodiscard]] Sign diametral_power_test(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& p);

/// Positive iff p is in conflict with the smallest sphere that is orthogonal to a, b and c. @pre a, b, c are not collinear.
[[nodiscard]] Sign equatorial_power_test(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& p);

}  // namespace wellmesh
