// SPDX-License-Identifier: Apache-2.0
// One loop over the lanes, which compilers turn into vector instructions; compiled a second time for processors with AVX2. Without fused
// multiply-add both give the same bits.
#include "quality/shape_lanes.hpp"

#include <cmath>

#include "core/vec3_math.hpp"

#if defined(__x86_64__) && defined(__GNUC__)
#define WELLMESH_HAS_AVX2_TARGET 1
#define WELLMESH_ALWAYS_INLINE [[gnu::always_inline]]
#else
#define WELLMESH_ALWAYS_INLINE
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

WELLMESH_ALWAYS_INLINE inline void square_each(const CornerLanes& p, SquaredShapes& s) {
    for (std::size_t i = 0; i < kShapeLanes; ++i) {
        const Vec a{p.at[0][0][i], p.at[0][1][i], p.at[0][2][i]}, b{p.at[1][0][i], p.at[1][1][i], p.at[1][2][i]};
        const Vec c{p.at[2][0][i], p.at[2][1][i], p.at[2][2][i]}, d{p.at[3][0][i], p.at[3][1][i], p.at[3][2][i]};
        const Vec u = minus(b, a), v = minus(c, a), w = minus(d, a), bc = minus(c, b), bd = minus(d, b), cd = minus(d, c);
        const Vec n0 = product(bd, bc), n1 = product(v, w), n2 = product(w, u), n3 = product(u, v);
        const double six = scalar(u, n1), volume = six * six;
        const double uu = scalar(u, u), vv = scalar(v, v), ww = scalar(w, w);
        const double shortest = lesser(lesser(lesser(uu, vv), lesser(ww, scalar(bc, bc))), lesser(scalar(bd, bd), scalar(cd, cd)));
        const Vec centre{uu * n1.x + vv * n2.x + ww * n3.x, uu * n1.y + vv * n2.y + ww * n3.y, uu * n1.z + vv * n2.z + ww * n3.z};
        const double radius = scalar(centre, centre);
        const double a0 = scalar(n0, n0), a1 = scalar(n1, n1), a2 = scalar(n2, n2), a3 = scalar(n3, n3);
        const double q0 = 1 / a0, q1 = 1 / a1, q2 = 1 / a2, q3 = 1 / a3;
        const double s01 = signed_square(scalar(n0, n1), q0, q1), s02 = signed_square(scalar(n0, n2), q0, q2), s03 = signed_square(scalar(n0, n3), q0, q3);
        const double s12 = signed_square(scalar(n1, n2), q1, q2), s13 = signed_square(scalar(n1, n3), q1, q3), s23 = signed_square(scalar(n2, n3), q2, q3);
        s.six_volumes[i] = six;
        s.shortest_edge[i] = shortest;
        s.scaled_radius[i] = radius;
        s.radius_edge[i] = radius / (4 * volume * shortest);
        s.sigma[i] = volume / (36 * (shortest * shortest * shortest));
        s.areas[0][i] = a0, s.areas[1][i] = a1, s.areas[2][i] = a2, s.areas[3][i] = a3;
        s.largest_cosine[i] = greater(greater(greater(s01, s02), greater(s03, s12)), greater(s13, s23));
        s.smallest_cosine[i] = lesser(lesser(lesser(s01, s02), lesser(s03, s12)), lesser(s13, s23));
    }
}

#ifdef WELLMESH_HAS_AVX2_TARGET
[[gnu::target("avx2")]] void square_each_with_avx2(const CornerLanes& corners, SquaredShapes& shapes) { square_each(corners, shapes); }
#endif

}  // namespace

void square_shapes(const CornerLanes& corners, SquaredShapes& shapes) noexcept {
#ifdef WELLMESH_HAS_AVX2_TARGET
    static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
    if (has_avx2) return square_each_with_avx2(corners, shapes);
#endif
    square_each(corners, shapes);
}

}  // namespace wellmesh
