// SPDX-License-Identifier: Apache-2.0
// InsphereFormula over four quintuples of points, one a lane.
#include "predicates/four_inspheres.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#define WELLMESH_HAS_AVX2_TARGET 1
#endif

namespace wellmesh {

#ifdef WELLMESH_HAS_AVX2_TARGET

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

std::array<double, 4> four_insphere_values(const std::array<std::array<const Vec3*, 4>, 4>&, const Vec3&) noexcept { return {}; }

#endif

}  // namespace wellmesh
