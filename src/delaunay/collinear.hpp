// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "core/vec3_math.hpp"
#include "predicates/predicates.hpp"

namespace wellmesh {

/// Exactly: do a, b, c lie on one line? The three planar orientations, each as an orient3d with one point lifted off the plane.
inline bool collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 u = b - a, v = c - a, n = cross(u, v);
    // Rounding moves each component of n by at most 3 eps |u| |v|: far more than that means not collinear.
    if (squared_norm(n) > 1e-24 * squared_norm(u) * squared_norm(v)) return false;
    const auto flat = [](double ax, double ay, double bx, double by, double cx, double cy) {
        return orient3d({ax, ay, 0}, {bx, by, 0}, {cx, cy, 0}, {ax, ay, 1}) == Sign::zero;
    };
    return flat(a.x, a.y, b.x, b.y, c.x, c.y) && flat(a.y, a.z, b.y, b.z, c.y, c.z) && flat(a.x, a.z, b.x, b.z, c.x, c.z);
}

}  // namespace wellmesh
