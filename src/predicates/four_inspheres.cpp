// SPDX-License-Identifier: Apache-2.0
// InsphereFormula over four quintuples of points, one a lane.
#include "predicates/four_inspheres.hpp"

#include <algorithm>
#include <cstddef>

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

namespace {

// The same with fused operations.
[[gnu::target("avx2,fma"), gnu::always_inline]] inline __m256d fused_minor_of(const LanesOfPoints& p, const LanesOfPoints& q) {
    return _mm256_fmsub_pd(p.x, q.y, _mm256_mul_pd(q.x, p.y));
}
[[gnu::target("avx2,fma"), gnu::always_inline]] inline __m256d fused_minor_of(const LanesOfPoints& p, const LanesOfPoints& q, const LanesOfPoints& r, __m256d qr, __m256d pr, __m256d pq) {
    return _mm256_fmadd_pd(r.z, pq, _mm256_fmsub_pd(p.z, qr, _mm256_mul_pd(q.z, pr)));
}
[[gnu::target("avx2,fma"), gnu::always_inline]] inline __m256d fused_lift_of(const LanesOfPoints& p) {
    return _mm256_fmadd_pd(p.z, p.z, _mm256_fmadd_pd(p.y, p.y, _mm256_mul_pd(p.x, p.x)));
}

}  // namespace

[[gnu::target("avx2,fma")]] void insphere_values_of_records(PointRecords points, std::span<const RecordNumbers> tets, const Vec3& e, double* values) noexcept {
    const __m256d ex = _mm256_set1_pd(e.x), ey = _mm256_set1_pd(e.y), ez = _mm256_set1_pd(e.z);
    const std::size_t last = tets.size() - 1;
    for (std::size_t i = 0; i <= last; i += 4) {
        const RecordNumbers &t0 = tets[i], &t1 = tets[std::min(i + 1, last)], &t2 = tets[std::min(i + 2, last)], &t3 = tets[std::min(i + 3, last)];
        const auto row = [&](std::size_t k) __attribute__((always_inline, target("avx2,fma"))) { return differences(points[t0[k]], points[t1[k]], points[t2[k]], points[t3[k]], ex, ey, ez); };
        const LanesOfPoints a = row(0), b = row(1), c = row(2), d = row(3);
        const __m256d ab = fused_minor_of(a, b), ac = fused_minor_of(a, c), ad = fused_minor_of(a, d), bc = fused_minor_of(b, c), bd = fused_minor_of(b, d), cd = fused_minor_of(c, d);
        const __m256d abc = fused_minor_of(a, b, c, bc, ac, ab), abd = fused_minor_of(a, b, d, bd, ad, ab);
        const __m256d acd = fused_minor_of(a, c, d, cd, ad, ac), bcd = fused_minor_of(b, c, d, cd, bd, bc);
        const __m256d ab_part = _mm256_fmsub_pd(fused_lift_of(a), bcd, _mm256_mul_pd(fused_lift_of(b), acd));
        const __m256d cd_part = _mm256_fmsub_pd(fused_lift_of(c), abd, _mm256_mul_pd(fused_lift_of(d), abc));
        _mm256_storeu_pd(values + i, _mm256_add_pd(ab_part, cd_part));
    }
}

#else

std::array<double, 4> four_insphere_values(const std::array<std::array<const Vec3*, 4>, 4>&, const Vec3&) noexcept { return {}; }
void insphere_values_of_records(PointRecords, std::span<const RecordNumbers>, const Vec3&, double*) noexcept {}

#endif

}  // namespace wellmesh
