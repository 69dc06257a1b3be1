// SPDX-License-Identifier: Apache-2.0
// Shape measures of one tetrahedron, in rounded arithmetic: they rank elements, they decide no topology.
//
// Corners are a, b, c, d with det(b - a, c - a, d - a) > 0 (docs/conventions.md). All differences are taken between corners, so
// a tetrahedron far from the origin loses no digits beyond those its coordinates lack.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/vec3_math.hpp"

namespace wellmesh {

/// Lengths in input units. An inverted tetrahedron has a negative volume and the other measures of its mirror image; a flat one has
/// infinite radius_edge and aspect and sigma 0.
struct TetShape {
    double radius_edge = 0;  ///< circumradius / shortest edge; sqrt(6)/4 = 0.612 for the regular tetrahedron, its minimum
    double aspect = 0;       ///< circumradius / inradius; 3 for the regular tetrahedron, its minimum
    double sigma = 0;        ///< |volume| / shortest_edge^3; no bound on angles: a short edge makes it large
    double volume = 0;       ///< signed
    double min_dihedral_deg = 0, max_dihedral_deg = 0;
    double shortest_edge = 0, circumradius = 0;
};

/// Six times the signed volume.
inline double six_volumes(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { return determinant(b - a, c - a, d - a); }

inline double shortest_edge_squared(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return std::min({squared_distance(a, b), squared_distance(a, c), squared_distance(a, d), squared_distance(b, c), squared_distance(b, d),
                     squared_distance(c, d)});
}

/// Vector from a to the circumcentre times twelve volumes.
inline Vec3 scaled_circumcentre(const Vec3& u, const Vec3& v, const Vec3& w) {
    return squared_norm(u) * cross(v, w) + squared_norm(v) * cross(w, u) + squared_norm(w) * cross(u, v);
}

/// Infinite, or no number, for a flat tetrahedron.
inline double circumradius(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Vec3 u = b - a, v = c - a, w = d - a;
    return norm(scaled_circumcentre(u, v, w)) / std::abs(2 * determinant(u, v, w));
}

/// Square of circumradius / shortest edge; infinite for a flat tetrahedron. No square root: compare it with the bound's square.
inline double radius_edge_squared(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Vec3 u = b - a, v = c - a, w = d - a;
    const double twelve_volumes = 2 * determinant(u, v, w);
    const double radius_squared = squared_norm(scaled_circumcentre(u, v, w)) / (twelve_volumes * twelve_volumes);
    return twelve_volumes == 0 ? std::numeric_limits<double>::infinity() : radius_squared / shortest_edge_squared(a, b, c, d);
}

/// Normals of the faces opposite a, b, c, d; they point inwards when the tetrahedron is positive, and are as long as twice the face's area.
/// The fourth is computed from its own edges, not as minus the sum of the others, which would cancel on a needle.
inline std::array<Vec3, 4> inward_face_normals(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Vec3 u = b - a, v = c - a, w = d - a;
    return {cross(d - b, c - b), cross(v, w), cross(w, u), cross(u, v)};
}

/// Returned by the cosine functions for a flat or inverted tetrahedron: worse than any angle.
inline constexpr double kNoAngleCosine = 2;

/// max_cos_dihedral() from the inward_face_normals() of a tetrahedron that is known to be positive.
inline double max_cos_of_normals(const std::array<Vec3, 4>& n) {
    const double q0 = 1 / squared_norm(n[0]), q1 = 1 / squared_norm(n[1]), q2 = 1 / squared_norm(n[2]), q3 = 1 / squared_norm(n[3]);
    if (!(q0 + q1 + q2 + q3 < std::numeric_limits<double>::infinity())) return kNoAngleCosine;
    const auto signed_square = [](double negative_dot, double qi, double qj) { return (-negative_dot * qi) * (std::abs(negative_dot) * qj); };
    const double s01 = signed_square(dot(n[0], n[1]), q0, q1), s02 = signed_square(dot(n[0], n[2]), q0, q2);
    const double s03 = signed_square(dot(n[0], n[3]), q0, q3), s12 = signed_square(dot(n[1], n[2]), q1, q2);
    const double s13 = signed_square(dot(n[1], n[3]), q1, q3), s23 = signed_square(dot(n[2], n[3]), q2, q3);
    const double worst = std::max(std::max(std::max(s01, s02), std::max(s03, s12)), std::max(s13, s23));
    // A tetrahedron has an angle of at most arccos(1/3), so `worst` is positive.
    return std::sqrt(std::max(worst, 0.0));
}

/// Cosine of the smallest dihedral angle (the largest of the six cosines); kNoAngleCosine if the tetrahedron is flat or inverted in
/// rounded arithmetic or has a corner that is not finite. Larger is worse. For hot loops: four divisions, one square root, no
/// trigonometry; 1 - cos resolves angles down to about 1e-6 degrees.
/// Squares d |d| / (|n_i|^2 |n_j|^2) are compared instead of the cosines d / (|n_i| |n_j|); they are multiplied in an order that
/// neither over- nor underflows while |n|^2 ~ L^4 does not (1e-76 < L < 1e76).
inline double max_cos_dihedral(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const std::array<Vec3, 4> n = inward_face_normals(a, b, c, d);
    if (!(dot(b - a, n[1]) > 0)) return kNoAngleCosine;  // catches NaN as well
    return max_cos_of_normals(n);
}

/// max_cos_dihedral(a, b, c, d) > cosine, up to rounding, for 0 < cosine: no division or root, and it ends with the first such angle.
inline bool has_dihedral_below(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double cosine) {
    const std::array<Vec3, 4> n = inward_face_normals(a, b, c, d);
    if (!(dot(b - a, n[1]) > 0)) return true;
    const std::array<double, 4> q{squared_norm(n[0]), squared_norm(n[1]), squared_norm(n[2]), squared_norm(n[3])};
    // Products of two squared areas, about L^8, must neither over- nor underflow.
    const double least = std::min({q[0], q[1], q[2], q[3]}), greatest = std::max({q[0], q[1], q[2], q[3]});
    if (!(least > 1e-150 && greatest < 1e150)) return max_cos_dihedral(a, b, c, d) > cosine;
    const double bound = cosine * cosine;
    const auto below = [&](std::size_t i, std::size_t j) {
        const double s = -dot(n[i], n[j]);
        return s > 0 && s * s > bound * (q[i] * q[j]);
    };
    return below(0, 1) || below(0, 2) || below(0, 3) || below(1, 2) || below(1, 3) || below(2, 3);
}

/// Smallest dihedral angle in degrees; 0 for a flat or inverted tetrahedron.
inline double min_dihedral_deg(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return std::acos(std::min(max_cos_dihedral(a, b, c, d), 1.0)) * (180 / std::numbers::pi);
}

/// Dihedral angle in degrees between two faces with these inward unit normals. By atan2 of cross and dot product: as accurate for angles
/// near 0 and 180 as the normals are.
inline double dihedral_between_deg(const Vec3& p, const Vec3& q) { return std::atan2(norm(cross(p, q)), -dot(p, q)) * (180 / std::numbers::pi); }

/// The six dihedral angles in degrees, at the edges opposite to ab, ac, ad, bc, bd, cd in this order.
inline std::array<double, 6> dihedral_angles_deg(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    std::array<Vec3, 4> n = inward_face_normals(a, b, c, d);
    for (Vec3& v : n) v = (1 / norm(v)) * v;
    return {dihedral_between_deg(n[0], n[1]), dihedral_between_deg(n[0], n[2]), dihedral_between_deg(n[0], n[3]),
            dihedral_between_deg(n[1], n[2]), dihedral_between_deg(n[1], n[3]), dihedral_between_deg(n[2], n[3])};
}

struct AngleRange {
    double least = 0, greatest = 0;
};

/// Smallest and largest of the six dihedral angles in degrees, from inward unit normals. Cosines tell which two edges have them, so two
/// arctangents are enough; but not where a cosine is within 1e-3 of 1 or -1 (2.6 degrees), as it hardly tells small angles apart.
/// Elsewhere two angles whose cosines cannot be told apart differ by less than 1e-14.
inline AngleRange dihedral_range_deg(const std::array<Vec3, 4>& n) {
    constexpr std::array<std::array<std::size_t, 2>, 6> kPairs{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
    std::array<double, 6> negative_cosines{};
    for (std::size_t i = 0; i < 6; ++i) negative_cosines[i] = dot(n[kPairs[i][0]], n[kPairs[i][1]]);
    const auto angle = [&](std::size_t i) { return dihedral_between_deg(n[kPairs[i][0]], n[kPairs[i][1]]); };
    const auto told_apart = [](double cosine) { return std::abs(cosine) < 1 - 1e-3; };  // false for NaN
    if (std::all_of(negative_cosines.begin(), negative_cosines.end(), told_apart)) {
        std::size_t least = 0, greatest = 0;
        for (std::size_t i = 1; i < 6; ++i) {
            if (negative_cosines[i] < negative_cosines[least]) least = i;
            if (negative_cosines[i] > negative_cosines[greatest]) greatest = i;
        }
        return {angle(least), angle(greatest)};
    }
    const std::array<double, 6> angles{angle(0), angle(1), angle(2), angle(3), angle(4), angle(5)};
    return {*std::min_element(angles.begin(), angles.end()), *std::max_element(angles.begin(), angles.end())};
}

/// shape_of() where products of nine lengths neither over- nor underflow.
inline TetShape shape_of_ordinary(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Vec3 u = b - a, v = c - a, w = d - a;
    TetShape s;
    s.volume = determinant(u, v, w) / 6;
    s.shortest_edge = std::sqrt(shortest_edge_squared(a, b, c, d));
    double twice_surface = 0;
    std::array<Vec3, 4> normals = inward_face_normals(a, b, c, d);
    for (Vec3& n : normals) {
        const double length = norm(n);
        twice_surface += length;
        n = (1 / length) * n;
    }
    const AngleRange angles = dihedral_range_deg(normals);
    s.min_dihedral_deg = angles.least;
    s.max_dihedral_deg = angles.greatest;
    const double volume = std::abs(s.volume);
    if (volume == 0) {
        s.circumradius = s.radius_edge = s.aspect = std::numeric_limits<double>::infinity();
        return s;
    }
    s.circumradius = norm(scaled_circumcentre(u, v, w)) / (12 * volume);
    s.radius_edge = s.circumradius / s.shortest_edge;
    s.aspect = s.circumradius * (twice_surface / 2) / (3 * volume);  // the inradius is 3 V / surface
    s.sigma = volume / (s.shortest_edge * s.shortest_edge * s.shortest_edge);
    return s;
}

/// The same of a tetrahedron of any size.
[[gnu::cold, gnu::noinline]] inline TetShape shape_of_scaled(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Vec3 u = b - a, v = c - a, w = d - a;
    const double size = std::max({std::abs(u.x), std::abs(u.y), std::abs(u.z), std::abs(v.x), std::abs(v.y), std::abs(v.z), std::abs(w.x), std::abs(w.y), std::abs(w.z)});
    if (!(size > 0 && size < std::numeric_limits<double>::infinity())) return shape_of_ordinary(a, b, c, d);
    // By a power of two: nothing is rounded, and of the measures only lengths and the volume change.
    const int power = std::ilogb(size);
    const double scale = std::ldexp(1.0, -power);
    TetShape s = shape_of_ordinary(scale * a, scale * b, scale * c, scale * d);
    s.volume = std::ldexp(s.volume, 3 * power);
    s.shortest_edge = std::ldexp(s.shortest_edge, power);
    s.circumradius = std::ldexp(s.circumradius, power);
    return s;
}

/// All measures at once.
inline TetShape shape_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    constexpr double kLeast = 1e-30;  // of edges; coordinates of at most 1e27 don't overflow
    const TetShape s = shape_of_ordinary(a, b, c, d);
    if (s.shortest_edge > kLeast) [[likely]] return s;
    return shape_of_scaled(a, b, c, d);
}

}  // namespace wellmesh
