// SPDX-License-Identifier: Apache-2.0
// Biased randomised insertion order [Amenta03] with a Hilbert curve in each round [Skilling04 gives the transform].
#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "core/rng.hpp"
#include "delaunay/spatial_order.hpp"

namespace wellmesh {
namespace {

constexpr unsigned kBits = 20;  // a coordinate; 60 bits a key

/// Position along the Hilbert curve: Skilling's transform of the axes, then their bits interleaved.
std::uint64_t hilbert_key(std::array<std::uint32_t, 3> x) {
    for (std::uint32_t q = 1U << (kBits - 1); q > 1; q >>= 1) {
        const std::uint32_t p = q - 1;
        for (std::size_t i = 0; i < 3; ++i) {
            if (x[i] & q) {
                x[0] ^= p;
            } else {
                const std::uint32_t t = (x[0] ^ x[i]) & p;
                x[0] ^= t;
                x[i] ^= t;
            }
        }
    }
    x[1] ^= x[0];
    x[2] ^= x[1];
    std::uint32_t t = 0;
    for (std::uint32_t q = 1U << (kBits - 1); q > 1; q >>= 1)
        if (x[2] & q) t ^= q - 1;
    for (std::uint32_t& c : x) c ^= t;
    std::uint64_t key = 0;
    for (unsigned b = kBits; b-- > 0;)
        for (const std::uint32_t c : x) key = (key << 1) | ((c >> b) & 1U);
    return key;
}

/// Points by the round that `round_of` puts them in (below 16), then along the curve.
template <class RoundOf>
std::vector<std::uint32_t> order_by_rounds(std::span<const Vec3> points, RoundOf&& round_of) {
    const std::size_t n = points.size();
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keyed(n);
    if (n == 0) return {};
    Vec3 lo = points[0], hi = points[0];
    for (const Vec3& p : points) {
        lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
        hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
    }
    const double extent = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z});
    const double scale = extent > 0 ? static_cast<double>((1U << kBits) - 1) / extent : 0;
    constexpr std::uint64_t kRoundShift = 3 * kBits;
    for (std::size_t i = 0; i < n; ++i) {
        const Vec3& p = points[i];
        const std::array<std::uint32_t, 3> cell{static_cast<std::uint32_t>((p.x - lo.x) * scale), static_cast<std::uint32_t>((p.y - lo.y) * scale),
                                                static_cast<std::uint32_t>((p.z - lo.z) * scale)};
        keyed[i] = {(std::uint64_t{round_of(i)} << kRoundShift) | hilbert_key(cell), static_cast<std::uint32_t>(i)};
    }
    std::sort(keyed.begin(), keyed.end());
    std::vector<std::uint32_t> order(n);
    for (std::size_t i = 0; i < n; ++i) order[i] = keyed[i].second;
    return order;
}

}  // namespace

std::vector<std::uint32_t> spatial_order(std::span<const Vec3> points) {
    return order_by_rounds(points, [](std::size_t) { return 0U; });
}

std::vector<std::uint32_t> biased_spatial_order(std::span<const Vec3> points) {
    // A point is in the last round with probability 7/8, in the one before with 7/64, ... [Amenta03]; few rounds are enough.
    constexpr unsigned kRounds = 8;
    return order_by_rounds(points, [](std::size_t i) {
        const auto octets = static_cast<unsigned>(std::countr_zero(mix64(i) | (std::uint64_t{1} << 63))) / 3;
        return kRounds - 1 - std::min(octets, kRounds - 1);
    });
}

}  // namespace wellmesh
