// SPDX-License-Identifier: Apache-2.0
// The rungs below the static filter, once for all formulas.
//
// Notation: eps = 2^-53 bounds the relative error of a rounding. A difference u is exactly h + t, h rounded and |t| <= eps |h|.
// P is the permanent: the formula with every coefficient and argument replaced by its absolute value. Everything is scaled
// by kDifferenceScale, so underflow costs nothing and all errors are relative (exact_range.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

#include "predicates/exact_range.hpp"
#include "predicates/expansion.hpp"
#include "predicates/formulas.hpp"
#include "predicates/predicates_internal.hpp"

namespace wellmesh {

inline std::optional<Sign> negated(std::optional<Sign> sign) {
    if (sign) sign = -*sign;
    return sign;
}
inline Decision negated(Decision decision) { return {-decision.sign, decision.rung}; }

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

/// Double-double arithmetic without branches: high + low with |low| <= eps |high|. Errors, to first order in eps^2 (what is
/// of third order fits into the next integer):
///   sum: x.low + y.low and adding it to the sum's own error, at most eps (|x| + |y|) each before rounding, cost 1 + 2 eps^2;
///     so at most 4 eps^2 (|x| + |y|). Cancellation is no matter: everything is measured against magnitudes.
///   product: the neglected x.low y.low costs 1, the two rounded cross products 1 each, their sum 2, adding it 3 eps^2 |x y|;
///     so at most 9 eps^2 |x y|.
struct DoubleDouble {
    double high = 0, low = 0;
    friend DoubleDouble operator+(const DoubleDouble& x, const DoubleDouble& y) {
        const TwoTerms sum = two_sum(x.high, y.high);
        const TwoTerms result = two_sum(sum.high, sum.low + (x.low + y.low));
        return {result.high, result.low};
    }
    friend DoubleDouble operator-(const DoubleDouble& x, const DoubleDouble& y) { return x + DoubleDouble{-y.high, -y.low}; }
    friend DoubleDouble operator*(const DoubleDouble& x, const DoubleDouble& y) {
        const TwoTerms product = two_product(x.high, y.high);
        const TwoTerms result = fast_two_sum(product.high, product.low + (x.high * y.low + x.low * y.high));
        return {result.high, result.low};
    }
};

/// The largest power of two that divides `value`, which is not zero nor subnormal.
inline double lowest_bit(double value) {
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(value);
    const int zeros = std::countr_zero(bits | (std::uint64_t{1} << 52));
    // 2^(exponent - 52 + zeros), by its own bits; in range the exponent never gets near the ends of its field
    return std::bit_cast<double>((bits & 0x7ff0000000000000) - (static_cast<std::uint64_t>(52 - zeros) << 52));
}

/// The largest power of two whose square divides `value`, which is not zero nor subnormal.
inline double root_of_lowest_bit(double value) {
    const int exponent = std::ilogb(lowest_bit(value));
    return std::ldexp(1.0, exponent >= 0 ? exponent / 2 : -((1 - exponent) / 2));
}

// What the ladder does with differences of points and of weighted points.

inline Triple<double> scaled_difference(const Vec3& p, const Vec3& origin) {
    return {kDifferenceScale * (p.x - origin.x), kDifferenceScale * (p.y - origin.y), kDifferenceScale * (p.z - origin.z)};
}
inline Quadruple<double> scaled_difference(const WeightedPoint& p, const WeightedPoint& origin) {
    const Triple<double> d = scaled_difference(p.point, origin.point);
    return {d.x, d.y, d.z, kDifferenceScale * kDifferenceScale * (p.weight - origin.weight)};
}

/// What the rounding of scaled_difference loses.
inline Triple<double> scaled_tail(const Vec3& p, const Vec3& origin) {
    return {kDifferenceScale * two_difference(p.x, origin.x).low, kDifferenceScale * two_difference(p.y, origin.y).low,
            kDifferenceScale * two_difference(p.z, origin.z).low};
}
inline Quadruple<double> scaled_tail(const WeightedPoint& p, const WeightedPoint& origin) {
    const Triple<double> t = scaled_tail(p.point, origin.point);
    return {t.x, t.y, t.z, kDifferenceScale * kDifferenceScale * two_difference(p.weight, origin.weight).low};
}

inline bool any_not_zero(const Triple<double>& p) { return p.x != 0 || p.y != 0 || p.z != 0; }
inline bool any_not_zero(const Quadruple<double>& p) { return p.x != 0 || p.y != 0 || p.z != 0 || p.w != 0; }

/// The largest power of two q, up to `limit`, of which the components are multiples, and the weight of q^2.
inline double common_unit(const Triple<double>& p, double limit) {
    for (const double component : {p.x, p.y, p.z})
        if (component != 0) limit = std::min(limit, lowest_bit(component));
    return limit;
}
inline double common_unit(const Quadruple<double>& p, double limit) {
    limit = common_unit(Triple<double>{p.x, p.y, p.z}, limit);
    return p.w != 0 ? std::min(limit, root_of_lowest_bit(p.w)) : limit;
}

/// Component by component from a rounded difference and what it lost.
template <class T, class Convert>
Triple<T> convert_components(const Triple<double>& head, const Triple<double>& tail, Convert convert) {
    return {convert(head.x, tail.x), convert(head.y, tail.y), convert(head.z, tail.z)};
}
template <class T, class Convert>
Quadruple<T> convert_components(const Quadruple<double>& head, const Quadruple<double>& tail, Convert convert) {
    return {convert(head.x, tail.x), convert(head.y, tail.y), convert(head.z, tail.z), convert(head.w, tail.w)};
}

template <class Formula>
class Ladder {
public:
    static constexpr std::size_t kArguments = Formula::kArguments;
    using Point = typename Formula::Point;
    using Points = std::array<const Point*, kArguments>;

    /// The arguments are the differences points[i] - origin.
    Ladder(const Points& points, const Point& origin) {
        for (std::size_t i = 0; i < kArguments; ++i) heads_[i] = scaled_difference(*points[i], origin);
    }

    /// Error of the value over doubles: each monomial carries at most kRoundings factors (1 + delta), |delta| <= eps.
    [[nodiscard]] std::optional<Sign> forward_bound() {
        value_ = Formula::value(heads_);
        permanent_ = Formula::value(convert<Magnitude>([](double head, double) { return Magnitude{std::fabs(head)}; })).value;
        const double bound = bound_of_roundings(Formula::kRoundings) * permanent_;
        if (value_ > bound) return Sign::positive;
        if (value_ < -bound) return Sign::negative;
        if (permanent_ == 0) return Sign::zero;  // every monomial has a factor that is exactly zero (a difference is zero iff rounded so)
        return std::nullopt;
    }

    /// Doubles that happen to be exact: all differences are representable multiples of a power of two q, and P < 2^53 q^d.
    /// An intermediate value of degree k is a multiple of q^k, thus exact if the sum of its absolute monomials is below 2^53 q^k.
    /// That holds where the value matters: it is multiplied by a cofactor of degree d - k, which is either zero (then so is the
    /// exact product, whatever the value) or has absolute monomials of at least q^(d-k), and the product of the two sums is a
    /// part of P. 2^52 leaves room for the rounding of P where P is too large. Grids and hand-made input come here with ties.
    /// @pre forward_bound, find_tails
    [[nodiscard]] std::optional<Sign> exact_doubles() const {
        if (has_tails_) return std::nullopt;
        double q = kDifferenceScale * kMaxMagnitude;
        for (const Argument<double>& head : heads_) q = common_unit(head, q);
        double limit = 0x1p52;
        for (int i = 0; i < Formula::kDegree; ++i) limit *= q;
        if (!(permanent_ < limit)) return std::nullopt;
        return value_ > 0 ? Sign::positive : value_ < 0 ? Sign::negative : Sign::zero;
    }

    void find_tails(const Points& points, const Point& origin) {
        has_tails_ = false;
        for (std::size_t i = 0; i < kArguments; ++i) {
            tails_[i] = scaled_tail(*points[i], origin);
            has_tails_ = has_tails_ || any_not_zero(tails_[i]);
        }
    }

    /// Differences are exact double-doubles, so a monomial passes through fewer than kRoundings operations; each costs at most
    /// 9 eps^2 of it. 10 leaves room for third-order terms and for the rounding of P, both of the order of kRoundings eps.
    /// @pre forward_bound, find_tails
    [[nodiscard]] std::optional<Sign> double_double() const {
        const auto differences = convert<DoubleDouble>([](double head, double tail) { return DoubleDouble{head, tail}; });
        const double value = Formula::value(differences).high;  // relative error eps, well within the bound's room
        const double bound = 10 * Formula::kRoundings * kEpsilon * kEpsilon * permanent_;
        if (value > bound) return Sign::positive;
        if (value < -bound) return Sign::negative;
        return std::nullopt;
    }

    /// The last resort. Takes up to 250 kB of stack (equatorial test, optimised build), of which little is ever touched.
    /// @pre find_tails
    [[nodiscard]] Sign exact() const {
        if (!has_tails_) return Formula::value(convert<Expansion<1>>([](double head, double) { return Expansion<1>(head); })).sign();
        return Formula::value(convert<Expansion<2>>([](double head, double tail) { return Expansion<2>(TwoTerms{head, tail}); })).sign();
    }

private:
    template <class T>
    using Argument = typename Formula::template Argument<T>;

    /// @param component  of a rounded component and what it lost (which means nothing before find_tails).
    template <class T, class Component>
    [[nodiscard]] std::array<Argument<T>, kArguments> convert(Component component) const {
        std::array<Argument<T>, kArguments> result;
        for (std::size_t i = 0; i < kArguments; ++i) result[i] = convert_components<T>(heads_[i], tails_[i], component);
        return result;
    }

    std::array<Argument<double>, kArguments> heads_{}, tails_{};
    double value_ = 0, permanent_ = 0;
    bool has_tails_ = false;
};

void count_exact_predicate_call() noexcept;

/// The slow rungs, kept out of the callers' instruction stream.
template <class Formula>
[[gnu::noinline]] Decision climb_slowly(Ladder<Formula>& ladder, const typename Ladder<Formula>::Points& points, const typename Formula::Point& origin) {
    ladder.find_tails(points, origin);
    if (const auto sign = ladder.exact_doubles()) return {*sign, Rung::exact_doubles};
    if (const auto sign = ladder.double_double()) return {*sign, Rung::double_double};
    count_exact_predicate_call();
    return {ladder.exact(), Rung::exact};
}

template <class Formula>
Decision climb(const typename Ladder<Formula>::Points& points, const typename Formula::Point& origin) {
    Ladder<Formula> ladder(points, origin);
    if (const auto sign = ladder.forward_bound()) return {*sign, Rung::forward_bound};
    return climb_slowly(ladder, points, origin);
}

/// One rung alone, for tests.
template <class Formula>
std::optional<Sign> single_rung(Rung rung, const typename Ladder<Formula>::Points& points, const typename Formula::Point& origin) {
    Ladder<Formula> ladder(points, origin);
    const auto from_forward_bound = ladder.forward_bound();
    ladder.find_tails(points, origin);
    switch (rung) {
        case Rung::forward_bound: return from_forward_bound;
        case Rung::exact_doubles: return ladder.exact_doubles();
        case Rung::double_double: return ladder.double_double();
        case Rung::exact: return ladder.exact();
        case Rung::static_filter:
        case Rung::perturbation: break;
    }
    return std::nullopt;
}

}  // namespace wellmesh
