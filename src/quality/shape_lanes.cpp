// SPDX-License-Identifier: Apache-2.0
// One loop over the lanes, which compilers turn into vector instructions; compiled once more for processors with AVX2, and for those with AVX-512. Without
// fused multiply-add all give the same bits.
#include "quality/shape_lanes.hpp"

#include <cmath>

#include "core/vec3_math.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
#define WELLMESH_HAS_AVX_TARGETS 1
#ifndef __clang__  // which knows no way to ask for whole registers
#define WELLMESH_HAS_AVX512_TARGET 1
#endif
#define WELLMESH_ALWAYS_INLINE [[gnu::always_inline]]
#else
#define WELLMESH_ALWAYS_INLINE
#endif
#if defined(__clang__)
#define WELLMESH_LANES_APART _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define WELLMESH_LANES_APART _Pragma("GCC ivdep")
#else
#define WELLMESH_LANES_APART
#endif

namespace wellmesh {
namespace {

WELLMESH_ALWAYS_INLINE inline double lesser(double a, double b) { return a < b ? a : b; }
WELLMESH_ALWAYS_INLINE inline double greater(double a, double b) { return a > b ? a : b; }
struct Vec {
    double x, y, z;
};
WELLMESH_ALWAYS_INLINE inline Vec minus(const Vec& p, const Vec& q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }
WELLMESH_ALWAYS_INLINE inline Vec product(const Vec& p, const Vec& q) { return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x}; }
WELLMESH_ALWAYS_INLINE inline double scalar(const Vec& p, const Vec& q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
WELLMESH_ALWAYS_INLINE inline double signed_square(double negative_cosine, double qi, double qj) { return (-negative_cosine * qi) * (std::abs(negative_cosine) * qj); }

// Plain pointers, and the promise that what is written is not read: otherwise compilers leave the loop as it is.
WELLMESH_ALWAYS_INLINE inline void square_each(const CornerLanes& p, SquaredShapes& s) {
    const double *const ax = p.at[0][0].data(), *const ay = p.at[0][1].data(), *const az = p.at[0][2].data();
    const double *const bx = p.at[1][0].data(), *const by = p.at[1][1].data(), *const bz = p.at[1][2].data();
    const double *const cx = p.at[2][0].data(), *const cy = p.at[2][1].data(), *const cz = p.at[2][2].data();
    const double *const dx = p.at[3][0].data(), *const dy = p.at[3][1].data(), *const dz = p.at[3][2].data();
    double *const six_volumes = s.six_volumes.data(), *const shortest_edge = s.shortest_edge.data(), *const longest_edge = s.longest_edge.data(), *const scaled_radius = s.scaled_radius.data();
    double *const radius_edge = s.radius_edge.data(), *const sigma = s.sigma.data();
    double *const area0 = s.areas[0].data(), *const area1 = s.areas[1].data(), *const area2 = s.areas[2].data(), *const area3 = s.areas[3].data();
    double *const largest_cosine = s.largest_cosine.data(), *const smallest_cosine = s.smallest_cosine.data();
    WELLMESH_LANES_APART
    for (std::size_t i = 0; i < kShapeLanes; ++i) {
        const Vec a{ax[i], ay[i], az[i]}, b{bx[i], by[i], bz[i]}, c{cx[i], cy[i], cz[i]}, d{dx[i], dy[i], dz[i]};
        const Vec u = minus(b, a), v = minus(c, a), w = minus(d, a), bc = minus(c, b), bd = minus(d, b), cd = minus(d, c);
        const Vec n0 = product(bd, bc), n1 = product(v, w), n2 = product(w, u), n3 = product(u, v);
        const double six = scalar(u, n1), volume = six * six;
        const double uu = scalar(u, u), vv = scalar(v, v), ww = scalar(w, w);
        const double bb = scalar(bc, bc), dd = scalar(bd, bd), cc = scalar(cd, cd);
        const double shortest = lesser(lesser(lesser(uu, vv), lesser(ww, bb)), lesser(dd, cc));
        const Vec centre{uu * n1.x + vv * n2.x + ww * n3.x, uu * n1.y + vv * n2.y + ww * n3.y, uu * n1.z + vv * n2.z + ww * n3.z};
        const double radius = scalar(centre, centre);
        const double a0 = scalar(n0, n0), a1 = scalar(n1, n1), a2 = scalar(n2, n2), a3 = scalar(n3, n3);
        const double q0 = 1 / a0, q1 = 1 / a1, q2 = 1 / a2, q3 = 1 / a3;
        const double s01 = signed_square(scalar(n0, n1), q0, q1), s02 = signed_square(scalar(n0, n2), q0, q2), s03 = signed_square(scalar(n0, n3), q0, q3);
        const double s12 = signed_square(scalar(n1, n2), q1, q2), s13 = signed_square(scalar(n1, n3), q1, q3), s23 = signed_square(scalar(n2, n3), q2, q3);
        six_volumes[i] = six;
        shortest_edge[i] = shortest;
        longest_edge[i] = greater(greater(greater(uu, vv), greater(ww, bb)), greater(dd, cc));
        scaled_radius[i] = radius;
        radius_edge[i] = radius / (4 * volume * shortest);
        sigma[i] = volume / (36 * (shortest * shortest * shortest));
        area0[i] = a0, area1[i] = a1, area2[i] = a2, area3[i] = a3;
        largest_cosine[i] = greater(greater(greater(s01, s02), greater(s03, s12)), greater(s13, s23));
        smallest_cosine[i] = lesser(lesser(lesser(s01, s02), lesser(s03, s12)), lesser(s13, s23));
    }
}

void square_each_plainly(const CornerLanes& corners, SquaredShapes& shapes) noexcept { square_each(corners, shapes); }
#ifdef WELLMESH_HAS_AVX_TARGETS
[[gnu::target("avx2")]] void square_each_with_avx2(const CornerLanes& corners, SquaredShapes& shapes) noexcept { square_each(corners, shapes); }
#endif
#ifdef WELLMESH_HAS_AVX512_TARGET
[[gnu::target("avx512f,avx512dq,prefer-vector-width=512")]] void square_each_with_avx512(const CornerLanes& corners, SquaredShapes& shapes) noexcept { square_each(corners, shapes); }
#endif

}  // namespace

std::vector<SquareShapes> ways_to_square_shapes() {
    std::vector<SquareShapes> ways{square_each_plainly};
#ifdef WELLMESH_HAS_AVX_TARGETS
    if (__builtin_cpu_supports("avx2") != 0) ways.push_back(square_each_with_avx2);
#endif
#ifdef WELLMESH_HAS_AVX512_TARGET
    if (__builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0) ways.push_back(square_each_with_avx512);
#endif
    return ways;
}

void square_shapes(const CornerLanes& corners, SquaredShapes& shapes) noexcept {
    static const SquareShapes best = ways_to_square_shapes().back();
    best(corners, shapes);
}

}  // namespace wellmesh
