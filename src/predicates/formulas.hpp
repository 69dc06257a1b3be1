// SPDX-License-Identifier: Apache-2.0
// The polynomials whose signs the predicates are, each written once. The ladder (ladder.hpp) evaluates them over doubles,
// absolute values, double-doubles and expansions. Arguments are differences of points.
//
// kDegree: of the polynomial in the differences; every monomial has it.
// kRoundings: the most roundings that any monomial undergoes when the polynomial is evaluated over doubles from rounded
// differences: its own factors' (one each) plus those of the operations that it passes through.
#pragma once

#include <array>
#include <cstddef>

namespace wellmesh {

template <class T>
struct Triple {
    T x, y, z;
};

template <class T>
auto dot_product(const Triple<T>& p, const Triple<T>& q) {
    return p.x * q.x + p.y * q.y + p.z * q.z;
}

/// det(u, v, w) with u = b - a, v = c - a, w = d - a. Sum of absolute coefficients: 6.
struct Orient3dFormula {
    static constexpr std::size_t kArguments = 3;
    static constexpr int kDegree = 3;
    static constexpr int kRoundings = 8;  // differences 3, minor 2, product 1, sums 2
    template <class T>
    static auto value(const std::array<Triple<T>, 3>& p) {
        const auto& [u, v, w] = p;
        return u.x * (v.y * w.z - v.z * w.y) + u.y * (v.z * w.x - v.x * w.z) + u.z * (v.x * w.y - v.y * w.x);
    }
};

/// With all points relative to e: |a|^2 [bcd] - |b|^2 [acd] + |c|^2 [abd] - |d|^2 [abc], [pqr] = det(p, q, r). It is the
/// negated 4 x 4 determinant of rows (p, |p|^2); at the centroid of the positive unit tetrahedron it is positive.
/// Sum of absolute coefficients: 4 lifts of 3 times 6 = 72.
struct InsphereFormula {
    static constexpr std::size_t kArguments = 4;
    static constexpr int kDegree = 5;
    // lift: differences 2, product 1, sums 2; [pqr]: differences 3, minor 2, product 1, sums 2; product 1; sums 2
    static constexpr int kRoundings = 16;
    template <class T>
    static auto value(const std::array<Triple<T>, 4>& p) {
        const auto& [a, b, c, d] = p;
        const auto ab = a.x * b.y - b.x * a.y, ac = a.x * c.y - c.x * a.y, ad = a.x * d.y - d.x * a.y;
        const auto bc = b.x * c.y - c.x * b.y, bd = b.x * d.y - d.x * b.y, cd = c.x * d.y - d.x * c.y;
        const auto abc = a.z * bc - b.z * ac + c.z * ab, abd = a.z * bd - b.z * ad + d.z * ab;
        const auto acd = a.z * cd - c.z * ad + d.z * ac, bcd = b.z * cd - c.z * bd + d.z * bc;
        return (dot_product(a, a) * bcd - dot_product(b, b) * acd) + (dot_product(c, c) * abd - dot_product(d, d) * abc);
    }
};

/// (a - p) . (b - p): negative iff p sees ab under an obtuse angle, i.e. lies inside the diametral sphere (Thales).
struct DiametralFormula {
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
struct EquatorialFormula {
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

}  // namespace wellmesh
