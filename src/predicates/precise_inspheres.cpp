// SPDX-License-Identifier: Apache-2.0
// InsphereFormula over double-doubles (ladder.hpp), four quintuples of points at once, one a lane. A product's error comes from one fused operation.
#include "predicates/precise_inspheres.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "predicates/ladder.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
#include <immintrin.h>
#define WELLMESH_HAS_AVX2_TARGET 1
#define WELLMESH_PRECISE_LANES [[gnu::target("avx2,fma"), gnu::always_inline]] inline
#endif

namespace wellmesh {

#ifdef WELLMESH_HAS_AVX2_TARGET

namespace {

/// As DoubleDouble, with the same bounds: its products round no more often.
struct PreciseLanes {
    __m256d high, low;
};

WELLMESH_PRECISE_LANES PreciseLanes two_sum_of(__m256d a, __m256d b) {
    const __m256d sum = _mm256_add_pd(a, b);
    const __m256d b_seen = _mm256_sub_pd(sum, a), a_seen = _mm256_sub_pd(sum, b_seen);
    return {sum, _mm256_add_pd(_mm256_sub_pd(a, a_seen), _mm256_sub_pd(b, b_seen))};
}
WELLMESH_PRECISE_LANES PreciseLanes precise_plus(const PreciseLanes& x, const PreciseLanes& y) {
    const PreciseLanes sum = two_sum_of(x.high, y.high);
    return two_sum_of(sum.high, _mm256_add_pd(sum.low, _mm256_add_pd(x.low, y.low)));
}
WELLMESH_PRECISE_LANES PreciseLanes precise_minus(const PreciseLanes& x, const PreciseLanes& y) {
    const __m256d sign = _mm256_set1_pd(-0.0);
    return precise_plus(x, {_mm256_xor_pd(y.high, sign), _mm256_xor_pd(y.low, sign)});
}
WELLMESH_PRECISE_LANES PreciseLanes precise_times(const PreciseLanes& x, const PreciseLanes& y) {
    const __m256d product = _mm256_mul_pd(x.high, y.high);
    const __m256d low = _mm256_add_pd(_mm256_fmsub_pd(x.high, y.high, product), _mm256_fmadd_pd(x.high, y.low, _mm256_mul_pd(x.low, y.high)));
    const __m256d sum = _mm256_add_pd(product, low);
    return {sum, _mm256_sub_pd(low, _mm256_sub_pd(sum, product))};
}

struct PreciseDifferences {
    PreciseLanes x, y, z;
};

WELLMESH_PRECISE_LANES PreciseLanes precise_difference(__m256d p, __m256d e) {
    const PreciseLanes d = two_sum_of(p, _mm256_xor_pd(e, _mm256_set1_pd(-0.0)));
    const __m256d scale = _mm256_set1_pd(kDifferenceScale);
    return {_mm256_mul_pd(scale, d.high), _mm256_mul_pd(scale, d.low)};
}
WELLMESH_PRECISE_LANES PreciseDifferences precise_differences(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s, const Vec3& e) {
    return {precise_difference(_mm256_setr_pd(p.x, q.x, r.x, s.x), _mm256_set1_pd(e.x)), precise_difference(_mm256_setr_pd(p.y, q.y, r.y, s.y), _mm256_set1_pd(e.y)),
            precise_difference(_mm256_setr_pd(p.z, q.z, r.z, s.z), _mm256_set1_pd(e.z))};
}

WELLMESH_PRECISE_LANES PreciseLanes precise_minor(const PreciseDifferences& p, const PreciseDifferences& q) { return precise_minus(precise_times(p.x, q.y), precise_times(q.x, p.y)); }
/// p.z qr - q.z pr + r.z pq
WELLMESH_PRECISE_LANES PreciseLanes precise_minor(const PreciseDifferences& p, const PreciseDifferences& q, const PreciseDifferences& r, const PreciseLanes& qr, const PreciseLanes& pr,
                                     const PreciseLanes& pq) {
    return precise_plus(precise_minus(precise_times(p.z, qr), precise_times(q.z, pr)), precise_times(r.z, pq));
}
WELLMESH_PRECISE_LANES PreciseLanes precise_lift(const PreciseDifferences& p) { return precise_plus(precise_plus(precise_times(p.x, p.x), precise_times(p.y, p.y)), precise_times(p.z, p.z)); }

WELLMESH_PRECISE_LANES __m256d absolute(__m256d x) { return _mm256_andnot_pd(_mm256_set1_pd(-0.0), x); }
WELLMESH_PRECISE_LANES __m256d largest(__m256d a, __m256d b, __m256d c, __m256d d) {
    return _mm256_max_pd(_mm256_max_pd(absolute(a), absolute(b)), _mm256_max_pd(absolute(c), absolute(d)));
}

}  // namespace

[[gnu::target("avx2,fma")]] void insphere_signs_of_records(PointRecords points, std::span<const RecordNumbers> tets, const Vec3& e, double* signs) noexcept {
    // Ladder::double_double(), with the permanent bounded as the static filter does it, by the box of these differences.
    constexpr double kBound = 10 * InsphereFormula::kRoundings * kEpsilon * kEpsilon * 24 * (1 + 0x1p-40);
    const std::size_t last = tets.size() - 1;
    for (std::size_t i = 0; i <= last; i += 4) {
        const RecordNumbers &t0 = tets[i], &t1 = tets[std::min(i + 1, last)], &t2 = tets[std::min(i + 2, last)], &t3 = tets[std::min(i + 3, last)];
        const auto row = [&](std::size_t k) __attribute__((always_inline, target("avx2,fma"))) { return precise_differences(points[t0[k]], points[t1[k]], points[t2[k]], points[t3[k]], e); };
        const PreciseDifferences a = row(0), b = row(1), c = row(2), d = row(3);
        const PreciseLanes ab = precise_minor(a, b), ac = precise_minor(a, c), ad = precise_minor(a, d), bc = precise_minor(b, c), bd = precise_minor(b, d), cd = precise_minor(c, d);
        const PreciseLanes ab_part = precise_minus(precise_times(precise_lift(a), precise_minor(b, c, d, cd, bd, bc)), precise_times(precise_lift(b), precise_minor(a, c, d, cd, ad, ac)));
        const PreciseLanes cd_part = precise_minus(precise_times(precise_lift(c), precise_minor(a, b, d, bd, ad, ab)), precise_times(precise_lift(d), precise_minor(a, b, c, bc, ac, ab)));
        const __m256d value = precise_plus(ab_part, cd_part).high;
        const __m256d x = largest(a.x.high, b.x.high, c.x.high, d.x.high), y = largest(a.y.high, b.y.high, c.y.high, d.y.high), z = largest(a.z.high, b.z.high, c.z.high, d.z.high);
        const __m256d squares = _mm256_add_pd(_mm256_add_pd(_mm256_mul_pd(x, x), _mm256_mul_pd(y, y)), _mm256_mul_pd(z, z));
        const __m256d bound = _mm256_mul_pd(_mm256_set1_pd(kBound), _mm256_mul_pd(_mm256_mul_pd(_mm256_mul_pd(x, y), z), squares));
        const __m256d one = _mm256_set1_pd(1);
        const __m256d positive = _mm256_and_pd(_mm256_cmp_pd(value, bound, _CMP_GT_OQ), one);
        const __m256d negative = _mm256_and_pd(_mm256_cmp_pd(_mm256_xor_pd(value, _mm256_set1_pd(-0.0)), bound, _CMP_GT_OQ), one);
        _mm256_storeu_pd(signs + i, _mm256_sub_pd(positive, negative));
    }
}

#else

void insphere_signs_of_records(PointRecords, std::span<const RecordNumbers>, const Vec3&, double*) noexcept {}

#endif

}  // namespace wellmesh

#undef WELLMESH_PRECISE_LANES
