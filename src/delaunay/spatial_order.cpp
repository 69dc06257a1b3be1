// SPDX-License-Identifier: Apache-2.0
// Biased randomised insertion order [Amenta03] with a Hilbert curve in each round [Hamilton08].
#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <utility>
#include <vector>

#include "core/huge_pages.hpp"
#include "core/rng.hpp"
#include "core/shared_array.hpp"
#include "delaunay/spatial_order.hpp"

namespace wellmesh {
namespace {

constexpr unsigned kBits = 20;  // a coordinate; 60 bits a key

/// One step down the Hilbert curve: the state is how the curve runs through a cube, an octant is three bits x, y, z of the coordinates.
struct HilbertStep {
    std::uint8_t position = 0;  // of the octant along the curve
    std::uint8_t next = 0;      // state within the octant
};
constexpr std::size_t kHilbertStates = 24;  // corner where the curve enters (8) times direction in which it leaves (3)
using HilbertTable = std::array<std::array<HilbertStep, 8>, kHilbertStates>;

/// [Hamilton08], section 2: Gray codes, rotated so that the curve enters at corner e and leaves along axis d.
constexpr HilbertTable make_hilbert_table() {
    const auto rotate_left = [](unsigned x, unsigned k) { return ((x << (k % 3)) | (x >> (3 - k % 3))) & 7U; };
    const auto rotate_right = [rotate_left](unsigned x, unsigned k) { return rotate_left(x, 3 - k % 3); };
    const auto gray = [](unsigned i) { return i ^ (i >> 1); };
    const auto gray_inverse = [](unsigned g) { return g ^ (g >> 1) ^ (g >> 2); };
    const auto trailing_ones = [](unsigned i) { return static_cast<unsigned>(std::countr_one(i)); };
    HilbertTable table{};
    for (unsigned e = 0; e < 8; ++e)
        for (unsigned d = 0; d < 3; ++d)
            for (unsigned octant = 0; octant < 8; ++octant) {
                const unsigned w = gray_inverse(rotate_right(octant ^ e, d + 1));
                const unsigned entry = w == 0 ? 0 : gray(2 * ((w - 1) / 2));
                const unsigned direction = w == 0 ? 0 : w % 2 == 0 ? trailing_ones(w - 1) % 3 : trailing_ones(w) % 3;
                const unsigned next_e = e ^ rotate_left(entry, d + 1), next_d = (d + direction + 1) % 3;
                table[3 * e + d][octant] = {static_cast<std::uint8_t>(w), static_cast<std::uint8_t>(3 * next_e + next_d)};
            }
    return table;
}
constexpr HilbertTable kHilbert = make_hilbert_table();

/// Position along the Hilbert curve.
std::uint64_t hilbert_key(const std::array<std::uint32_t, 3>& x) {
    std::uint64_t key = 0;
    std::size_t state = 0;
    for (unsigned b = kBits; b-- > 0;) {
        const HilbertStep step = kHilbert[state][((x[0] >> b) & 1U) | ((x[1] >> b) & 1U) << 1 | ((x[2] >> b) & 1U) << 2];
        key = (key << 3) | step.position;
        state = step.next;
    }
    return key;
}

struct Keyed {
    std::uint64_t key;
    std::uint32_t point;
    friend bool operator<(const Keyed& a, const Keyed& b) { return std::pair(a.key, a.point) < std::pair(b.key, b.point); }
};

/// Sorts by keys, equal ones staying in order: digit by digit from the last one, for it branches on nothing. Few, the points of one facet, are sorted before its
/// tables would be cleared.
void sort_by_key(std::span<Keyed> run) {
    constexpr std::size_t kFew = 512;
    if (run.size() <= kFew) {
        std::stable_sort(run.begin(), run.end(), [](const Keyed& a, const Keyed& b) { return a.key < b.key; });
        return;
    }
    constexpr unsigned kDigitBits = 11, kDigits = (64 + kDigitBits - 1) / kDigitBits;
    constexpr std::size_t kValues = std::size_t{1} << kDigitBits;
    const auto digit_of = [](std::uint64_t key, unsigned d) { return static_cast<std::size_t>(key >> (d * kDigitBits)) % kValues; };
    std::vector<std::array<std::uint32_t, kValues>> place(kDigits);
    for (const Keyed& k : run)
        for (unsigned d = 0; d < kDigits; ++d) ++place[d][digit_of(k.key, d)];
    SharedArray<Keyed> other;
    other.resize_as_is(run.size());
    std::span<Keyed> from = run, to{other.data(), other.size()};
    for (unsigned d = 0; d < kDigits; ++d) {
        if (!run.empty() && place[d][digit_of(run[0].key, d)] == run.size()) continue;  // the same everywhere
        std::uint32_t total = 0;
        for (std::uint32_t& p : place[d]) total += std::exchange(p, total);
        for (const Keyed& k : from) to[place[d][digit_of(k.key, d)]++] = k;
        std::swap(from, to);
    }
    if (from.data() != run.data()) std::copy(from.begin(), from.end(), run.begin());
}

/// Points by the round that `round_of` puts them in (below 16), then along the curve.
template <class RoundOf>
std::vector<std::uint32_t> order_by_rounds(std::span<const Vec3> points, Workers& workers, RoundOf&& round_of) {
    const std::size_t n = points.size();
    if (n == 0) return {};
    Vec3 lo = points[0], hi = points[0];
    for (const Vec3& p : points) {
        lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
        hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
    }
    const double extent = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z});
    const double scale = extent > 0 ? static_cast<double>((1U << kBits) - 1) / extent : 0;
    constexpr std::uint64_t kRoundShift = 3 * kBits;
    SharedArray<Keyed> keyed;
    keyed.resize_as_is(n);
    // Each worker sorts a run; then neighbouring runs are merged, in rounds.
    std::size_t run = (n + workers.threads() - 1) / workers.threads();
    workers.for_ranges(n, run, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3& p = points[i];
            const std::array<std::uint32_t, 3> cell{static_cast<std::uint32_t>((p.x - lo.x) * scale), static_cast<std::uint32_t>((p.y - lo.y) * scale),
                                                    static_cast<std::uint32_t>((p.z - lo.z) * scale)};
            keyed[i] = {(std::uint64_t{round_of(i)} << kRoundShift) | hilbert_key(cell), static_cast<std::uint32_t>(i)};
        }
        sort_by_key({keyed.data() + begin, end - begin});
    });
    for (; run < n; run *= 2)
        workers.for_ranges(n, 2 * run, [&](std::size_t begin, std::size_t end, std::size_t) {
            const auto at = [&](std::size_t i) { return keyed.data() + std::min(i, end); };
            std::inplace_merge(at(begin), at(begin + run), at(end));
        });
    std::vector<std::uint32_t> order;
    reserve_on_huge_pages(order, n);
    order.resize(n);
    for (std::size_t i = 0; i < n; ++i) order[i] = keyed[i].point;
    return order;
}

}  // namespace

std::vector<std::uint32_t> spatial_order(std::span<const Vec3> points, Workers& workers) {
    return order_by_rounds(points, workers, [](std::size_t) { return 0U; });
}

std::vector<std::uint32_t> biased_spatial_order(std::span<const Vec3> points, Workers& workers) {
    // A point is in the last round with probability 7/8, in the one before with 7/64, ... [Amenta03]; few rounds are enough.
    constexpr unsigned kRounds = 8;
    return order_by_rounds(points, workers, [](std::size_t i) {
        const auto octets = static_cast<unsigned>(std::countr_zero(mix64(i) | (std::uint64_t{1} << 63))) / 3;
        return kRounds - 1 - std::min(octets, kRounds - 1);
    });
}

std::vector<std::uint32_t> spatial_order(std::span<const Vec3> points) {
    Workers alone(1);
    return spatial_order(points, alone);
}

std::vector<std::uint32_t> biased_spatial_order(std::span<const Vec3> points) {
    Workers alone(1);
    return biased_spatial_order(points, alone);
}

}  // namespace wellmesh
