// SPDX-License-Identifier: Apache-2.0
#include "validation/triangle_contact.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/vec3_math.hpp"
#include "validation/plane.hpp"

namespace wellmesh {
namespace {

using Triangle = std::array<Vec3, 3>;
using Segment = std::array<Vec3, 2>;

bool opposite(Sign a, Sign b) { return static_cast<int>(a) * static_cast<int>(b) < 0; }

/// A projection along an axis in which the triangle keeps an area; turned so that the area is positive.
PlaneProjection faithful_projection(const Triangle& t) {
    for (const Vec3& axis : {Vec3{0, 0, 1}, Vec3{0, 1, 0}, Vec3{1, 0, 0}}) {
        const PlaneProjection f(axis);
        const Sign area = orient2d(f(t[0]), f(t[1]), f(t[2]));
        if (area == Sign::positive) return f;
        if (area == Sign::negative) return PlaneProjection(-axis);
    }
    return PlaneProjection({0, 0, 1});
}

/// @pre p in the triangle's plane.
bool contains_in_plane(const PlaneProjection& f, const Triangle& t, const Vec3& p) {
    for (std::size_t i = 0; i < 3; ++i)
        if (orient2d(f(t[i]), f(t[(i + 1) % 3]), f(p)) == Sign::negative) return false;
    return true;
}

/// Closed segments in one plane, seen in a projection that is faithful for the plane; rounded common point.
std::optional<Vec3> meet_in_plane(const PlaneProjection& f, const Segment& s, const Segment& t) {
    const auto a = f(s[0]), b = f(s[1]), c = f(t[0]), d = f(t[1]);
    const Sign abc = orient2d(a, b, c), abd = orient2d(a, b, d), cda = orient2d(c, d, a), cdb = orient2d(c, d, b);
    if (abc == Sign::zero && abd == Sign::zero) {  // on one line: compare along it, in the order of the projected coordinates
        auto [l0, h0] = std::minmax(a, b);
        auto [l1, h1] = std::minmax(c, d);
        if (h0 < l1 || h1 < l0) return std::nullopt;
        const auto low = std::max(l0, l1);
        for (const Vec3& p : {s[0], s[1], t[0], t[1]})
            if (f(p) == low) return p;
        return s[0];
    }
    if (abc == abd || cda == cdb) return std::nullopt;  // one strictly beside the other (equal signs are not zero: not on one line)
    if (abc == Sign::zero) return t[0];
    if (abd == Sign::zero) return t[1];
    if (cda == Sign::zero) return s[0];
    if (cdb == Sign::zero) return s[1];
    const double na = std::abs((d[0] - c[0]) * (a[1] - c[1]) - (d[1] - c[1]) * (a[0] - c[0]));
    const double nb = std::abs((d[0] - c[0]) * (b[1] - c[1]) - (d[1] - c[1]) * (b[0] - c[0]));
    return na + nb > 0 ? s[0] + (na / (na + nb)) * (s[1] - s[0]) : s[0];
}

std::optional<Vec3> meet_coplanar(const Segment& s, const Triangle& t) {
    const PlaneProjection f = faithful_projection(t);
    for (const Vec3& p : s)
        if (contains_in_plane(f, t, p)) return p;
    for (std::size_t i = 0; i < 3; ++i)
        if (const auto x = meet_in_plane(f, s, {t[i], t[(i + 1) % 3]})) return x;
    return std::nullopt;
}

/// Closed segment and closed triangle.
std::optional<Vec3> meet(const Segment& s, const Triangle& t) {
    const Sign from = orient3d(t[0], t[1], t[2], s[0]), to = orient3d(t[0], t[1], t[2], s[1]);
    if (from == Sign::zero && to == Sign::zero) return meet_coplanar(s, t);
    if (from == to) return std::nullopt;
    if (from == Sign::zero || to == Sign::zero) {
        const Vec3& p = from == Sign::zero ? s[0] : s[1];
        if (contains_in_plane(faithful_projection(t), t, p)) return p;
        return std::nullopt;
    }
    const Sign ab = orient3d(s[0], s[1], t[0], t[1]), bc = orient3d(s[0], s[1], t[1], t[2]);
    if (opposite(ab, bc)) return std::nullopt;
    const Sign ca = orient3d(s[0], s[1], t[2], t[0]);
    if (opposite(ab, ca) || opposite(bc, ca)) return std::nullopt;
    const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
    const double d0 = std::abs(dot(s[0] - t[0], n)), d1 = std::abs(dot(s[1] - t[0], n));
    return d0 + d1 > 0 ? s[0] + (d0 / (d0 + d1)) * (s[1] - s[0]) : s[0];
}

std::optional<Vec3> meet_folded(const NamedTriangle& s, const NamedTriangle& t, std::size_t s_apex, std::size_t t_apex) {
    const Vec3 &a = s.p[(s_apex + 1) % 3], &b = s.p[(s_apex + 2) % 3], &c = s.p[s_apex], &d = t.p[t_apex];
    if (orient3d(a, b, c, d) != Sign::zero) return std::nullopt;
    const PlaneProjection f = faithful_projection(s.p);
    if (orient2d(f(a), f(b), f(c)) != orient2d(f(a), f(b), f(d))) return std::nullopt;
    return a + (1.0 / 3) * ((b - a) + (contains_in_plane(f, t.p, c) ? c - a : d - a));
}

}  // namespace

std::optional<Vec3> contact(const NamedTriangle& s, const NamedTriangle& t) {
    std::array<bool, 3> s_shared{}, t_shared{};
    std::size_t shared = 0;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            if (s.name[i] == t.name[j]) {
                s_shared[i] = t_shared[j] = true;
                ++shared;
            }
    if (shared == 3) return s.p[0] + (1.0 / 3) * ((s.p[1] - s.p[0]) + (s.p[2] - s.p[0]));
    const auto index_of = [](const std::array<bool, 3>& flags, bool value) { return static_cast<std::size_t>(std::find(flags.begin(), flags.end(), value) - flags.begin()); };
    if (shared == 2) return meet_folded(s, t, index_of(s_shared, false), index_of(t_shared, false));
    if (shared == 1) {  // beyond the common corner, one of the opposite edges reaches the other triangle
        const std::size_t i = index_of(s_shared, true), j = index_of(t_shared, true);
        if (const auto x = meet({s.p[(i + 1) % 3], s.p[(i + 2) % 3]}, t.p)) return x;
        return meet({t.p[(j + 1) % 3], t.p[(j + 2) % 3]}, s.p);
    }
    // most candidates: one lies on one side of the other's plane
    const auto one_side = [](const Triangle& x, const Triangle& y) {
        const Sign first = orient3d(x[0], x[1], x[2], y[0]);
        return first != Sign::zero && orient3d(x[0], x[1], x[2], y[1]) == first && orient3d(x[0], x[1], x[2], y[2]) == first;
    };
    if (one_side(s.p, t.p) || one_side(t.p, s.p)) return std::nullopt;
    for (std::size_t i = 0; i < 3; ++i) {
        if (const auto x = meet({s.p[i], s.p[(i + 1) % 3]}, t.p)) return x;
        if (const auto x = meet({t.p[i], t.p[(i + 1) % 3]}, s.p)) return x;
    }
    return std::nullopt;
}

std::array<Vec3, 2> contact_ends(const NamedTriangle& s, const NamedTriangle& t) {
    std::vector<Vec3> found;
    const auto collect = [&](const Triangle& x, const Triangle& y) {
        for (std::size_t i = 0; i < 3; ++i) {
            if (is_on(x[i], y)) found.push_back(x[i]);
            if (const auto p = meet({x[i], x[(i + 1) % 3]}, y)) found.push_back(*p);
            if (const auto p = meet({x[(i + 1) % 3], x[i]}, y)) found.push_back(*p);
        }
    };
    collect(s.p, t.p);
    collect(t.p, s.p);
    if (found.empty()) return {s.p[0], s.p[0]};
    std::array<Vec3, 2> ends{found[0], found[0]};
    for (std::size_t i = 0; i < found.size(); ++i)
        for (std::size_t j = i + 1; j < found.size(); ++j)
            if (squared_distance(found[i], found[j]) > squared_distance(ends[0], ends[1])) ends = {found[i], found[j]};
    return ends;
}

std::optional<Vec3> contact(const NamedSegment& s, const NamedTriangle& t) {
    for (std::size_t e = 0; e < 2; ++e)
        for (std::size_t i = 0; i < 3; ++i) {
            if (s.name[e] != t.name[i]) continue;
            const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
            if (s.name[1 - e] == t.name[j] || s.name[1 - e] == t.name[k]) return std::nullopt;  // one of its edges
            if (orient3d(t.p[0], t.p[1], t.p[2], s.p[1 - e]) != Sign::zero) return std::nullopt;
            const PlaneProjection f = faithful_projection(t.p);
            if (contains_in_plane(f, t.p, s.p[1 - e])) return s.p[1 - e];
            return meet_in_plane(f, s.p, {t.p[j], t.p[k]});
        }
    return meet(s.p, t.p);
}

std::optional<Vec3> contact(const NamedSegment& s, const NamedSegment& t) {
    for (std::size_t e = 0; e < 2; ++e)
        for (std::size_t g = 0; g < 2; ++g) {
            if (s.name[e] != t.name[g]) continue;
            const Vec3 &v = s.p[e], &a = s.p[1 - e], &b = t.p[1 - g];
            if (s.name[1 - e] == t.name[1 - g]) return std::nullopt;
            // on one line the lexicographic order tells the direction
            if (!collinear(v, a, b) || lexicographically_less(v, a) != lexicographically_less(v, b)) return std::nullopt;
            return is_on(a, Segment{v, b}) ? a : b;
        }
    if (collinear(s.p[0], s.p[1], t.p[0])) {
        if (is_on(t.p[0], s.p)) return t.p[0];
        if (collinear(s.p[0], s.p[1], t.p[1])) {
            if (is_on(t.p[1], s.p)) return t.p[1];
            if (is_on(s.p[0], t.p)) return s.p[0];
            return std::nullopt;
        }
        return std::nullopt;
    }
    return meet(t.p, {s.p[0], s.p[1], t.p[0]}) && orient3d(s.p[0], s.p[1], t.p[0], t.p[1]) == Sign::zero
               ? meet_in_plane(faithful_projection({s.p[0], s.p[1], t.p[0]}), s.p, t.p)
               : std::nullopt;
}

bool is_on(const Vec3& p, const std::array<Vec3, 3>& triangle) {
    return orient3d(triangle[0], triangle[1], triangle[2], p) == Sign::zero && contains_in_plane(faithful_projection(triangle), triangle, p);
}

bool is_on(const Vec3& p, const std::array<Vec3, 2>& segment) {
    if (!collinear(segment[0], segment[1], p)) return false;
    const bool up = lexicographically_less(segment[0], segment[1]);
    const Vec3 &low = up ? segment[0] : segment[1], &high = up ? segment[1] : segment[0];
    return !lexicographically_less(p, low) && !lexicographically_less(high, p);
}

}  // namespace wellmesh
