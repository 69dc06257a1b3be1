// SPDX-License-Identifier: Apache-2.0
// The rungs of the predicates' ladder, for tests and benchmarks only.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "predicates/predicates.hpp"

namespace wellmesh {

/// Which step decided, from the cheapest.
enum class Rung : std::uint8_t {
    static_filter,  ///< determinant against the bound of the bounding box
    forward_bound,  ///< determinant against the bound from this call's magnitudes
    exact_doubles,  ///< determinant over doubles, every step of which was exact
    double_double,  ///< determinant over double-doubles against a bound from this call's magnitudes
    exact,          ///< expansion arithmetic
    perturbation    ///< the exact value is zero: symbolic perturbation
};

struct Decision {
    Sign sign = Sign::zero;
    Rung rung = Rung::exact;
};

/// All rungs below the static filter, in order.
[[nodiscard]] Decision decide_orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
[[nodiscard]] Decision decide_insphere(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e);
[[nodiscard]] Decision decide_side_of_diametral_sphere(const Vec3& a, const Vec3& b, const Vec3& p);
[[nodiscard]] Decision decide_side_of_equatorial_sphere(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);
[[nodiscard]] Decision decide_power_test(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& d,
                                         const WeightedPoint& e);
[[nodiscard]] Decision decide_diametral_power_test(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& p);
[[nodiscard]] Decision decide_equatorial_power_test(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& p);

/// One rung alone: forward_bound, exact_doubles, double_double or exact. Empty: it cannot decide.
[[nodiscard]] std::optional<Sign> orient3d_rung(Rung rung, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
[[nodiscard]] std::optional<Sign> insphere_rung(Rung rung, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e);
[[nodiscard]] std::optional<Sign> diametral_rung(Rung rung, const Vec3& a, const Vec3& b, const Vec3& p);
[[nodiscard]] std::optional<Sign> equatorial_rung(Rung rung, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p);
[[nodiscard]] std::optional<Sign> power_rung(Rung rung, const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& d,
                                             const WeightedPoint& e);
[[nodiscard]] std::optional<Sign> diametral_power_rung(Rung rung, const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& p);
[[nodiscard]] std::optional<Sign> equatorial_power_rung(Rung rung, const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c,
                                                        const WeightedPoint& p);

/// The static filter and everything below it, with the rung that decided.
[[nodiscard]] Decision decide_orient3d(const PredicateFilter& filter, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
[[nodiscard]] Decision decide_insphere(const PredicateFilter& filter, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d,
                                       const Vec3& e);
[[nodiscard]] Decision decide_insphere_perturbed(const PredicateFilter& filter, const Vec3& a, const Vec3& b, const Vec3& c,
                                                 const Vec3& d, const Vec3& e);
[[nodiscard]] Decision decide_power_test(const PredicateFilter& filter, const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c,
                                         const WeightedPoint& d, const WeightedPoint& e);

}  // namespace wellmesh
