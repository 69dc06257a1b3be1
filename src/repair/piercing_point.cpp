// SPDX-License-Identifier: Apache-2.0
#include "repair/piercing_point.hpp"

#include <algorithm>
#include <cmath>

#include "core/vec3_math.hpp"
#include "predicates/exact_range.hpp"
#include "predicates/expansion.hpp"

namespace wellmesh {
namespace {

using Difference = Expansion<2>;

Difference scaled_difference(double a, double b) { return Difference(two_difference(kDifferenceScale * a, kDifferenceScale * b)); }

/// det(b - a, c - a, d - a) times a constant, within an ulp of itself.
double exact_volume(const std::array<Vec3, 3>& t, const Vec3& d) {
    const Vec3 &a = t[0], &b = t[1], &c = t[2];
    const Difference bx = scaled_difference(b.x, a.x), by = scaled_difference(b.y, a.y), bz = scaled_difference(b.z, a.z);
    const Difference cx = scaled_difference(c.x, a.x), cy = scaled_difference(c.y, a.y), cz = scaled_difference(c.z, a.z);
    const Difference dx = scaled_difference(d.x, a.x), dy = scaled_difference(d.y, a.y), dz = scaled_difference(d.z, a.z);
    return (bx * (cy * dz - cz * dy) + by * (cz * dx - cx * dz) + bz * (cx * dy - cy * dx)).estimate();
}

}  // namespace

Vec3 piercing_point(const std::array<Vec3, 2>& segment, const std::array<Vec3, 3>& triangle) {
    const Vec3 b = triangle[1] - triangle[0], c = triangle[2] - triangle[0];
    double from = determinant(b, c, segment[0] - triangle[0]), to = determinant(b, c, segment[1] - triangle[0]);
    // A determinant is off by at most 8 u times the product of its rows' lengths, u = 2^-53. Where the difference of the two is less than a
    // sixteenth of that product, the point might be off by more than some ulp of the segment's length: exact arithmetic answers.
    const double rows = norm(b) * norm(c) * std::max(norm(segment[0] - triangle[0]), norm(segment[1] - triangle[0]));
    if (!(std::abs(from - to) > rows / 16)) {
        from = exact_volume(triangle, segment[0]);
        to = exact_volume(triangle, segment[1]);
    }
    const double place = from / (from - to);
    // from the nearer end, so that the rounding of the product is small
    const Vec3 p = place <= 0.5 ? segment[0] + place * (segment[1] - segment[0]) : segment[1] + (to / (to - from)) * (segment[0] - segment[1]);
    return flush_to_exact_range(p);
}

}  // namespace wellmesh
