// SPDX-License-Identifier: Apache-2.0
// The rungs below the static filter, once for all formulas.
//
// Notation: eps = 2^-53 bounds the relative error of a rounding. A difference u is exactly h + t, h rounded and |t| <= eps |h|.
// P is the permanent: the formula with every coefficient and argument replaced by its absolute value. Everything is scaled
// by kDifferenceScale, so underflow costs nothing and all errors are relative (exact_range.hpp).
#pragma once

#include <cmath>
#include <optional>

#include "predicates/exact_range.hpp"
#include "predicates/expansion.hpp"
#include "predicates/formulas.hpp"
#include "predicates/predicates_internal.hpp"

namespace wellmesh {

inline constexpr double kEpsilon = 0x1p-53;

/// Bounds (1 + eps)^n - 1, plus the n roundings of the permanent that it will be multiplied by and a few more: for n <= 100
/// all second-order effects together are below n^2 eps^2 * 4 < n eps 2^-40.
constexpr double bound_of_roundings(int n) { return n * kEpsilon * (1 + 0x1p-40); }

/// Arithmetic of absolute values: subtraction adds.
struct Magnitude {
    double value = 0;
    friend Magnitude operator+(Magnitude p, Magnitude q) { return {p.value + q.value}; }
    friend Magnitude operator-(Magnitude p, Magnitude q) { return {p.value + q.value}; }
    friend Magnitude operator*(Magnitude p, Magnitude q) { return {p.value * q.value}; }
};

/// value + slope * (small): evaluating a polynomial at (h, t) gives its first-order change from h to h + t as slope.
struct FirstOrderPair {
    double value = 0, slope = 0;
    friend FirstOrderPair operator+(const FirstOrderPair& p, const FirstOrderPair& q) { return {p.value + q.value, p.slope + q.slope}; }
    friend FirstOrderPair operator-(const FirstOrderPair& p, const FirstOrderPair& q) { return {p.value - q.value, p.slope - q.slope}; }
    friend FirstOrderPair operator*(const FirstOrderPair& p, const FirstOrderPair& q) {
        return {p.value * q.value, p.value * q.slope + p.slope * q.value};
    }
};

template <class Formula>
class Ladder {
public:
    static constexpr std::size_t kArguments = Formula::kArguments;
    using Points = std::array<const Vec3*, kArguments>;

    /// The arguments are the differences points[i] - origin.
    Ladder(const Points& points, const Vec3& origin) {
        for (std::size_t i = 0; i < kArguments; ++i)
            heads_[i] = {kDifferenceScale * (points[i]->x - origin.x), kDifferenceScale * (points[i]->y - origin.y),
                         kDifferenceScale * (points[i]->z - origin.z)};
    }

    /// Error of the value over doubles: each monomial carries at most kRoundings factors (1 + delta), |delta| <= eps.
    [[nodiscard]] std::optional<Sign> forward_bound() {
        const double value = Formula::value(heads_);
        permanent_ = Formula::value(map<Magnitude>([](double h) { return Magnitude{std::fabs(h)}; })).value;
        const double bound = bound_of_roundings(Formula::kRoundings) * permanent_;
        if (value > bound) return Sign::positive;
        if (value < -bound) return Sign::negative;
        if (permanent_ == 0) return Sign::zero;  // every monomial has a factor that is exactly zero (a difference is zero iff rounded so)
        return std::nullopt;
    }

    void find_tails(const Points& points, const Vec3& origin) {
        has_tails_ = false;
        for (std::size_t i = 0; i < kArguments; ++i) {
            tails_[i] = {kDifferenceScale * two_difference(points[i]->x, origin.x).low, kDifferenceScale * two_difference(points[i]->y, origin.y).low,
                         kDifferenceScale * two_difference(points[i]->z, origin.z).low};
            has_tails_ = has_tails_ || tails_[i].x != 0 || tails_[i].y != 0 || tails_[i].z != 0;
        }
    }

    /// @pre find_tails
    [[nodiscard]] std::optional<Sign> exact_differences() {
        const auto value = Formula::value(map<Expansion<1>>([](double h) { return Expansion<1>(h); }));
        value_at_heads_ = value.estimate();
        if (has_tails_) return std::nullopt;
        return value.sign();
    }

    /// The formula at h + t is f(h), of which we know the sum up to 2 eps |estimate|, plus the slope, plus higher orders.
    /// Relative to P, d the degree: the slope's monomials sum to d eps at most, and each is computed with kPairRoundings;
    /// the higher orders are (1 + eps)^d - 1 - d eps < d^2 eps^2. The last sum's rounding: eps of itself, below
    /// eps (|estimate| + |slope|), of which the slope's part is below d eps^2 P (1 + ...).
    /// So the error is below (d kPairRoundings + d^2 + d) eps^2 P + 4 eps |estimate|, with a third of P's part to spare.
    /// @pre forward_bound, exact_differences
    [[nodiscard]] std::optional<Sign> first_order() const {
        constexpr int d = Formula::kDegree;
        constexpr double factor = (d * Formula::kPairRoundings + d * d + d) * (4.0 / 3.0) * kEpsilon * kEpsilon;
        std::array<Triple<FirstOrderPair>, kArguments> pairs{};
        for (std::size_t i = 0; i < kArguments; ++i)
            pairs[i] = {{heads_[i].x, tails_[i].x}, {heads_[i].y, tails_[i].y}, {heads_[i].z, tails_[i].z}};
        const double value = value_at_heads_ + Formula::value(pairs).slope;
        const double bound = factor * permanent_ + 4 * kEpsilon * std::fabs(value_at_heads_);
        if (value > bound) return Sign::positive;
        if (value < -bound) return Sign::negative;
        return std::nullopt;
    }

    /// @pre find_tails
    [[nodiscard]] Sign exact() const {
        std::array<Triple<Expansion<2>>, kArguments> differences;
        for (std::size_t i = 0; i < kArguments; ++i)
            differences[i] = {Expansion<2>(TwoTerms{heads_[i].x, tails_[i].x}), Expansion<2>(TwoTerms{heads_[i].y, tails_[i].y}),
                              Expansion<2>(TwoTerms{heads_[i].z, tails_[i].z})};
        return Formula::value(differences).sign();
    }

private:
    template <class T, class Convert>
    [[nodiscard]] std::array<Triple<T>, kArguments> map(Convert convert) const {
        std::array<Triple<T>, kArguments> result;
        for (std::size_t i = 0; i < kArguments; ++i) result[i] = {convert(heads_[i].x), convert(heads_[i].y), convert(heads_[i].z)};
        return result;
    }

    std::array<Triple<double>, kArguments> heads_, tails_;
    double permanent_ = 0, value_at_heads_ = 0;
    bool has_tails_ = false;
};

void count_exact_predicate_call() noexcept;

/// Expansion arithmetic, kept out of the callers' instruction stream.
template <class Formula>
[[gnu::noinline]] Decision climb_exact(Ladder<Formula>& ladder, const typename Ladder<Formula>::Points& points, const Vec3& origin) {
    count_exact_predicate_call();
    ladder.find_tails(points, origin);
    if (const auto sign = ladder.exact_differences()) return {*sign, Rung::exact_differences};
    if (const auto sign = ladder.first_order()) return {*sign, Rung::first_order};
    return {ladder.exact(), Rung::exact};
}

template <class Formula>
Decision climb(const typename Ladder<Formula>::Points& points, const Vec3& origin) {
    Ladder<Formula> ladder(points, origin);
    if (const auto sign = ladder.forward_bound()) return {*sign, Rung::forward_bound};
    return climb_exact(ladder, points, origin);
}

/// One rung alone, for tests.
template <class Formula>
std::optional<Sign> single_rung(Rung rung, const typename Ladder<Formula>::Points& points, const Vec3& origin) {
    Ladder<Formula> ladder(points, origin);
    const auto forward = ladder.forward_bound();
    if (rung == Rung::forward_bound) return forward;
    ladder.find_tails(points, origin);
    if (rung == Rung::exact) return ladder.exact();
    const auto from_heads = ladder.exact_differences();
    if (rung == Rung::exact_differences) return from_heads;
    if (rung == Rung::first_order) return ladder.first_order();
    return std::nullopt;
}

}  // namespace wellmesh
