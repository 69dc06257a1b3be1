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
    static const bool has = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0;
    return has;
}

namespace {

[[gnu::target("avx2"), gnu::always_inline]] inline double value_in_lanes(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, __m256d e_x, __m256d e_y, __m256d e_z) {
    const __m256d row_a = _mm256_load_pd(&a.x), row_b = _mm256_load_pd(&b.x);
    const __m256d row_c = _mm256_load_pd(&c.x), row_d = _mm256_load_pd(&d.x);
    // Transpose. The fourth column is whatever lies behind the points: it is dropped before any arithmetic.
    const __m256d xz_ab = _mm256_unpacklo_pd(row_a, row_b), xz_cd = _mm256_unpacklo_pd(row_c, row_d);
    const __m256d y_ab = _mm256_unpackhi_pd(row_a, row_b), y_cd = _mm256_unpackhi_pd(row_c, row_d);
    const __m256d x = _mm256_sub_pd(_mm256_permute2f128_pd(xz_ab, xz_cd, 0x20), e_x);
    const __m256d y = _mm256_sub_pd(_mm256_permute2f128_pd(y_ab, y_cd, 0x20), e_y);
    const __m256d z = _mm256_sub_pd(_mm256_permute2f128_pd(xz_ab, xz_cd, 0x31), e_z);
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

}  // namespace

[[gnu::target("avx2")]] double insphere_value_in_lanes(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) noexcept {
    return value_in_lanes(a, b, c, d, _mm256_broadcast_sd(&e.x), _mm256_broadcast_sd(&e.y), _mm256_broadcast_sd(&e.z));
}

[[gnu::target("avx2")]] void insphere_values_in_lanes(std::span<const SphereCorners> spheres, const Vec3& e, double* values) noexcept {
    const __m256d e_x = _mm256_broadcast_sd(&e.x), e_y = _mm256_broadcast_sd(&e.y), e_z = _mm256_broadcast_sd(&e.z);
    for (std::size_t i = 0; i < spheres.size(); ++i) {
        const SphereCorners& s = spheres[i];
        values[i] = value_in_lanes(*s[0], *s[1], *s[2], *s[3], e_x, e_y, e_z);
    }
}

#else

bool has_insphere_lanes() noexcept { return false; }
double insphere_value_in_lanes(const Vec3&, const Vec3&, const Vec3&, const Vec3&, const Vec3&) noexcept { return 0; }
void insphere_values_in_lanes(std::span<const SphereCorners>, const Vec3&, double*) noexcept {}

#endif

}  // namespace wellmesh
