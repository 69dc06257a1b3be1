// SPDX-License-Identifier: Apache-2.0
// Rounded vector arithmetic. Nothing here decides topology: that is what predicates/ is for.
#pragma once

#include <cmath>

#include "wellmesh/vec3.hpp"

namespace wellmesh {

constexpr Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
constexpr Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
constexpr double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(const Vec3& a, const Vec3& b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
constexpr double squared_norm(const Vec3& a) { return dot(a, a); }
inline double norm(const Vec3& a) { return std::sqrt(squared_norm(a)); }
constexpr double squared_distance(const Vec3& a, const Vec3& b) { return squared_norm(b - a); }
inline double distance(const Vec3& a, const Vec3& b) { return std::sqrt(squared_distance(a, b)); }
constexpr double determinant(const Vec3& u, const Vec3& v, const Vec3& w) { return dot(u, cross(v, w)); }
constexpr bool lexicographically_less(const Vec3& a, const Vec3& b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

}  // namespace wellmesh
