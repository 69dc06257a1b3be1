// SPDX-License-Identifier: Apache-2.0
// The polynomials whose signs the predicates are, each written once. The ladder (ladder.hpp) evaluates them over doubles,
// absolute values, double-doubles and expansions. Arguments are differences of points, or of points and weights.
//
// kDegree: of the polynomial in the differences, where a weight's counts as of degree 2; every monomial has it.
// kRoundings: the most roundings that any monomial undergoes when the polynomial is evaluated over doubles from rounded
// differences: its own factors' (one each) plus those of the operations that it passes through.
#pragma once

#include <array>
#include <cstddef>

#include "wellmesh/predicates.hpp"

namespace wellmesh {

/// Difference of two points.
template <class T>
struct Triple {
    T x, y, z;
};

/// Difference of two weighted points; w, that of their weights, is of degree 2.
template <class T>
struct Quadruple {
    T x, y, z, w;
};

template <class P, class Q>
auto dot_product(const P& p, const Q& q) {
    return p.x * q.x + p.y * q.y + p.z * q.z;
}

/// Height at which a difference of weighted points is lifted: |p|^2 - w.
template <class T>
auto weighted_lift(const Quadruple<T>& p) {
    return dot_product(p, p) - p.w;
}

/// What formulas of points and of weighted points are formulas of.
struct OfPoints {
    using Point = Vec3;
    template <class T>
    using Argument = Triple<T>;
};
struct OfWeightedPoints {
    using Point = WeightedPoint;
    template <class T>
    using Argument = Quadruple<T>;
};

/// det(u, v, w) with u = b - a, v = c - a, w = d - a. Sum of absolute coefficients: 6.
struct Orient3dFormula : OfPoints {
    static constexpr std::size_t kArguments = 3;
    static constexpr int kDegree = 3;
    static constexpr int kRoundings = 8;  // differences 3, minor 2, product 1, sums 2
    template <class T>
    static auto value(const std::array<Triple<T>, 3>& p) {
        const auto& [u, v, w] = p;
        return u.x * (v.y * w.z - v.z * w.y) + u.y * (v.z * w.x - v.x * w.z) + u.z * (v.x * w.y - v.y * w.x);
    }
};

/// l_a [bcd] - l_b [acd] + l_c [abd] - l_d [abc], [pqr] = det(p, q, r): the negated 4 x 4 determinant of rows (p, l_p).
template <class P, class L>
auto lifted_determinant(const std::array<P, 4>& p, const L& lift_a, const L& lift_b, const L& lift_c, const L& lift_d) {
    const auto& [a, b, c, d] = p;
    const auto ab = a.x * b.y - b.x * a.y, ac = a.x * c.y - c.x * a.y, ad = a.x * d.y - d.x * a.y;
    const auto bc = b.x * c.y - c.x * b.y, bd = b.x * d.y - d.x * b.y, cd = c.x * d.y - d.x * c.y;
    const auto abc = a.z * bc - b.z * ac + c.z * ab, abd = a.z * bd - b.z * ad + d.z * ab;
    const auto acd = a.z * cd - c.z * ad + d.z * ac, bcd = b.z * cd - c.z * bd + d.z * bc;
    return (lift_a * bcd - lift_b * acd) + (lift_c * abd - lift_d * abc);
}

/// All points relative to e, lifted to |p|^2: positive at the centroid of the positive unit tetrahedron.
/// Sum of absolute coefficients: 4 lifts of 3 times 6 = 72.
struct InsphereFormula : OfPoints {
    static constexpr std::size_t kArguments = 4;
    static constexpr int kDegree = 5;
    // lift: differences 2, product 1, sums 2; [pqr]: differences 3, minor 2, product 1, sums 2; product 1; sums 2
    static constexpr int kRoundings = 16;
    template <class T>
    static auto value(const std::array<Triple<T>, 4>& p) {
        return lifted_determinant(p, dot_product(p[0], p[0]), dot_product(p[1], p[1]), dot_product(p[2], p[2]), dot_product(p[3], p[3]));
    }
};

/// The same with weighted lifts: |p - e|^2 - (w_p - w_e). Raising w_e raises all four lifts, hence the value of a positive tetrahedron.
/// Sum of absolute coefficients: 4 lifts of 4 times 6 = 96.
struct PowerFormula : OfWeightedPoints {
    static constexpr std::size_t kArguments = 4;
    static constexpr int kDegree = 5;
    static constexpr int kRoundings = 17;  // InsphereFormula's and the subtraction of the weight
    template <class T>
    static auto value(const std::array<Quadruple<T>, 4>& p) {
        return lifted_determinant(p, weighted_lift(p[0]), weighted_lift(p[1]), weighted_lift(p[2]), weighted_lift(p[3]));
    }
};

/// (a - p) . (b - p): negative iff p sees ab under an obtuse angle, i.e. lies inside the diametral sphere (Thales).
struct DiametralFormula : OfPoints {
    static constexpr std::size_t kArguments = 2;
    static constexpr int kDegree = 2;
    static constexpr int kRoundings = 5;  // differences 2, product 1, sums 2
    template <class T>
    static auto value(const std::array<Triple<T>, 2>& p) {
        return dot_product(p[0], p[1]);
    }
};

/// With u = b - a, v = c - a, w = p - a, n = u x v, the circumcentre of abc is a + q / (2 |n|^2), where
/// q = |u|^2 (v x n) + |v|^2 (n x u), and p is inside iff |w|^2 |n|^2 - w.q < 0. By Lagrange's identities
///   |n|^2 = |u|^2 |v|^2 - (u.v)^2,  w.(v x n) = (w.u) |v|^2 - (w.v) (u.v),  w.(n x u) = (w.v) |u|^2 - (w.u) (u.v),
/// so that the test is a cubic polynomial of scalar products: degree 6. It is zero for collinear a, b, c.
/// Sum of absolute coefficients: scalar products have 3; three terms of 3 (9 + 9) = 54 each: 162.
struct EquatorialFormula : OfPoints {
    static constexpr std::size_t kArguments = 3;
    static constexpr int kDegree = 6;
    static constexpr int kRoundings = 20;  // scalar products 5 each, product 1, difference 1, product 1, differences 2
    template <class T>
    static auto value(const std::array<Triple<T>, 3>& p) {
        const auto& [u, v, w] = p;
        const auto uu = dot_product(u, u), vv = dot_product(v, v), uv = dot_product(u, v);
        const auto wu = dot_product(w, u), wv = dot_product(w, v);
        return dot_product(w, w) * (uu * vv - uv * uv) - uu * (wu * vv - wv * uv) - vv * (wv * uu - wu * uv);
    }
};

/// With u = b - a and w = p - a, the smallest sphere orthogonal to a and b is centred at a + l_u / (2 |u|^2) u, l the weighted lift, and p is
/// nearer to it than orthogonal iff l_w |u|^2 - l_u (w.u) < 0. It is zero for a = b of equal weight.
/// Sum of absolute coefficients: 2 lifts of 4 times 3 = 24.
struct WeightedDiametralFormula : OfWeightedPoints {
    static constexpr std::size_t kArguments = 2;
    static constexpr int kDegree = 4;
    static constexpr int kRoundings = 13;  // lift 6, scalar product 5, product 1, difference 1
    template <class T>
    static auto value(const std::array<Quadruple<T>, 2>& p) {
        const auto& [u, w] = p;
        return weighted_lift(w) * dot_product(u, u) - weighted_lift(u) * dot_product(w, u);
    }
};

/// EquatorialFormula, but q = l_u (v x n) + l_v (n x u), and p is nearer than orthogonal iff l_w |n|^2 - w.q < 0.
/// Sum of absolute coefficients: three lifts of 4 times (9 + 9): 216.
struct WeightedEquatorialFormula : OfWeightedPoints {
    static constexpr std::size_t kArguments = 3;
    static constexpr int kDegree = 6;
    static constexpr int kRoundings = 21;  // EquatorialFormula's and the subtraction of the weight
    template <class T>
    static auto value(const std::array<Quadruple<T>, 3>& p) {
        const auto& [u, v, w] = p;
        const auto uu = dot_product(u, u), vv = dot_product(v, v), uv = dot_product(u, v);
        const auto wu = dot_product(w, u), wv = dot_product(w, v);
        return weighted_lift(w) * (uu * vv - uv * uv) - weighted_lift(u) * (wu * vv - wv * uv) - weighted_lift(v) * (wv * uu - wu * uv);
    }
};

}  // namespace wellmesh
