// SPDX-License-Identifier: Apache-2.0
// Closest points of points, segments and triangles. Rounded: for measuring, never for deciding topology.
#pragma once

#include <array>

#include "wellmesh/vec3.hpp"

namespace wellmesh {

[[nodiscard]] Vec3 closest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b);
[[nodiscard]] Vec3 closest_on_triangle(const Vec3& p, const std::array<Vec3, 3>& t);

/// However degenerate. Not the distance to the rounded closest point: relative to itself as precise as the differences of the coordinates.
[[nodiscard]] double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b);
[[nodiscard]] double distance_to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);
[[nodiscard]] inline double distance_to_triangle(const Vec3& p, const std::array<Vec3, 3>& t) { return distance_to_triangle(p, t[0], t[1], t[2]); }

/// A point of each of two closed segments, closest to each other. Accurate for segments that are almost parallel, too: the place comes from
/// the ends' offsets from the other line, not from the difference of two almost equal directions.
struct ClosestPair {
    Vec3 on_first{}, on_second{};
};
[[nodiscard]] ClosestPair closest_between(const std::array<Vec3, 2>& first, const std::array<Vec3, 2>& second);

}  // namespace wellmesh
