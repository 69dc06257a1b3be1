// SPDX-License-Identifier: Apache-2.0
#include "refinement/circumsphere.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/vec3_math.hpp"
#include "predicates/exact_range.hpp"
#include "predicates/expansion.hpp"
#include "quality/tet_shape.hpp"

namespace wellmesh {
namespace {

/// Rounding moves the determinant by less than 16 ulp of the cubed longest edge, 2e-15 of it, and the numerator by as little of its own
/// largest term: from this part on ten digits are right.
constexpr double kWellShaped = 2e-5;

using Difference = std::array<Expansion<2>, 3>;

/// Exact, scaled as in predicates/exact_range.hpp.
Difference difference(const Vec3& from, const Vec3& to) {
    const auto scaled = [](double x, double y) {
        return Expansion<2>(two_difference(x * kDifferenceScale, y * kDifferenceScale));
    };
    return {scaled(to.x, from.x), scaled(to.y, from.y), scaled(to.z, from.z)};
}

auto exact_dot(const Difference& p, const Difference& q) { return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]; }

using Minor = Expansion<16>;
std::array<Minor, 3> exact_cross(const Difference& p, const Difference& q) {
    return {p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]};
}

}  // namespace

bool is_thin(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Vec3 u = b - a, v = c - a, w = d - a;
    const double squared_longest = std::max({squared_norm(u), squared_norm(v), squared_norm(w), squared_norm(v - u), squared_norm(w - u), squared_norm(w - v)});
    return !(determinant(u, v, w) > kThinVolume * squared_longest * std::sqrt(squared_longest));
}

Circumsphere exact_circumsphere(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Difference u = difference(a, b), v = difference(a, c), w = difference(a, d);
    const auto vw = exact_cross(v, w), wu = exact_cross(w, u), uv = exact_cross(u, v);
    const auto lu = exact_dot(u, u), lv = exact_dot(v, v), lw = exact_dot(w, w);
    const double determinant = (u[0] * vw[0] + u[1] * vw[1] + u[2] * vw[2]).estimate();
    Circumsphere sphere;
    sphere.six_volumes = determinant / (kDifferenceScale * kDifferenceScale * kDifferenceScale);
    if (determinant == 0) {
        sphere.radius = std::numeric_limits<double>::infinity();
        return sphere;
    }
    const auto component = [&](std::size_t k) { return (lu * vw[k] + lv * wu[k] + lw * uv[k]).estimate() / determinant / (2 * kDifferenceScale); };
    const Vec3 offset{component(0), component(1), component(2)};
    sphere.centre = a + offset;
    sphere.radius = norm(offset);
    return sphere;
}

Circumsphere careful_circumsphere(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Vec3 u = b - a, v = c - a, w = d - a;
    const double determinant_uvw = determinant(u, v, w);
    const double squared_longest = std::max({squared_norm(u), squared_norm(v), squared_norm(w), squared_norm(v - u), squared_norm(w - u), squared_norm(w - v)});
    if (!(determinant_uvw > kWellShaped * squared_longest * std::sqrt(squared_longest))) return exact_circumsphere(a, b, c, d);
    const Vec3 offset = (1 / (2 * determinant_uvw)) * scaled_circumcentre(u, v, w);
    return {a + offset, norm(offset), determinant_uvw};
}

}  // namespace wellmesh
