// SPDX-License-Identifier: Apache-2.0
#include "validation/planar_triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/check.hpp"

namespace wellmesh {
namespace {

/// True only if d is certainly inside the circle of the counter-clockwise triangle abc. Bound (10 + 96 u) u of the permanent [Shewchuk97].
bool certainly_in_circle(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
    const double ax = a[0] - d[0], ay = a[1] - d[1], bx = b[0] - d[0], by = b[1] - d[1], cx = c[0] - d[0], cy = c[1] - d[1];
    const double bc = bx * cy, cb = cx * by, ca = cx * ay, ac = ax * cy, ab = ax * by, ba = bx * ay;
    const double a2 = ax * ax + ay * ay, b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
    const double det = a2 * (bc - cb) + b2 * (ca - ac) + c2 * (ab - ba);
    const double permanent = a2 * (std::abs(bc) + std::abs(cb)) + b2 * (std::abs(ca) + std::abs(ac)) + c2 * (std::abs(ab) + std::abs(ba));
    return permanent > 0x1p-960 && det > 11 * 0x1p-53 * permanent;
}

constexpr unsigned next_corner(unsigned i) { return i == 2 ? 0 : i + 1; }
constexpr unsigned previous_corner(unsigned i) { return i == 0 ? 2 : i - 1; }

}  // namespace

PlanarTriangulation::PlanarTriangulation(std::span<const Point2> points)
    : points_(points), triangle_of_(points.size(), kNone), next_(points.size(), kNone), prev_(points.size(), kNone), hull_side_(points.size()) {
    sweep();
    restore_delaunay();
}

void PlanarTriangulation::glue(Side one, Side other) {
    if (one.triangle != kNone) triangles_[one.triangle].neighbour[one.corner] = other.triangle;
    if (other.triangle != kNone) triangles_[other.triangle].neighbour[other.corner] = one.triangle;
}

void PlanarTriangulation::make_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    triangles_.push_back({.v = {a, b, c}});
    const auto t = static_cast<std::uint32_t>(triangles_.size() - 1);
    triangle_of_[a] = triangle_of_[b] = triangle_of_[c] = t;
}

/// Points in lexicographic order: each new one is outside the hull and sees an edge at the one before it.
void PlanarTriangulation::sweep() {
    std::vector<std::uint32_t> order(points_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return points_[a] != points_[b] ? points_[a] < points_[b] : a < b; });
    std::vector<std::uint32_t> distinct;
    for (const std::uint32_t v : order) {
        if (!distinct.empty() && points_[distinct.back()] == points_[v])
            coincident_.push_back({distinct.back(), v});
        else
            distinct.push_back(v);
    }
    std::size_t k = 2;
    while (k < distinct.size() && turn(distinct[0], distinct[1], distinct[k]) == Sign::zero) ++k;
    if (k >= distinct.size()) return;
    const std::uint32_t apex = distinct[k];
    const bool left = turn(distinct[0], distinct[1], apex) == Sign::positive;
    // a fan from the apex over the collinear start; the base runs so that the apex is on its left
    std::vector<std::uint32_t> base(distinct.begin(), distinct.begin() + static_cast<std::ptrdiff_t>(k));
    if (!left) std::reverse(base.begin(), base.end());
    for (std::size_t i = 0; i + 1 < base.size(); ++i) {
        make_triangle(base[i], base[i + 1], apex);
        const auto t = static_cast<std::uint32_t>(triangles_.size() - 1);
        if (i > 0) glue({t, 1}, {t - 1, 0});
        hull_side_[base[i]] = {t, 2};
        next_[base[i]] = base[i + 1];
        prev_[base[i + 1]] = base[i];
    }
    hull_side_[base.back()] = {static_cast<std::uint32_t>(triangles_.size() - 1), 0};
    hull_side_[apex] = {0, 1};
    next_[base.back()] = apex;
    prev_[apex] = base.back();
    next_[apex] = base.front();
    prev_[base.front()] = apex;

    for (std::size_t i = k + 1; i < distinct.size(); ++i) {
        const std::uint32_t p = distinct[i], last = distinct[i - 1];
        std::uint32_t from = last, to = last;
        Side above{};  // side of the newest triangle that faces the hull edge p -> ...
        Side below{};
        while (turn(to, next_[to], p) == Sign::negative) {
            const std::uint32_t q = next_[to];
            make_triangle(q, to, p);
            const auto t = static_cast<std::uint32_t>(triangles_.size() - 1);
            glue({t, 2}, hull_side_[to]);
            if (above.triangle != kNone) glue({t, 0}, above);
            if (to == last) below = {t, 0};
            above = {t, 1};
            to = q;
        }
        while (turn(prev_[from], from, p) == Sign::negative) {
            const std::uint32_t q = prev_[from];
            make_triangle(from, q, p);
            const auto t = static_cast<std::uint32_t>(triangles_.size() - 1);
            glue({t, 2}, hull_side_[q]);
            if (below.triangle != kNone) glue({t, 1}, below);
            if (above.triangle == kNone) above = {t, 1};
            below = {t, 0};
            from = q;
        }
        WELLMESH_CHECK(Stage::validate, from != to);
        next_[from] = p;
        prev_[p] = from;
        next_[p] = to;
        prev_[to] = p;
        hull_side_[from] = below;
        hull_side_[p] = above;
    }
}

PlanarTriangulation::Side PlanarTriangulation::side_across(std::uint32_t triangle, unsigned corner) const {
    const std::uint32_t n = triangles_[triangle].neighbour[corner];
    if (n == kNone) return {};
    const std::uint32_t q = triangles_[triangle].v[next_corner(corner)];  // comes last of the two in the neighbour's order
    for (unsigned i = 0; i < 3; ++i)
        if (triangles_[n].v[previous_corner(i)] == q) return {n, i};
    WELLMESH_CHECK(Stage::validate, !"planar adjacency");
    return {};
}

bool PlanarTriangulation::is_convex(std::uint32_t triangle, unsigned corner) const {
    const Side o = side_across(triangle, corner);
    const auto& v = triangles_[triangle].v;
    const std::uint32_t d = triangles_[o.triangle].v[o.corner];
    return turn(v[corner], v[next_corner(corner)], d) == Sign::positive && turn(v[corner], d, v[previous_corner(corner)]) == Sign::positive;
}

/// Replaces the edge across from `corner` by the other diagonal. @pre is_convex.
void PlanarTriangulation::flip(std::uint32_t triangle, unsigned corner) {
    const Side o = side_across(triangle, corner);
    Triangle &t = triangles_[triangle], &n = triangles_[o.triangle];
    const std::uint32_t a = t.v[corner], b = t.v[next_corner(corner)], c = t.v[previous_corner(corner)], d = n.v[o.corner];
    // t = a b c, n = d c b  ->  t = a b d, n = a d c
    const Side ab = side_across(triangle, previous_corner(corner)), ca = side_across(triangle, next_corner(corner));
    const Side bd = side_across(o.triangle, next_corner(o.corner)), dc = side_across(o.triangle, previous_corner(o.corner));
    const bool fab = t.fixed[previous_corner(corner)], fca = t.fixed[next_corner(corner)];
    const bool fbd = n.fixed[next_corner(o.corner)], fdc = n.fixed[previous_corner(o.corner)];
    t.v = {a, b, d};
    t.fixed = {fbd, false, fab};
    n.v = {a, d, c};
    n.fixed = {fdc, fca, false};
    glue({triangle, 0}, bd);
    glue({triangle, 2}, ab);
    glue({o.triangle, 0}, dc);
    glue({o.triangle, 1}, ca);
    glue({triangle, 1}, {o.triangle, 2});
    triangle_of_[a] = triangle_of_[b] = triangle_of_[d] = triangle;
    triangle_of_[c] = o.triangle;
}

void PlanarTriangulation::restore_delaunay() {
    std::vector<Side> queue;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
        for (unsigned i = 0; i < 3; ++i)
            if (triangles_[t].neighbour[i] != kNone && triangles_[t].neighbour[i] > t) queue.push_back({t, i});
    while (!queue.empty()) {
        const Side s = queue.back();
        queue.pop_back();
        const Triangle& t = triangles_[s.triangle];
        if (t.neighbour[s.corner] == kNone || t.fixed[s.corner]) continue;
        const Side o = side_across(s.triangle, s.corner);
        if (!certainly_in_circle(points_[t.v[0]], points_[t.v[1]], points_[t.v[2]], points_[triangles_[o.triangle].v[o.corner]])) continue;
        if (!is_convex(s.triangle, s.corner)) continue;
        flip(s.triangle, s.corner);
        for (const auto& [triangle, corner] : {Side{s.triangle, 0}, Side{s.triangle, 2}, Side{o.triangle, 0}, Side{o.triangle, 1}})
            queue.push_back({triangle, corner});
    }
}

std::vector<std::uint32_t> PlanarTriangulation::star(std::uint32_t v) const {
    std::vector<std::uint32_t> found;
    const std::uint32_t start = triangle_of_[v];
    const auto corner_at = [&](std::uint32_t t) { return triangles_[t].v[0] == v ? 0U : triangles_[t].v[1] == v ? 1U : 2U; };
    std::uint32_t t = start;
    do {
        found.push_back(t);
        t = triangles_[t].neighbour[next_corner(corner_at(t))];  // counter-clockwise about v
    } while (t != kNone && t != start);
    if (t == start) return found;
    t = triangles_[start].neighbour[previous_corner(corner_at(start))];
    while (t != kNone) {
        found.push_back(t);
        t = triangles_[t].neighbour[previous_corner(corner_at(t))];
    }
    return found;
}

std::optional<PlanarTriangulation::Side> PlanarTriangulation::find_edge(std::uint32_t a, std::uint32_t b) const {
    for (const std::uint32_t t : star(a))
        for (unsigned i = 0; i < 3; ++i) {
            const std::uint32_t p = triangles_[t].v[next_corner(i)], q = triangles_[t].v[previous_corner(i)];
            if ((p == a && q == b) || (p == b && q == a)) return Side{t, i};
        }
    return std::nullopt;
}

/// Is v within the distance of the segment ab, and between its ends?
bool PlanarTriangulation::is_near(std::uint32_t v, std::uint32_t a, std::uint32_t b, double on_edge) const {
    const double dx = points_[b][0] - points_[a][0], dy = points_[b][1] - points_[a][1];
    const double px = points_[v][0] - points_[a][0], py = points_[v][1] - points_[a][1];
    const double length2 = dx * dx + dy * dy, along = px * dx + py * dy;
    // inside the edge's diametral circle, so that both parts are shorter than the edge and splits end
    if (!(along > px * px + py * py)) return false;
    return std::abs(dx * py - dy * px) <= on_edge * std::sqrt(length2);
}

PlanarTriangulation::Crossings PlanarTriangulation::edges_crossed(std::uint32_t a, std::uint32_t b, double on_edge) const {
    Crossings result;
    Side side{};
    for (const std::uint32_t t : star(a)) {
        const Triangle& tri = triangles_[t];
        const unsigned i = tri.v[0] == a ? 0U : tri.v[1] == a ? 1U : 2U;
        const std::uint32_t p = tri.v[next_corner(i)], q = tri.v[previous_corner(i)];
        for (const std::uint32_t v : {p, q})
            if (is_near(v, a, b, on_edge)) {
                result.obstacle.vertex = v;
                return result;
            }
        const Sign sp = turn(a, b, p), sq = turn(a, b, q);
        if (sp == Sign::negative && sq == Sign::positive) side = {t, i};
        // exactly ahead on the line: nearer than b, or b would be the neighbour
        for (const auto& [v, s] : {std::pair{p, sp}, std::pair{q, sq}})
            if (s == Sign::zero && v != b &&
                (points_[v][0] - points_[a][0]) * (points_[b][0] - points_[a][0]) + (points_[v][1] - points_[a][1]) * (points_[b][1] - points_[a][1]) > 0) {
                result.obstacle.vertex = v;
                return result;
            }
    }
    WELLMESH_CHECK(Stage::validate, side.triangle != kNone);
    while (true) {
        const Triangle& tri = triangles_[side.triangle];
        const std::uint32_t p = tri.v[next_corner(side.corner)], q = tri.v[previous_corner(side.corner)];
        if (tri.fixed[side.corner]) {
            result.obstacle.crossing = std::array{p, q};
            return result;
        }
        result.edges.push_back({p, q});
        const Side o = side_across(side.triangle, side.corner);
        const std::uint32_t d = triangles_[o.triangle].v[o.corner];
        if (d == b) return result;
        const Sign sd = turn(a, b, d);
        if (sd == Sign::zero || is_near(d, a, b, on_edge)) {
            result.obstacle.vertex = d;
            return result;
        }
        // leave through the edge from d to the corner on its other side
        const std::uint32_t partner = sd == Sign::positive ? p : q;
        for (unsigned i = 0; i < 3; ++i) {
            const std::uint32_t v = triangles_[o.triangle].v[i];
            if (v != d && v != partner) side = {o.triangle, i};
        }
    }
}

void PlanarTriangulation::fix(const Side& side) {
    triangles_[side.triangle].fixed[side.corner] = true;
    const Side o = side_across(side.triangle, side.corner);
    if (o.triangle != kNone) triangles_[o.triangle].fixed[o.corner] = true;
}

PlanarTriangulation::Obstacle PlanarTriangulation::insert_constraint(std::uint32_t a, std::uint32_t b, double on_edge) {
    if (const auto present = find_edge(a, b)) {
        // a vertex beside the edge by less than rounding lies on it
        const Side o = side_across(present->triangle, present->corner);
        for (const Side& s : {*present, o})
            if (s.triangle != kNone && !triangles_[s.triangle].fixed[s.corner] && is_near(triangles_[s.triangle].v[s.corner], a, b, on_edge))
                return {triangles_[s.triangle].v[s.corner], std::nullopt};
        fix(*present);
        return {};
    }
    Crossings crossed = edges_crossed(a, b, on_edge);
    if (crossed.obstacle.vertex || crossed.obstacle.crossing) return crossed.obstacle;
    // flip the crossed edges away; one of them is always the diagonal of a convex quadrilateral [Sloan93]
    std::vector<std::array<std::uint32_t, 2>> pending(crossed.edges.rbegin(), crossed.edges.rend()), postponed;
    while (!pending.empty()) {
        const auto [p, q] = pending.back();
        pending.pop_back();
        const auto side = find_edge(p, q);
        WELLMESH_CHECK(Stage::validate, side.has_value());
        if (!is_convex(side->triangle, side->corner)) {
            postponed.push_back({p, q});
        } else {
            const std::uint32_t c = triangles_[side->triangle].v[side->corner];
            const Side o = side_across(side->triangle, side->corner);
            const std::uint32_t d = triangles_[o.triangle].v[o.corner];
            flip(side->triangle, side->corner);
            if (c != a && c != b && d != a && d != b && turn(a, b, c) != turn(a, b, d)) postponed.push_back({c, d});
        }
        if (pending.empty()) {
            std::reverse(postponed.begin(), postponed.end());
            pending.swap(postponed);
        }
    }
    const auto made = find_edge(a, b);
    WELLMESH_CHECK(Stage::validate, made.has_value());
    fix(*made);
    return {};
}

std::uint32_t PlanarTriangulation::locate(const Point2& p) const {
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
        const auto& v = triangles_[t].v;
        if (orient2d(points_[v[0]], points_[v[1]], p) != Sign::negative && orient2d(points_[v[1]], points_[v[2]], p) != Sign::negative &&
            orient2d(points_[v[2]], points_[v[0]], p) != Sign::negative)
            return t;
    }
    return kNone;
}

}  // namespace wellmesh
