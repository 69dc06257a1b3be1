// SPDX-License-Identifier: Apache-2.0
// Exact arithmetic on sums of doubles ("expansions") [Shewchuk97, sec. 2; Dekker71; Knuth69]: error-free transformations and
// the three operations that polynomials need. Exact as long as nothing over- or underflows: exact_range.hpp.
//
// An expansion is a list of non-zero doubles of increasing magnitude whose bits do not overlap; no component is zero and
// the empty list is zero, so its sign is that of its last component. All results are *compressed*: non-adjacent, and the
// last component alone is the value up to one ulp of itself. We differ from the paper in compressing after every operation:
// predicates on real input have few significant bits, and products cost the product of the lengths.
#pragma once

#include <array>
#include <cstddef>

#include "predicates/fp_environment.hpp"
#include "wellmesh/predicates.hpp"

namespace wellmesh {

/// The unevaluated sum high + low, where high is the rounded sum: |low| <= ulp(high) / 2.
struct TwoTerms {
    double high = 0, low = 0;
};

/// a + b, exactly. @pre |a| >= |b| or a == 0.
inline TwoTerms fast_two_sum(double a, double b) {
    const double sum = a + b;
    return {sum, b - (sum - a)};
}

/// a + b, exactly.
inline TwoTerms two_sum(double a, double b) {
    const double sum = a + b;
    const double b_seen = sum - a;
    const double a_seen = sum - b_seen;
    return {sum, (a - a_seen) + (b - b_seen)};
}

/// a - b, exactly.
inline TwoTerms two_difference(double a, double b) { return two_sum(a, -b); }

/// Halves of 26 bits (the sign of low is the 53rd): products of halves are exact [Dekker71]. 2^27 + 1 splits 53 bits.
inline TwoTerms split_in_halves(double a) {
    const double shifted = 134217729.0 * a;
    const double high = shifted - (shifted - a);
    return {high, a - high};
}

/// a * b, exactly, b given with its halves.
inline TwoTerms two_product(double a, double b, const TwoTerms& b_halves) {
    const double product = a * b;
    const TwoTerms a_halves = split_in_halves(a);
    const double rest = ((product - a_halves.high * b_halves.high) - a_halves.low * b_halves.high) - a_halves.high * b_halves.low;
    return {product, a_halves.low * b_halves.low - rest};
}
inline TwoTerms two_product(double a, double b) { return two_product(a, b, split_in_halves(b)); }

/// No expansion is longer: components do not share bits, and a double's bits lie at 2^-1074 ... 2^1023.
inline constexpr std::size_t kMaxComponents = 2098;

/// Writes e + factor * f (factor is 1 or -1), compressed; returns the length. `out` holds min(m + n, kMaxComponents) and
/// aliases neither argument.
std::size_t add_expansions(const double* e, std::size_t m, const double* f, std::size_t n, double factor, double* out);

/// Writes e * f, compressed; returns the length. `out` holds min(2 m n, kMaxComponents) and aliases neither argument.
std::size_t multiply_expansions(const double* e, std::size_t m, const double* f, std::size_t n, double* out);

/// x * y - z as this library's compiler flags evaluate it: two roundings if they are right, one if they fuse. For tests.
[[nodiscard]] double multiply_then_subtract(double x, double y, double z);

/// An expansion of at most N components, on the stack.
template <std::size_t N>
class Expansion {
public:
    Expansion() = default;
    explicit Expansion(double value) { push_back(value); }
    explicit Expansion(const TwoTerms& value)
        requires(N >= 2)
    {
        push_back(value.low);
        push_back(value.high);
    }

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] const double* data() const { return components_; }
    [[nodiscard]] double estimate() const { return size_ == 0 ? 0 : components_[size_ - 1]; }  ///< within 1 ulp of itself
    [[nodiscard]] Sign sign() const {
        const double last = estimate();
        return last > 0 ? Sign::positive : last < 0 ? Sign::negative : Sign::zero;
    }

    template <std::size_t M>
    friend auto operator+(const Expansion& e, const Expansion<M>& f) {
        return Expansion<capped(N + M)>::sum(e, f, 1);
    }
    template <std::size_t M>
    friend auto operator-(const Expansion& e, const Expansion<M>& f) {
        return Expansion<capped(N + M)>::sum(e, f, -1);
    }
    template <std::size_t M>
    friend auto operator*(const Expansion& e, const Expansion<M>& f) {
        return Expansion<capped(2 * N * M)>::product(e, f);
    }

    template <std::size_t A, std::size_t B>
    static Expansion sum(const Expansion<A>& e, const Expansion<B>& f, double factor) {
        Expansion result;
        result.size_ = add_expansions(e.data(), e.size(), f.data(), f.size(), factor, result.components_);
        return result;
    }
    template <std::size_t A, std::size_t B>
    static Expansion product(const Expansion<A>& e, const Expansion<B>& f) {
        Expansion result;
        if constexpr (A == 1 && B == 1) {  // half of all products when differences are exact
            if (e.size() != 0 && f.size() != 0) {
                const TwoTerms product = two_product(e.data()[0], f.data()[0]);
                result.push_back(product.low);
                result.push_back(product.high);
            }
            return result;
        }
        result.size_ = multiply_expansions(e.data(), e.size(), f.data(), f.size(), result.components_);
        return result;
    }

private:
    static constexpr std::size_t capped(std::size_t n) { return n < kMaxComponents ? n : kMaxComponents; }
    void push_back(double value) {
        if (value != 0) components_[size_++] = value;
    }

    std::size_t size_ = 0;
    double components_[N];  // NOLINT: deliberately not initialised, only the first size_ mean something
};

}  // namespace wellmesh
