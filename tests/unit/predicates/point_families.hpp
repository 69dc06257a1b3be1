// SPDX-License-Identifier: Apache-2.0
// Random quintuples of points that visit all rungs: far from degenerate, degenerate, and a few ulps off. A case depends on
// its family and number alone.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <ostream>

#include "core/rng.hpp"
#include "predicates/exact_range.hpp"
#include "wellmesh/predicates.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh {

// Here, so that all files of the test program print alike (and obey the one-definition rule).
inline std::ostream& operator<<(std::ostream& out, Sign sign) { return out << (sign == Sign::zero ? "0" : sign == Sign::positive ? "+" : "-"); }
inline std::ostream& operator<<(std::ostream& out, const Vec3& p) {
    const auto precision = out.precision(17);
    out << "{" << p.x << ", " << p.y << ", " << p.z << "}";
    out.precision(precision);
    return out;
}

namespace test {

using Quintuple = std::array<Vec3, 5>;

class Random {
public:
    Random(std::uint64_t stream, std::uint64_t number) : key_(mix64(stream, number)) {}
    std::uint64_t bits() { return mix64(key_, counter_++); }
    double unit() { return unit_double(bits()); }
    int integer(int low, int high) {
        const auto count = static_cast<std::uint64_t>(std::int64_t{high} - low + 1);
        return static_cast<int>(low + static_cast<std::int64_t>(bits() % count));
    }
    double sign() { return bits() % 2 == 0 ? 1 : -1; }
    template <class Coordinate>
    Vec3 point(Coordinate coordinate) {
        const double x = coordinate(), y = coordinate();
        return {x, y, coordinate()};
    }

private:
    std::uint64_t key_, counter_ = 0;
};

inline double some_ulps_off(Random& random, double value) {
    if (value == 0) return value;  // its neighbours are outside of the admitted range
    for (int n = random.integer(-2, 2); n != 0; n += n < 0 ? 1 : -1)
        value = std::nextafter(value, n < 0 ? -std::numeric_limits<double>::infinity() : std::numeric_limits<double>::infinity());
    return value;
}

template <class Coordinate>
Quintuple independent(Random& random, Coordinate coordinate) {
    Quintuple result;
    for (Vec3& p : result) p = random.point(coordinate);
    return result;
}

inline Quintuple uniform(Random& r) {
    return independent(r, [&] { return r.unit(); });
}
inline Quintuple small_integers(Random& r) {
    return independent(r, [&] { return static_cast<double>(r.integer(-2, 2)); });
}
/// Integers, and specks instead of zero: differences round to small integers, which decide wrongly.
inline Quintuple integers_and_specks(Random& r) {
    return independent(r, [&] {
        const int i = r.integer(-1, 1);
        return i != 0 ? static_cast<double>(i) : std::ldexp(static_cast<double>(r.integer(-1, 1)), -150);
    });
}
inline Quintuple large_integers(Random& r) {
    return independent(r, [&] { return static_cast<double>(r.integer(-1 << 30, 1 << 30)); });
}
inline Quintuple powers_of_two(Random& r) {
    return independent(r, [&] { return r.sign() * std::ldexp(1.0, r.integer(-20, 20)); });
}
/// One base point plus offsets of any size down to 1e-50; half of the coordinates have the base at zero, where such offsets survive.
inline Quintuple log_uniform_offsets(Random& r) {
    const Vec3 base = r.point([&] { return r.bits() % 2 == 0 ? 0.0 : r.unit(); });
    Quintuple result;
    for (Vec3& p : result) {
        const Vec3 offset = r.point([&] { return r.sign() * std::pow(10.0, -50 * r.unit()); });
        p = {base.x + offset.x, base.y + offset.y, base.z + offset.z};
    }
    return result;
}
/// Corners of neighbouring cells of a cubic grid with a spacing that doubles do not hold: exactly or almost cospherical and coplanar.
inline Quintuple grid(Random& r) {
    const double spacing = r.bits() % 2 == 0 ? 0.1 : r.unit(), shift = r.bits() % 2 == 0 ? 0.0 : r.unit();
    return independent(r, [&] { return shift + spacing * r.integer(0, 2); });
}
inline Quintuple grid_some_ulps_off(Random& r) {
    Quintuple result = grid(r);
    for (Vec3& p : result) p = {some_ulps_off(r, p.x), some_ulps_off(r, p.y), some_ulps_off(r, p.z)};
    return result;
}
/// Points of a slanted plane, rounded; shifted far away in half of the cases.
inline Quintuple slanted_plane(Random& r) {
    const Vec3 shift = r.bits() % 2 == 0 ? Vec3{} : r.point([&] { return 1e6 * r.unit(); });
    const Vec3 u = r.point([&] { return r.unit() - 0.5; }), v = r.point([&] { return r.unit() - 0.5; });
    Quintuple result;
    for (Vec3& p : result) {
        const double s = r.unit(), t = r.unit();
        p = {shift.x + s * u.x + t * v.x, shift.y + s * u.y + t * v.y, shift.z + s * u.z + t * v.z};
    }
    return result;
}
/// Points of an axis-parallel plane, or of one line.
inline Quintuple flat(Random& r) {
    Quintuple result = uniform(r);
    const int axis = r.integer(0, 2);
    const bool line = r.bits() % 4 == 0;
    for (Vec3& p : result) {
        double* coordinates[] = {&p.x, &p.y, &p.z};
        *coordinates[axis] = 0.3;
        if (line) *coordinates[(axis + 1) % 3] = 0.7;
    }
    return result;
}
/// Points of a sphere, rounded.
inline Quintuple sphere(Random& r) {
    const Vec3 centre = r.point([&] { return r.unit(); });
    Quintuple result;
    for (Vec3& p : result) {
        const Vec3 q = r.point([&] { return r.unit() - 0.5; });
        const double norm = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z);
        p = {centre.x + q.x / norm, centre.y + q.y / norm, centre.z + q.z / norm};
    }
    return result;
}
/// Points of a parabola in a slanted lattice plane, integers times one odd number: exactly coplanar, and no differences are small.
inline Quintuple coplanar_lattice(Random& r) {
    const double scale = r.unit();  // 53 bits, so no rung of rounded arithmetic is exact
    const double unit = std::ldexp(std::floor(std::ldexp(scale, 30)), -30);
    Quintuple result;
    for (Vec3& p : result) {
        const int i = r.integer(-1000, 1000), j = r.integer(-1000, 1000);
        p = {unit * i, unit * j, unit * (3 * i - 7 * j)};
    }
    return result;
}
/// Both ends of the admitted range, all bits of the mantissa used.
inline double extreme_coordinate(Random& r) {
    const double mantissa = 1 + r.unit();
    switch (r.integer(0, 3)) {
        case 0: return 0;
        case 1: return r.sign() * mantissa * kMinMagnitude;
        case 2: return r.sign() * (kMaxMagnitude * (mantissa / 2));
        default: return r.sign() * mantissa * std::ldexp(1.0, r.integer(-200, 88));
    }
}
inline Quintuple range_ends(Random& r) {
    return independent(r, [&] { return extreme_coordinate(r); });
}
/// Degenerate configurations (small integers) scaled to either end of the range; the low end has a tiny common shift.
inline Quintuple scaled_to_range_ends(Random& r) {
    const double scale = r.bits() % 2 == 0 ? kMinMagnitude : kMaxMagnitude / 4;
    return independent(r, [&] { return scale * r.integer(-2, 2); });
}

struct Family {
    const char* name;
    Quintuple (*generate)(Random&);
    double share;  ///< of a test's cases; the oracle is slow where exponents differ much
};

inline constexpr Family kFamilies[] = {
    {"uniform", uniform, 0.05},
    {"small_integers", small_integers, 0.12},
    {"integers_and_specks", integers_and_specks, 0.05},
    {"large_integers", large_integers, 0.05},
    {"powers_of_two", powers_of_two, 0.1},
    {"log_uniform_offsets", log_uniform_offsets, 0.02},
    {"grid", grid, 0.15},
    {"grid_some_ulps_off", grid_some_ulps_off, 0.15},
    {"slanted_plane", slanted_plane, 0.1},
    {"flat", flat, 0.05},
    {"sphere", sphere, 0.1},
    {"coplanar_lattice", coplanar_lattice, 0.05},
    {"range_ends", range_ends, 0.005},
    {"scaled_to_range_ends", scaled_to_range_ends, 0.005},
};

}  // namespace test
}  // namespace wellmesh
