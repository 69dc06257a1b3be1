// SPDX-License-Identifier: Apache-2.0
// InsphereFormula over the four lanes of a vector register, where the processor has them.
#pragma once

#include <array>
#include <span>

#include "wellmesh/vec3.hpp"

namespace wellmesh {

/// Whether insphere_value_in_lanes may be called: x86-64 with AVX2 and FMA.
[[nodiscard]] bool has_insphere_lanes() noexcept;

/// InsphereFormula::value of the rounded differences to e, with the same number of roundings in every monomial, so that the
/// same error bounds hold; the order of two sums differs, so the last bits may.
/// @pre has_insphere_lanes(); a, b, c and d are aligned to 32 bytes and eight more bytes may be read behind each, so that one load fetches it
[[nodiscard]] double insphere_value_in_lanes(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) noexcept;

/// Corners a, b, c, d of a tetrahedron, by address.
using SphereCorners = std::array<const Vec3*, 4>;

/// values[i] = insphere_value_in_lanes of spheres[i] and e: several at once, because each waits for its own results most of the time.
void insphere_values_in_lanes(std::span<const SphereCorners> spheres, const Vec3& e, double* values) noexcept;

}  // namespace wellmesh
