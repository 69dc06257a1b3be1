// SPDX-License-Identifier: Apache-2.0
// Bounds of the static filter.
//
// No rounded difference exceeds the box's extents (X, Y, Z), so the permanents (ladder.hpp) are at most 6 XYZ for orient3d and
// 4 (X^2 + Y^2 + Z^2) 6 XYZ for insphere: four lifts, four 3 x 3 permanents; with weights in an interval of length W, each lift has W more.
// As in the ladder, the error is at most
// bound_of_roundings(kRoundings) times that; the few roundings of the bound itself are within its slack.
// Unlike the ladder, nothing is scaled here, so underflow counts. orient3d is safe: products of three differences are
// multiples of 2^-756. An insphere product may lose 2^-1075, times at most three more factors of 2^91 (a difference of weights counts for
// two), times 96 (the sum of the coefficients), at fewer than 2^7 places: below 2^(-1075 + 273 + 7 + 7) = 2^-788, which is added.
#include <algorithm>
#include <cmath>

#include "predicates/ladder.hpp"

namespace wellmesh {
namespace {

constexpr double kInsphereUnderflow = 0x1p-788;

/// Where no rounded difference exceeds the extents of a box, all of them positive.
double bound_of_insphere(const Vec3& box) {
    return bound_of_roundings(InsphereFormula::kRoundings) * 24 * (box.x * box.y * box.z) * (box.x * box.x + box.y * box.y + box.z * box.z) + kInsphereUnderflow;
}

thread_local std::uint64_t exact_calls = 0;

}  // namespace

PredicateFilter::PredicateFilter(const Vec3& box_extent, double weight_extent) {
    const Magnitude x{std::fabs(box_extent.x)}, y{std::fabs(box_extent.y)}, z{std::fabs(box_extent.z)};
    const double volume = (x * y * z).value, squared_diagonal = (x * x + y * y + z * z).value;
    orient3d_bound_ = bound_of_roundings(Orient3dFormula::kRoundings) * 6 * volume;
    insphere_bound_ = bound_of_insphere({x.value, y.value, z.value});
    power_bound_ = bound_of_roundings(PowerFormula::kRoundings) * 24 * volume * (squared_diagonal + std::fabs(weight_extent)) + kInsphereUnderflow;
}

Sign PredicateFilter::orient3d_beyond_filter(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    // Most points in one plane are so on a side of a box.
    if ((a.x == b.x && a.x == c.x && a.x == d.x) || (a.y == b.y && a.y == c.y && a.y == d.y) || (a.z == b.z && a.z == c.z && a.z == d.z)) return Sign::zero;
    return wellmesh::orient3d(a, b, c, d);
}
Sign PredicateFilter::insphere_within_own_box(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) {
    const auto farthest = [&](double Vec3::*axis) {
        return std::max(std::max(std::fabs(a.*axis - e.*axis), std::fabs(b.*axis - e.*axis)), std::max(std::fabs(c.*axis - e.*axis), std::fabs(d.*axis - e.*axis)));
    };
    const double bound = bound_of_insphere({farthest(&Vec3::x), farthest(&Vec3::y), farthest(&Vec3::z)});
    const double value = insphere_value(a, b, c, d, e);
    return value > bound ? Sign::positive : value < -bound ? Sign::negative : Sign::zero;
}
Sign PredicateFilter::insphere_beyond_filter(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) {
    const Sign sign = insphere_within_own_box(a, b, c, d, e);
    return sign != Sign::zero ? sign : wellmesh::insphere(a, b, c, d, e);
}
Sign PredicateFilter::insphere_perturbed_beyond_filter(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) {
    const Sign sign = insphere_within_own_box(a, b, c, d, e);
    return sign != Sign::zero ? sign : wellmesh::insphere_perturbed(a, b, c, d, e);
}

Sign PredicateFilter::power_test_beyond_filter(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& d,
                                               const WeightedPoint& e) {
    return wellmesh::power_test(a, b, c, d, e);
}

void count_exact_predicate_call() noexcept { ++exact_calls; }
std::uint64_t exact_predicate_calls() noexcept { return exact_calls; }

}  // namespace wellmesh
