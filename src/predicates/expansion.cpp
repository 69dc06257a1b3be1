// SPDX-License-Identifier: Apache-2.0
// [Shewchuk97] theorems by number: FAST-EXPANSION-SUM (13), SCALE-EXPANSION (19), COMPRESS (23), all with zero elimination.
// Invariant: compressed (non-adjacent) in, compressed out; in between, "strongly non-overlapping", which 13 and 19 keep
// under round-to-nearest-even.
#include "predicates/expansion.hpp"

#include <cmath>

namespace wellmesh {
namespace {

/// Shewchuk's COMPRESS, in place: gathers bits into as few, as full components as one pass down and one pass up find.
std::size_t compress(double* e, std::size_t n) {
    if (n < 2) return n;
    std::size_t bottom = n - 1;
    double running = e[n - 1];
    for (std::size_t i = n - 1; i-- > 0;) {
        const TwoTerms s = fast_two_sum(running, e[i]);
        running = s.high;
        if (s.low != 0) {
            e[bottom--] = s.high;
            running = s.low;
        }
    }
    e[bottom] = running;
    std::size_t top = 0;
    for (std::size_t i = bottom + 1; i < n; ++i) {
        const TwoTerms s = fast_two_sum(e[i], running);
        running = s.high;
        if (s.low != 0) e[top++] = s.low;
    }
    if (running != 0) e[top++] = running;
    return top;
}

/// FAST-EXPANSION-SUM of e and factor * f without compression.
std::size_t merge_sum(const double* e, std::size_t m, const double* f, std::size_t n, double factor, double* out) {
    std::size_t i = 0, j = 0, size = 0;
    double running = 0;
    while (i < m || j < n) {
        const bool take_e = j == n || (i < m && std::fabs(e[i]) < std::fabs(f[j]));
        const double next = take_e ? e[i++] : factor * f[j++];
        const TwoTerms s = two_sum(running, next);
        running = s.high;
        if (s.low != 0) out[size++] = s.low;
    }
    if (running != 0) out[size++] = running;
    return size;
}

/// SCALE-EXPANSION: e * b without compression; at most 2 m components.
std::size_t scale(const double* e, std::size_t m, double b, double* out) {
    const TwoTerms b_halves = split_in_halves(b);
    std::size_t size = 0;
    double running = 0;
    for (std::size_t i = 0; i < m; ++i) {
        const TwoTerms product = two_product(e[i], b, b_halves);
        const TwoTerms low = two_sum(running, product.low);
        if (low.low != 0) out[size++] = low.low;
        const TwoTerms high = fast_two_sum(product.high, low.high);
        if (high.low != 0) out[size++] = high.low;
        running = high.high;
    }
    if (running != 0) out[size++] = running;
    return size;
}

}  // namespace

double multiply_then_subtract(double x, double y, double z) { return x * y - z; }

std::size_t add_expansions(const double* e, std::size_t m, const double* f, std::size_t n, double factor, double* out) {
    return compress(out, merge_sum(e, m, f, n, factor, out));
}

std::size_t multiply_expansions(const double* e, std::size_t m, const double* f, std::size_t n, double* out) {
    if (m < n) return multiply_expansions(f, n, e, m, out);
    if (n == 0) return 0;
    std::size_t size = scale(e, m, f[0], out);
    if (n == 1) return compress(out, size);
    double partial[kMaxComponents], row[kMaxComponents];  // not initialised: only what is used costs anything
    for (std::size_t j = 1; j < n; ++j) {
        for (std::size_t i = 0; i < size; ++i) partial[i] = out[i];
        const std::size_t row_size = scale(e, m, f[j], row);
        size = merge_sum(partial, size, row, row_size, 1, out);
    }
    return compress(out, size);
}

}  // namespace wellmesh
