// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/workers.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh {

/// Permutation of 0..n-1 along a Hilbert curve: neighbours in it are neighbours in space. Deterministic.
[[nodiscard]] std::vector<std::uint32_t> spatial_order(std::span<const Vec3> points);

/// The same in rounds of growing size, each along a Hilbert curve: the order of bulk insertion [Amenta03]. Deterministic.
[[nodiscard]] std::vector<std::uint32_t> biased_spatial_order(std::span<const Vec3> points);

/// The same orders on several threads.
[[nodiscard]] std::vector<std::uint32_t> spatial_order(std::span<const Vec3> points, Workers& workers);
[[nodiscard]] std::vector<std::uint32_t> biased_spatial_order(std::span<const Vec3> points, Workers& workers);

}  // namespace wellmesh
