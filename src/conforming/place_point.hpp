// SPDX-License-Identifier: Apache-2.0
// Rounded points on segments and facets. Each is computed from the input's own coordinates, never from other Steiner points, so
// rounding does not accumulate: a point misses its segment or facet by one or two ulp of the largest coordinate.
#pragma once

#include <cmath>

#include "core/vec3_math.hpp"
#include "predicates/exact_range.hpp"
#include "validation/valid_plc.hpp"

namespace wellmesh {

/// The point of the segment nearest to p, counted from the nearer end.
inline Vec3 project_to_segment(const ValidPlc& plc, SegmentId s, const Vec3& p) {
    const ValidSegment& segment = plc.segments[s.index()];
    const Vec3 &a = plc.vertices[segment.ends[0].index()], &b = plc.vertices[segment.ends[1].index()];
    const Vec3 d = b - a;
    const double t = dot(p - a, d) / squared_norm(d);
    if (t < 0.5) return flush_to_exact_range(a + t * d);
    return flush_to_exact_range(b + (-dot(b - p, d) / squared_norm(d)) * d);
}

/// Coordinates of p in the facet's frame.
inline std::array<double, 2> facet_coordinates(const ValidFacet& f, const Vec3& p) {
    const Vec3 d = p - f.origin;
    return {dot(d, f.axis_u), dot(d, f.axis_v)};
}

/// The point of the facet's plane nearest to p.
inline Vec3 project_to_facet(const ValidFacet& f, const Vec3& p) {
    const auto [u, v] = facet_coordinates(f, p);
    Vec3 q = f.origin + (u * f.axis_u + v * f.axis_v);
    q = q - dot(q - f.origin, f.normal) * f.normal;  // one Newton step takes off what the frame's own rounding put on
    return flush_to_exact_range(q);
}

/// Circumcentre of a triangle in its own plane, and its radius.
inline Vec3 circumcentre(const Vec3& a, const Vec3& b, const Vec3& c, double* radius = nullptr) {
    const Vec3 u = b - a, v = c - a, n = cross(u, v);
    const Vec3 d = (1 / (2 * squared_norm(n))) * (squared_norm(u) * cross(v, n) + squared_norm(v) * cross(n, u));
    if (radius) *radius = norm(d);
    return a + d;
}

/// Circumcentre of a tetrahedron, and its radius.
inline Vec3 circumcentre(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double* radius = nullptr) {
    const Vec3 u = b - a, v = c - a, w = d - a;
    const Vec3 r = (1 / (2 * determinant(u, v, w))) * (squared_norm(u) * cross(v, w) + squared_norm(v) * cross(w, u) + squared_norm(w) * cross(u, v));
    if (radius) *radius = norm(r);
    return a + r;
}

}  // namespace wellmesh
