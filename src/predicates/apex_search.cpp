// SPDX-License-Identifier: Apache-2.0
// The spheres through the face have their centres on a line; empty of the points in front is the one whose centre comes first. That
// one is found in rounded arithmetic without bounds, and holds because its sphere is then tested against all.
//
// Bounds. n.d is a sum of Orient3dFormula's monomials with as many roundings: n 4 with its differences, difference 1, product 1, sums 2.
// The monomials of k.d - (n.e) |d|^2 are those of |e|^2 (n.d), |d|^2 (n.e), |u|^2 [v e d] and |v|^2 [u e d]: at most 4 squared diagonals
// times 6 XYZ, as in predicate_filter.cpp. Roundings: a square 5, m 8, m x e 11, k 12; (n.e) |d|^2 8 + 5 + 1. Summed in pairs, k_x d_x
// and k_y d_y undergo 12 + 2 + 2, k_z d_z and the last term no more: 16, as in InsphereFormula. Fused operations only leave some out.
// Underflow, too, is as there: at most three differences follow any product.
#include "predicates/apex_search.hpp"

#include <algorithm>

#include "core/infinity.hpp"
#include "predicates/fp_environment.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#define WELLMESH_HAS_AVX2_TARGET 1
#endif

namespace wellmesh {
namespace {

[[gnu::always_inline]] inline Vec3 minus(const Vec3& p, const Vec3& q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }
[[gnu::always_inline]] inline double product(const Vec3& p, const Vec3& q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
[[gnu::always_inline]] inline Vec3 normal_to(const Vec3& p, const Vec3& q) {
    return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}

/// Of the face alone.
struct Frame {
    Vec3 a, n, m;
    // Twice the centre of the face's circle is to_centre / nn: for nomination only.
    double nn;
    Vec3 to_centre;

    [[gnu::always_inline]] Frame(const PointColumns& points, const std::array<std::uint32_t, 3>& face) : a(points[face[0]]) {
        const Vec3 u = minus(points[face[1]], a), v = minus(points[face[2]], a);
        const double uu = product(u, u), vv = product(v, v);
        n = normal_to(u, v);
        m = {uu * v.x - vv * u.x, uu * v.y - vv * u.y, uu * v.z - vv * u.z};
        nn = product(n, n);
        to_centre = normal_to(m, n);
    }
};

/// Of the sphere through the face and e: d's determinant is k.d - height |d|^2.
struct Sphere {
    Vec3 k;
    double height;

    [[gnu::always_inline]] Sphere(const Frame& f, const Vec3& nominee) {
        const Vec3 e = minus(nominee, f.a), g = normal_to(f.m, e);
        const double ee = product(e, e);
        k = {ee * f.n.x + g.x, ee * f.n.y + g.y, ee * f.n.z + g.z};
        height = product(f.n, e);
    }
};

/// Takes the four corners' bits out of 64 points', and lists the others.
[[gnu::always_inline]] inline void list_bits(std::uint64_t bits, std::size_t first, const std::array<std::uint32_t, 3>& face, std::uint32_t nominee,
                                             std::vector<std::uint32_t>& out) {
    for (const std::uint32_t i : {face[0], face[1], face[2], nominee})
        if (i / 64 == first / 64) bits &= ~(std::uint64_t{1} << (i % 64));
    for (; bits != 0; bits &= bits - 1) out.push_back(static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(__builtin_ctzll(bits)));
}

}  // namespace

std::uint32_t ApexSearch::nominate(std::vector<std::uint32_t>& rivals) const {
    rivals.clear();
    const Frame f(points, face);
    std::uint32_t nominee = kNobody;
    double first = kInfinity;
    for (std::uint32_t i = 0; i < points.rows(); ++i) {
        const Vec3 d = minus(points[i], f.a);
        const double height = product(f.n, d), centre = (f.nn * product(d, d) - product(f.to_centre, d)) / height;
        if (height > orient3d_bound && centre < first) {
            first = centre;
            nominee = i;
        }
    }
    const bool has_nominee = nominee != kNobody;
    const Sphere s(f, has_nominee ? points[nominee] : f.a);
    for (std::uint32_t i = 0; i < points.rows(); ++i) {
        const Vec3 d = minus(points[i], f.a);
        const double value = (s.k.x * d.x + s.k.y * d.y) + (s.k.z * d.z - s.height * product(d, d));
        const bool is_rival = product(f.n, d) >= -orient3d_bound && (!has_nominee || value >= -insphere_bound);
        if (is_rival && i != nominee && std::find(face.begin(), face.end(), i) == face.end()) rivals.push_back(i);
    }
    return nominee;
}

#ifdef WELLMESH_HAS_AVX2_TARGET

namespace {

struct Lanes {
    __m256d x, y, z;

    [[gnu::target("avx2,fma"), gnu::always_inline]] explicit Lanes(const Vec3& p) : x(_mm256_set1_pd(p.x)), y(_mm256_set1_pd(p.y)), z(_mm256_set1_pd(p.z)) {}
    /// Four points, relative to another.
    [[gnu::target("avx2,fma"), gnu::always_inline]] Lanes(const PointColumns& points, std::size_t i, const Lanes& a)
        : x(_mm256_sub_pd(_mm256_loadu_pd(points.x() + i), a.x)), y(_mm256_sub_pd(_mm256_loadu_pd(points.y() + i), a.y)),
          z(_mm256_sub_pd(_mm256_loadu_pd(points.z() + i), a.z)) {}
};

[[gnu::target("avx2,fma"), gnu::always_inline]] inline __m256d product(const Lanes& p, const Lanes& q) {
    return _mm256_fmadd_pd(p.z, q.z, _mm256_fmadd_pd(p.y, q.y, _mm256_mul_pd(p.x, q.x)));
}

}  // namespace

[[gnu::target("avx2,fma")]] std::uint32_t ApexSearch::nominate_in_lanes(std::vector<std::uint32_t>& rivals) const {
    rivals.clear();
    const Frame f(points, face);
    const Lanes a(f.a), n(f.n), to_centre(f.to_centre);
    const __m256d nn = _mm256_set1_pd(f.nn);
    const std::size_t rows = points.rows();
    const __m256d least = _mm256_set1_pd(orient3d_bound), four = _mm256_set1_pd(4);
    __m256d first = _mm256_set1_pd(kInfinity), at = _mm256_setzero_pd(), numbers = _mm256_setr_pd(0, 1, 2, 3);
    for (std::size_t i = 0; i < rows; i += PointColumns::kLanes) {
        const Lanes d(points, i, a);
        const __m256d height = product(n, d), centre = _mm256_div_pd(_mm256_fmsub_pd(nn, product(d, d), product(to_centre, d)), height);
        const __m256d better = _mm256_and_pd(_mm256_cmp_pd(height, least, _CMP_GT_OQ), _mm256_cmp_pd(centre, first, _CMP_LT_OQ));
        first = _mm256_blendv_pd(first, centre, better);
        at = _mm256_blendv_pd(at, numbers, better);
        numbers = _mm256_add_pd(numbers, four);
    }
    std::array<double, 4> centres, which;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled at once
    _mm256_storeu_pd(centres.data(), first);
    _mm256_storeu_pd(which.data(), at);
    std::size_t best = 0;
    for (std::size_t k = 1; k < 4; ++k)
        if (centres[k] < centres[best]) best = k;
    const bool has_nominee = centres[best] < kInfinity;
    const std::uint32_t nominee = has_nominee ? static_cast<std::uint32_t>(which[best]) : kNobody;

    const Sphere s(f, has_nominee ? points[nominee] : f.a);
    const Lanes k(s.k);
    const __m256d s_height = _mm256_set1_pd(s.height), behind = _mm256_set1_pd(-orient3d_bound);
    const __m256d outside = _mm256_set1_pd(has_nominee ? -insphere_bound : -kInfinity);
    for (std::size_t word = 0; word < rows; word += 64) {
        std::uint64_t bits = 0;
        for (std::size_t i = word; i < std::min(word + 64, rows); i += PointColumns::kLanes) {
            const Lanes d(points, i, a);
            const __m256d xy = _mm256_fmadd_pd(k.y, d.y, _mm256_mul_pd(k.x, d.x));
            const __m256d value = _mm256_add_pd(xy, _mm256_fmsub_pd(k.z, d.z, _mm256_mul_pd(s_height, product(d, d))));
            const __m256d rival = _mm256_and_pd(_mm256_cmp_pd(product(n, d), behind, _CMP_GE_OQ), _mm256_cmp_pd(value, outside, _CMP_GE_OQ));
            bits |= static_cast<std::uint64_t>(static_cast<unsigned>(_mm256_movemask_pd(rival))) << (i - word);
        }
        list_bits(bits, word, face, nominee, rivals);
    }
    return nominee;
}

#else

std::uint32_t ApexSearch::nominate_in_lanes(std::vector<std::uint32_t>&) const { return kNobody; }

#endif

}  // namespace wellmesh
