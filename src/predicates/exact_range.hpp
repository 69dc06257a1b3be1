// SPDX-License-Identifier: Apache-2.0
// The coordinates for which every predicate is exact: zero, or of magnitude in [kMinMagnitude, kMaxMagnitude].
//
// Such a coordinate is a multiple of 2^(-200 - 52) = 2^-252 (its last bit), hence so is every difference of two, and its
// magnitude is at most 2^91. Every rung but the static filter multiplies differences by kDifferenceScale = 2^73 first,
// which is exact: then they are multiples of g = 2^-179 and at most D = 2^164. Let a predicate be a polynomial of
// degree d in the differences.
//   No underflow: every number that its evaluation meets, a rounding error included, is a multiple of g^k for some k <= d.
//     The worst d is 6 (equatorial sphere): g^6 = 2^-1074 is the least positive double, so a result that falls into the
//     subnormal range is representable and therefore exact: underflow never costs a bit, in expansions or in bounds.
//   No overflow: no partial sum exceeds m D^d, m the sum of the absolute coefficients (orient3d 6, insphere 72, equatorial
//     216 with weights, see formulas.hpp): 216 * 2^984 < 2^992. Splitting a factor multiplies it by 2^27 + 1, and factors of a
//     product in the equatorial test are at most 18 D^4 < 2^661.
// Weights count as of degree 2: zero, or of magnitude in [kMinMagnitude^2, kMaxMagnitude^2]. They are multiples of 2^(-400 - 52), and
// differences, at most 2^181, are multiplied by kDifferenceScale^2 = 2^146: multiples of 2^-306, hence of g^2, and at most 2^327 < D^2.
// The window is shifted to small magnitudes on purpose: a coordinate of 1e-50 that should be zero is a common accident,
// one of 1e28 is not. tests/unit/predicates/exact_range_test.cpp exercises both ends.
#pragma once

#include <cmath>

#include "wellmesh/vec3.hpp"

namespace wellmesh {

inline constexpr double kMinMagnitude = 0x1p-200;    ///< 6.2e-61, input units
inline constexpr double kMaxMagnitude = 0x1p90;      ///< 1.2e27, input units
inline constexpr double kDifferenceScale = 0x1p73;

/// False for NaN and infinities, too.
[[nodiscard]] inline bool in_exact_range(double coordinate) {
    const double magnitude = std::fabs(coordinate);
    return magnitude == 0 || (magnitude >= kMinMagnitude && magnitude <= kMaxMagnitude);
}
[[nodiscard]] inline bool in_exact_range(const Vec3& p) { return in_exact_range(p.x) && in_exact_range(p.y) && in_exact_range(p.z); }

inline constexpr double kMinWeight = kMinMagnitude * kMinMagnitude, kMaxWeight = kMaxMagnitude * kMaxMagnitude;  ///< input units squared

/// False for NaN and infinities, too.
[[nodiscard]] inline bool weight_in_exact_range(double weight) {
    const double magnitude = std::fabs(weight);
    return magnitude == 0 || (magnitude >= kMinWeight && magnitude <= kMaxWeight);
}

/// Computed (Steiner) coordinates can cancel to almost nothing: those below the range become zero. Moves a point by less
/// than kMinMagnitude; does not mend coordinates that are too large.
[[nodiscard]] inline double flush_to_exact_range(double coordinate) { return std::fabs(coordinate) < kMinMagnitude ? 0.0 : coordinate; }
[[nodiscard]] inline Vec3 flush_to_exact_range(const Vec3& p) {
    return {flush_to_exact_range(p.x), flush_to_exact_range(p.y), flush_to_exact_range(p.z)};
}

}  // namespace wellmesh
