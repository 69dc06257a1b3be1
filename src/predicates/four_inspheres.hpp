// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "wellmesh/vec3.hpp"

namespace wellmesh {

/// Four values at once, lane i from the points points[i] and e; bit by bit those of InsphereFormula::value of rounded differences.
/// @pre has_insphere_lanes(); all points but e are stored as insphere_lanes.hpp wants them
[[nodiscard]] std::array<double, 4> four_insphere_values(const std::array<std::array<const Vec3*, 4>, 4>& points, const Vec3& e) noexcept;

/// Points that begin records of 32 bytes, aligned likewise: what one load fetches, and what a number tells.
struct PointRecords {
    const Vec3* first = nullptr;
    static constexpr std::size_t kBytes = 32;
    [[nodiscard]] const Vec3& operator[](std::size_t i) const { return *reinterpret_cast<const Vec3*>(reinterpret_cast<const char*>(first) + kBytes * i); }
};
/// Corners a, b, c, d of a tetrahedron, by the numbers of their records.
using RecordNumbers = std::array<std::uint32_t, 4>;

/// values[i], from tets[i] and e, with no more roundings in a monomial than InsphereFormula::value has. Fills whole lanes: there is room for three values more.
/// @pre has_insphere_lanes(); there is a tetrahedron
void insphere_values_of_records(PointRecords points, std::span<const RecordNumbers> tets, const Vec3& e, double* values) noexcept;

}  // namespace wellmesh
