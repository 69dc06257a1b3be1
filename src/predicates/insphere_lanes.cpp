// SPDX-License-Identifier: Apache-2.0
// The 4 x 4 determinant by rotated lanes: lane i of X, Y, Z and L (the lift) belongs to point i of a, b, c, d, and one vector operation
// makes four 2 x 2 or four 3 x 3 minors. Explicit target attribute: the rest of the program keeps running on processors without AVX2.
#include "predicates/insphere_lanes.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#define WELLMESH_HAS_AVX2_TARGET 1
#endif

namespace wellmesh {

#ifdef WELLMESH_HAS_AVX2_TARGET

bool has_insphere_lanes() noexcept {
    static const bool has = __builtin_cpu_supports("avx2") != 0;
    return has;
}

[[gnu::target("avx2")]] double insphere_value_in_lanes(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) noexcept {
    const __m256d row_a = _mm256_load_pd(&a.x), row_b = _mm256_load_pd(&b.x);
    const __m256d row_c = _mm256_load_pd(&c.x), row_d = _mm256_load_pd(&d.x);
    // Transpose. The fourth column is whatever lies behind the points: it is dropped before any arithmetic.
    const __m256d xz_ab = _mm256_unpacklo_pd(row_a, row_b), xz_cd = _mm256_unpacklo_pd(row_c, row_d);
    const __m256d y_ab = _mm256_unpackhi_pd(row_a, row_b), y_cd = _mm256_unpackhi_pd(row_c, row_d);
    const __m256d x = _mm256_sub_pd(_mm256_permute2f128_pd(xz_ab, xz_cd, 0x20), _mm256_broadcast_sd(&e.x));
    const __m256d y = _mm256_sub_pd(_mm256_permute2f128_pd(y_ab, y_cd, 0x20), _mm256_broadcast_sd(&e.y));
    const __m256d z = _mm256_sub_pd(_mm256_permute2f128_pd(xz_ab, xz_cd, 0x31), _mm256_broadcast_sd(&e.z));
    constexpr int kNext = 0b00'11'10'01, kSecond = 0b01'00'11'10, kPrevious = 0b10'01'00'11;  // lane i takes lane i + 1, i + 2, i - 1
    // (ab, bc, cd, -ad) and (ac, bd, -ac, -bd)
    const __m256d next_x = _mm256_permute4x64_pd(x, kNext), next_y = _mm256_permute4x64_pd(y, kNext), next_z = _mm256_permute4x64_pd(z, kNext);
    const __m256d second_x = _mm256_permute4x64_pd(x, kSecond), second_y = _mm256_permute4x64_pd(y, kSecond), second_z = _mm256_permute4x64_pd(z, kSecond);
    const __m256d adjacent = _mm256_sub_pd(_mm256_mul_pd(x, next_y), _mm256_mul_pd(next_x, y));
    const __m256d opposite = _mm256_sub_pd(_mm256_mul_pd(x, second_y), _mm256_mul_pd(second_x, y));
    // (abc, bcd, acd, abd)
    const __m256d minors = _mm256_add_pd(_mm256_sub_pd(_mm256_mul_pd(z, _mm256_permute4x64_pd(adjacent, kNext)), _mm256_mul_pd(next_z, opposite)),
                                         _mm256_mul_pd(second_z, adjacent));
    const __m256d lifts = _mm256_add_pd(_mm256_add_pd(_mm256_mul_pd(x, x), _mm256_mul_pd(y, y)), _mm256_mul_pd(z, z));
    // (|d|^2 [abc], |a|^2 [bcd], |b|^2 [acd], |c|^2 [abd])
    const __m256d products = _mm256_mul_pd(_mm256_permute4x64_pd(lifts, kPrevious), minors);
    const __m128d da = _mm256_castpd256_pd128(products), bc = _mm256_extractf128_pd(products, 1);
    const __m128d from_ac = _mm_unpackhi_pd(da, bc), from_bd = _mm_unpacklo_pd(bc, da);  // (a, c) and (b, d)
    const __m128d difference = _mm_sub_pd(from_ac, from_bd);
    return _mm_cvtsd_f64(_mm_add_sd(difference, _mm_unpackhi_pd(difference, difference)));
}

namespace {

struct LanesOfPoints {
    __m256d x, y, z;
};

[[gnu::target("avx2"), gnu::always_inline]] inline LanesOfPoints differences(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s, __m256d ex, __m256d ey, __m256d ez) {
    const __m256d row_p = _mm256_load_pd(&p.x), row_q = _mm256_load_pd(&q.x), row_r = _mm256_load_pd(&r.x), row_s = _mm256_load_pd(&s.x);
    const __m256d xz_pq = _mm256_unpacklo_pd(row_p, row_q), xz_rs = _mm256_unpacklo_pd(row_r, row_s);
    const __m256d y_pq = _mm256_unpackhi_pd(row_p, row_q), y_rs = _mm256_unpackhi_pd(row_r, row_s);
    return {_mm256_sub_pd(_mm256_permute2f128_pd(xz_pq, xz_rs, 0x20), ex), _mm256_sub_pd(_mm256_permute2f128_pd(y_pq, y_rs, 0x20), ey),
            _mm256_sub_pd(_mm256_permute2f128_pd(xz_pq, xz_rs, 0x31), ez)};
}

[[gnu::target("avx2"), gnu::always_inline]] inline __m256d minor_of(const LanesOfPoints& p, const LanesOfPoints& q) {
    return _mm256_sub_pd(_mm256_mul_pd(p.x, q.y), _mm256_mul_pd(q.x, p.y));
}

/// p.z qr - q.z pr + r.z pq
[[gnu::target("avx2"), gnu::always_inline]] inline __m256d minor_of(const LanesOfPoints& p, const LanesOfPoints& q, const LanesOfPoints& r, __m256d qr, __m256d pr, __m256d pq) {
    return _mm256_add_pd(_mm256_sub_pd(_mm256_mul_pd(p.z, qr), _mm256_mul_pd(q.z, pr)), _mm256_mul_pd(r.z, pq));
}

[[gnu::target("avx2"), gnu::always_inline]] inline __m256d lift_of(const LanesOfPoints& p) {
    return _mm256_add_pd(_mm256_add_pd(_mm256_mul_pd(p.x, p.x), _mm256_mul_pd(p.y, p.y)), _mm256_mul_pd(p.z, p.z));
}

}  // namespace

[[gnu::target("avx2")]] std::array<double, 4> four_insphere_values(const std::array<std::array<const Vec3*, 4>, 4>& points, const Vec3& e) noexcept {
    const __m256d ex = _mm256_set1_pd(e.x), ey = _mm256_set1_pd(e.y), ez = _mm256_set1_pd(e.z);
    const LanesOfPoints a = differences(*points[0][0], *points[1][0], *points[2][0], *points[3][0], ex, ey, ez);
    const LanesOfPoints b = differences(*points[0][1], *points[1][1], *points[2][1], *points[3][1], ex, ey, ez);
    const LanesOfPoints c = differences(*points[0][2], *points[1][2], *points[2][2], *points[3][2], ex, ey, ez);
    const LanesOfPoints d = differences(*points[0][3], *points[1][3], *points[2][3], *points[3][3], ex, ey, ez);
    const __m256d ab = minor_of(a, b), ac = minor_of(a, c), ad = minor_of(a, d), bc = minor_of(b, c), bd = minor_of(b, d), cd = minor_of(c, d);
    const __m256d abc = minor_of(a, b, c, bc, ac, ab), abd = minor_of(a, b, d, bd, ad, ab), acd = minor_of(a, c, d, cd, ad, ac), bcd = minor_of(b, c, d, cd, bd, bc);
    const __m256d values = _mm256_add_pd(_mm256_sub_pd(_mm256_mul_pd(lift_of(a), bcd), _mm256_mul_pd(lift_of(b), acd)),
                                         _mm256_sub_pd(_mm256_mul_pd(lift_of(c), abd), _mm256_mul_pd(lift_of(d), abc)));
    std::array<double, 4> result;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled at once
    _mm256_storeu_pd(result.data(), values);
    return result;
}

#else

bool has_insphere_lanes() noexcept { return false; }
double insphere_value_in_lanes(const Vec3&, const Vec3&, const Vec3&, const Vec3&, const Vec3&) noexcept { return 0; }
std::array<double, 4> four_insphere_values(const std::array<std::array<const Vec3*, 4>, 4>&, const Vec3&) noexcept { return {}; }

#endif

}  // namespace wellmesh
