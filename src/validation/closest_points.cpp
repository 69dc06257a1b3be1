// SPDX-License-Identifier: Apache-2.0
#include "validation/closest_points.hpp"

#include <algorithm>
#include <cmath>

#include "core/vec3_math.hpp"

namespace wellmesh {

Vec3 closest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 u = b - a;
    const double length2 = squared_norm(u);
    if (!(length2 > 0)) return a;
    const double t = dot(p - a, u) / length2;
    return t <= 0 ? a : t >= 1 ? b : a + t * u;
}

Vec3 closest_on_triangle(const Vec3& p, const std::array<Vec3, 3>& t) {
    const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
    const double length2 = squared_norm(n);
    bool above = length2 > 0;
    for (std::size_t i = 0; above && i < 3; ++i) above = dot(cross(t[(i + 1) % 3] - t[i], p - t[i]), n) >= 0;
    if (above) return p - (dot(p - t[0], n) / length2) * n;
    Vec3 best = t[0];
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 q = closest_on_segment(p, t[i], t[(i + 1) % 3]);
        if (squared_distance(p, q) < squared_distance(p, best)) best = q;
    }
    return best;
}

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 u = b - a;
    const double length2 = squared_norm(u);
    const double t = length2 > 0 ? std::clamp(dot(p - a, u) / length2, 0.0, 1.0) : 0.0;
    return norm((p - a) - t * u);
}

double distance_to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const double boundary = std::min({distance_to_segment(p, a, b), distance_to_segment(p, b, c), distance_to_segment(p, c, a)});
    const Vec3 n = cross(b - a, c - a);
    const double length = norm(n);
    if (!(length > 0) || dot(cross(b - a, p - a), n) < 0 || dot(cross(c - b, p - b), n) < 0 || dot(cross(a - c, p - c), n) < 0) return boundary;
    return std::min(boundary, std::abs(dot(p - a, n)) / length);
}

ClosestPair closest_between(const std::array<Vec3, 2>& first, const std::array<Vec3, 2>& second) {
    ClosestPair best{first[0], closest_on_segment(first[0], second[0], second[1])};
    const auto consider = [&](const Vec3& p, const Vec3& q) {
        if (squared_distance(p, q) < squared_distance(best.on_first, best.on_second)) best = {p, q};
    };
    const Vec3 u = first[1] - first[0];
    const double length2 = squared_norm(u);
    if (length2 > 0) {
        // (q - first[0]) x u is the offset of q from the first line, turned by a right angle and scaled: linear in q's place on the second
        const Vec3 from = cross(second[0] - first[0], u), change = cross(second[1] - second[0], u);
        const double change2 = squared_norm(change);
        if (change2 > 0) {
            const Vec3 q = second[0] + std::clamp(-dot(from, change) / change2, 0.0, 1.0) * (second[1] - second[0]);
            consider(closest_on_segment(q, first[0], first[1]), q);
        }
    }
    consider(first[1], closest_on_segment(first[1], second[0], second[1]));
    consider(closest_on_segment(second[0], first[0], first[1]), second[0]);
    consider(closest_on_segment(second[1], first[0], first[1]), second[1]);
    return best;
}

}  // namespace wellmesh
