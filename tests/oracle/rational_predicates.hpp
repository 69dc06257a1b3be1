// SPDX-License-Identifier: Apache-2.0
// Slow, obviously right predicates on big numbers, for tests. They share nothing with src/predicates: other formulas, other
// arithmetic, and ties broken by numbers instead of symbols.
//
// Doubles are dyadic rationals; multiplied by a common power of two they are integers, and no sign changes. So the rational
// arithmetic needs no fractions and a million cases fit into a test's time. exact_rational() converts to real fractions.
#pragma once

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>

#include "wellmesh/predicates.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh::oracle {

using Rational = boost::multiprecision::cpp_rational;
/// Unlimited; 512 bits without allocation.
using Integer = boost::multiprecision::number<
    boost::multiprecision::cpp_int_backend<512, 0, boost::multiprecision::signed_magnitude, boost::multiprecision::unchecked,
                                           std::allocator<boost::multiprecision::limb_type>>,
    boost::multiprecision::et_off>;

/// @pre finite.
inline Rational exact_rational(double value) { return Rational(value); }

inline Sign sign_of(const Integer& value) { return value.is_zero() ? Sign::zero : value.sign() > 0 ? Sign::positive : Sign::negative; }

struct Point {
    Integer x, y, z;
};

inline Point operator-(const Point& p, const Point& q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }
inline Integer dot(const Point& p, const Point& q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
inline Point cross(const Point& p, const Point& q) { return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x}; }
inline Integer det(const Point& u, const Point& v, const Point& w) { return dot(u, cross(v, w)); }

/// All points times one power of two that makes every coordinate an integer. @pre finite.
template <std::size_t N>
std::array<Point, N> to_integers(const std::array<Vec3, N>& points) {
    int least = std::numeric_limits<int>::max();  // exponent of the last bit of a 53-bit mantissa
    for (const Vec3& p : points)
        for (const double c : {p.x, p.y, p.z})
            if (c != 0) least = std::min(least, std::ilogb(c) - 52);
    const auto convert = [&](double c) -> Integer {
        if (c == 0) return 0;
        const int exponent = std::ilogb(c) - 52;
        return Integer(static_cast<std::int64_t>(std::ldexp(c, -exponent))) << (exponent - least);
    };
    std::array<Point, N> result;
    for (std::size_t i = 0; i < N; ++i) result[i] = {convert(points[i].x), convert(points[i].y), convert(points[i].z)};
    return result;
}

inline Sign orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const auto p = to_integers<4>({a, b, c, d});
    return sign_of(det(p[1] - p[0], p[2] - p[0], p[3] - p[0]));
}

/// Determinant of the five rows (x, y, z, lift, 1) as lift[i] * cofactor[i], the volumes of the tetrahedra of the other four:
/// the definition of the Delaunay property by lifting. `lift` is |p|^2 unless `rank` is given: then the point of rank r
/// (0: smallest) is lifted by 2^(r k) more units, k so large that each rank outweighs all lower ones together, while one
/// unit of |p|^2 outweighs all ranks.
inline Sign insphere_of_lifts(const std::array<Vec3, 5>& points, const std::array<unsigned, 5>* rank) {
    const auto p = to_integers(points);
    Integer unperturbed = 0, largest = 1;
    std::array<Integer, 5> cofactor;
    for (std::size_t i = 0; i < 5; ++i) {
        std::array<std::size_t, 4> others{};
        for (std::size_t j = 0, n = 0; j < 5; ++j)
            if (j != i) others[n++] = j;
        cofactor[i] = det(p[others[1]] - p[others[0]], p[others[2]] - p[others[0]], p[others[3]] - p[others[0]]);
        if (i % 2 == 1) cofactor[i] = -cofactor[i];
        unperturbed += dot(p[i], p[i]) * cofactor[i];
        if (abs(cofactor[i]) > largest) largest = abs(cofactor[i]);
    }
    // the expansion by the lifts' column: at the positive unit tetrahedron the cofactor of e is positive, and raising e moves
    // it out; so the predicate is minus the sum
    if (rank == nullptr) return -sign_of(unperturbed);
    const unsigned k = static_cast<unsigned>(msb(largest)) + 4;
    Integer perturbed = unperturbed << (6 * k);
    for (std::size_t i = 0; i < 5; ++i) perturbed += cofactor[i] << ((*rank)[i] * k);
    return -sign_of(perturbed);
}

inline Sign insphere(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) {
    return insphere_of_lifts({a, b, c, d, e}, nullptr);
}

/// Ranks by lexicographic order. @pre the points are distinct.
inline Sign insphere_perturbed(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) {
    const std::array<Vec3, 5> points{a, b, c, d, e};
    std::array<unsigned, 5> rank{};
    for (std::size_t i = 0; i < 5; ++i)
        for (const Vec3& q : points) {
            const Vec3& p = points[i];
            if (q.x < p.x || (q.x == p.x && (q.y < p.y || (q.y == p.y && q.z < p.z)))) ++rank[i];
        }
    return insphere_of_lifts(points, &rank);
}

/// |2p - (a + b)|^2 against |a - b|^2.
inline Sign side_of_diametral_sphere(const Vec3& a, const Vec3& b, const Vec3& p) {
    const auto q = to_integers<3>({a, b, p});
    const Point from_centre = (q[2] - q[0]) - (q[1] - q[2]), diameter = q[1] - q[0];
    return sign_of(dot(diameter, diameter) - dot(from_centre, from_centre));
}

/// The circumcentre of abc is a + s / (2 |n|^2): |2 |n|^2 (p - a) - s|^2 against |s|^2.
inline Sign side_of_equatorial_sphere(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
    const auto q = to_integers<4>({a, b, c, p});
    const Point u = q[1] - q[0], v = q[2] - q[0], w = q[3] - q[0], n = cross(u, v);
    const Integer uu = dot(u, u), vv = dot(v, v), twice_nn = 2 * dot(n, n);
    const Point vn = cross(v, n), nu = cross(n, u);
    const Point s{uu * vn.x + vv * nu.x, uu * vn.y + vv * nu.y, uu * vn.z + vv * nu.z};
    const Point from_centre{twice_nn * w.x - s.x, twice_nn * w.y - s.y, twice_nn * w.z - s.z};
    return sign_of(dot(s, s) - dot(from_centre, from_centre));
}

// ---- weighted points: coordinates and weights times one power of two and its square

template <std::size_t N>
struct WeightedIntegers {
    std::array<Point, N> point;
    std::array<Integer, N> weight;
    [[nodiscard]] Integer lift(std::size_t i) const { return dot(point[i], point[i]) - weight[i]; }
};

/// @pre finite.
template <std::size_t N>
WeightedIntegers<N> to_integers(const std::array<WeightedPoint, N>& points) {
    int least = std::numeric_limits<int>::max();
    for (const WeightedPoint& p : points) {
        for (const double c : {p.point.x, p.point.y, p.point.z})
            if (c != 0) least = std::min(least, std::ilogb(c) - 52);
        if (p.weight != 0) least = std::min(least, (std::ilogb(p.weight) - 53) / 2 - 1);
    }
    const auto convert = [&](double c, int unit) -> Integer {
        if (c == 0) return 0;
        const int exponent = std::ilogb(c) - 52;
        return Integer(static_cast<std::int64_t>(std::ldexp(c, -exponent))) << (exponent - unit);
    };
    WeightedIntegers<N> result;
    for (std::size_t i = 0; i < N; ++i) {
        const Vec3& p = points[i].point;
        result.point[i] = {convert(p.x, least), convert(p.y, least), convert(p.z, least)};
        result.weight[i] = convert(points[i].weight, 2 * least);
    }
    return result;
}

/// The definition by lifting, see insphere_of_lifts.
inline Sign power_test(const std::array<WeightedPoint, 5>& points) {
    const auto q = to_integers(points);
    Integer sum = 0;
    for (std::size_t i = 0; i < 5; ++i) {
        std::array<std::size_t, 4> others{};
        for (std::size_t j = 0, n = 0; j < 5; ++j)
            if (j != i) others[n++] = j;
        const Integer cofactor = det(q.point[others[1]] - q.point[others[0]], q.point[others[2]] - q.point[others[0]], q.point[others[3]] - q.point[others[0]]);
        sum += (i % 2 == 0 ? q.lift(i) : Integer(-q.lift(i))) * cofactor;
    }
    return -sign_of(sum);
}

/// The sphere of radius r about c = a + t (b - a) is orthogonal to a and b iff |c - a|^2 - w_a = |c - b|^2 - w_b = r^2; with t = n / m, all times m^2.
inline Sign diametral_power_test(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& p) {
    const auto q = to_integers<3>({a, b, p});
    const Point u = q.point[1] - q.point[0], v = q.point[2] - q.point[0];
    const Integer m = 2 * dot(u, u), n = dot(u, u) - q.weight[1] + q.weight[0];
    const Point to_p{m * v.x - n * u.x, m * v.y - n * u.y, m * v.z - n * u.z};  // m (p - c)
    const Integer radius = n * n * dot(u, u) - m * m * q.weight[0];             // m^2 r^2
    return sign_of(m * m * q.weight[2] - (dot(to_p, to_p) - radius));
}

/// Centre a + s u + t v with s = i / m, t = j / m by Cramer's rule from 2 (c - a).u = |u|^2 - w_b + w_a, and so for v.
inline Sign equatorial_power_test(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& p) {
    const auto q = to_integers<4>({a, b, c, p});
    const Point u = q.point[1] - q.point[0], v = q.point[2] - q.point[0], w = q.point[3] - q.point[0];
    const Integer uu = dot(u, u), vv = dot(v, v), uv = dot(u, v);
    const Integer f = uu - q.weight[1] + q.weight[0], g = vv - q.weight[2] + q.weight[0];
    const Integer m = 2 * (uu * vv - uv * uv), i = f * vv - g * uv, j = g * uu - f * uv;
    const Point centre{i * u.x + j * v.x, i * u.y + j * v.y, i * u.z + j * v.z};  // m (c - a)
    const Point to_p{m * w.x - centre.x, m * w.y - centre.y, m * w.z - centre.z};
    const Integer radius = dot(centre, centre) - m * m * q.weight[0];
    return sign_of(m * m * q.weight[3] - (dot(to_p, to_p) - radius));
}

}  // namespace wellmesh::oracle
