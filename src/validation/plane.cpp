// SPDX-License-Identifier: Apache-2.0
#include "validation/plane.hpp"

#include <algorithm>
#include <cmath>

#include "core/vec3_math.hpp"

namespace wellmesh {
namespace {

Vec3 any_perpendicular(const Vec3& u) {
    const Vec3 axis = std::abs(u.x) <= std::abs(u.y) && std::abs(u.x) <= std::abs(u.z) ? Vec3{1, 0, 0}
                      : std::abs(u.y) <= std::abs(u.z)                                 ? Vec3{0, 1, 0}
                                                                                       : Vec3{0, 0, 1};
    const Vec3 v = cross(u, axis);
    return (1 / norm(v)) * v;
}

/// Length without overflow or underflow of the squares.
double safe_norm(const Vec3& a) { return std::hypot(a.x, a.y, a.z); }

/// A frame whose first axis is the points' longest direction from the centroid and whose second is the largest offset from that.
struct Frame {
    Vec3 u, v, n;
    double length = 0, width = 0;
};

Frame spanned_frame(std::span<const Vec3> points, const Vec3& origin) {
    Frame f;
    f.u = {1, 0, 0};
    // from an extreme point, so that three points give their longest edge
    Vec3 from = origin;
    for (int pass = 0; pass < 2; ++pass) {
        Vec3 best = from;
        double far = -1;
        for (const Vec3& p : points)
            if (const double d = safe_norm(p - from); d > far) {
                far = d;
                best = p;
            }
        f.length = far;
        if (far > 0) f.u = (1 / far) * (best - from);
        if (pass == 0) from = best;
    }
    Vec3 across{};
    for (const Vec3& p : points) {
        const Vec3 d = p - from;
        const Vec3 off = d - dot(d, f.u) * f.u;
        if (const double w = safe_norm(off); w > f.width) {
            f.width = w;
            across = (1 / w) * off;
        }
    }
    f.v = f.width > 0 ? across : any_perpendicular(f.u);
    f.v = f.v - dot(f.v, f.u) * f.u;
    f.v = (1 / safe_norm(f.v)) * f.v;
    f.n = cross(f.u, f.v);
    return f;
}

/// One Gauss-Newton step: offsets along n as a linear function of (u / length, v / width), both of order one.
void tilt(Frame& f, Vec3& origin, std::span<const Vec3> points) {
    double m[3][4] = {};
    for (const Vec3& p : points) {
        const Vec3 d = p - origin;
        const double row[4] = {1, dot(d, f.u) / f.length, dot(d, f.v) / f.width, dot(d, f.n)};
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 4; ++j) m[i][j] += row[i] * row[j];
    }
    for (int i = 0; i < 3; ++i) {  // elimination without pivoting: the matrix is a Gram matrix
        if (!(m[i][i] > 1e-12 * static_cast<double>(points.size()))) return;  // fewer independent points than unknowns
        for (int k = i + 1; k < 3; ++k) {
            const double factor = m[k][i] / m[i][i];
            for (int j = i; j < 4; ++j) m[k][j] -= factor * m[i][j];
        }
    }
    const double b = m[2][3] / m[2][2];
    const double a = (m[1][3] - m[1][2] * b) / m[1][1];
    const double c = (m[0][3] - m[0][1] * a - m[0][2] * b) / m[0][0];
    origin = origin + c * f.n;
    Vec3 n = f.n - (a / f.length) * f.u - (b / f.width) * f.v;
    n = (1 / safe_norm(n)) * n;
    f.u = f.u - dot(f.u, n) * n;
    f.u = (1 / safe_norm(f.u)) * f.u;
    f.n = n;
    f.v = cross(n, f.u);
}

}  // namespace

double FittedPlane::distance_of(const Vec3& p) const { return dot(p - origin, normal); }

void FittedPlane::flip() {
    normal = -normal;
    std::swap(axis_u, axis_v);
}

FittedPlane fit_plane(std::span<const Vec3> points) {
    FittedPlane plane;
    if (points.empty()) return plane;
    Vec3 sum{};
    for (const Vec3& p : points) sum = sum + (p - points[0]);  // differences: no cancellation far from the origin
    plane.origin = points[0] + (1 / static_cast<double>(points.size())) * sum;
    Frame f = spanned_frame(points, plane.origin);
    if (f.width > 0 && points.size() > 3) {
        tilt(f, plane.origin, points);
        tilt(f, plane.origin, points);
    } else {
        plane.origin = points[0];
    }
    plane.normal = f.n;
    plane.axis_u = f.u;
    plane.axis_v = f.v;
    plane.width = f.width;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (const double d = std::abs(plane.distance_of(points[i])); d > plane.residual) {
            plane.residual = d;
            plane.worst = i;
        }
    return plane;
}

PlaneProjection::PlaneProjection(const Vec3& normal) {
    const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
    std::size_t dropped = 2;
    double along = normal.z;
    if (x >= y && x >= z) {
        dropped = 0;
        along = normal.x;
    } else if (y >= z) {
        dropped = 1;
        along = normal.y;
    }
    first_ = (dropped + 1) % 3;
    second_ = (dropped + 2) % 3;
    if (along < 0) std::swap(first_, second_);  // so that counter-clockwise about the normal stays counter-clockwise
}

Sign orient2d(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& c) {
    const double left = (b[0] - a[0]) * (c[1] - a[1]), right = (b[1] - a[1]) * (c[0] - a[0]);
    const double det = left - right;
    // u = 2^-53: two roundings of differences and one of the product a term, one of the difference: (3 + 16 u) u [Shewchuk97];
    // a sum that might have underflowed is left to the exact predicate.
    constexpr double kBound = 3.5 * 0x1p-53;
    const double magnitude = std::abs(left) + std::abs(right);
    if (magnitude > 0x1p-960 && std::abs(det) > kBound * magnitude) return det > 0 ? Sign::positive : Sign::negative;
    double lift = 0;  // any height of the same order keeps the exact predicate within its range
    for (const double x : {a[0], a[1], b[0], b[1], c[0], c[1]}) lift = std::max(lift, std::abs(x));
    if (lift == 0) return Sign::zero;
    // det(b - a, c - a, (0, 0, lift)) = lift * det of the projections
    return orient3d({a[0], a[1], 0}, {b[0], b[1], 0}, {c[0], c[1], 0}, {a[0], a[1], lift});
}

bool collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
    return orient2d({a.x, a.y}, {b.x, b.y}, {c.x, c.y}) == Sign::zero && orient2d({a.y, a.z}, {b.y, b.z}, {c.y, c.z}) == Sign::zero &&
           orient2d({a.z, a.x}, {b.z, b.x}, {c.z, c.x}) == Sign::zero;
}

}  // namespace wellmesh
