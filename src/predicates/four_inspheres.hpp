// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "wellmesh/vec3.hpp"

namespace wellmesh {

/// Four values at once, lane i from the points points[i] and e; bit by bit those of InsphereFormula::value of rounded differences.
/// @pre has_insphere_lanes(); all points but e are stored as insphere_lanes.hpp wants them
[[nodiscard]] std::array<double, 4> four_insphere_values(const std::array<std::array<const Vec3*, 4>, 4>& points, const Vec3& e) noexcept;

}  // namespace wellmesh
