// SPDX-License-Identifier: Apache-2.0
// Incremental insertion by walking, Lawson's flips, and edges forced in by flipping what they cross [Sloan93].
#include "certify/planar_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>

#include "core/rng.hpp"

namespace wellmesh::certifying {
namespace {

constexpr double kRoundingUnit = std::numeric_limits<double>::epsilon() / 2;

constexpr std::size_t after(std::size_t i) { return i == 2 ? 0 : i + 1; }
constexpr std::size_t before(std::size_t i) { return i == 0 ? 2 : i - 1; }

}  // namespace

Sign orient2d(const Point2& a, const Point2& b, const Point2& c) {
    const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x), det = left - right;
    // [Shewchuk97]: the rounded determinant has the right sign beyond (3 + 16 u) u (|left| + |right|).
    const double bound = (3 + 16 * kRoundingUnit) * kRoundingUnit * (std::abs(left) + std::abs(right));
    // Below this, a product may have underflowed.
    if (std::abs(det) > bound && std::abs(det) > 1e-280) return det > 0 ? Sign::positive : Sign::negative;
    // The same determinant times the height of a tetrahedron over the triangle, decided exactly.
    const double height = std::max({std::abs(a.x), std::abs(a.y), std::abs(b.x), std::abs(b.y), std::abs(c.x), std::abs(c.y)});
    return orient3d({a.x, a.y, 0}, {b.x, b.y, 0}, {c.x, c.y, 0}, {a.x, a.y, height > 0 ? height : 1});
}

PlanarMesh::PlanarMesh(const Point2& low, const Point2& high) {
    const double reach = 16 * std::max({high.x - low.x, high.y - low.y, 1e-3 * std::max({std::abs(low.x), std::abs(low.y), std::abs(high.x), std::abs(high.y)}), 1e-50});
    points_ = {{low.x - reach, low.y - reach}, {high.x + reach, low.y - reach}, {high.x + reach, high.y + reach}, {low.x - reach, high.y + reach}};
    tris_.resize(2);
    tris_[0].v = {0, 1, 2};
    tris_[1].v = {0, 2, 3};
    tris_[0].next = {kNoTri, 1, kNoTri};
    tris_[1].next = {kNoTri, kNoTri, 0};
    at_ = {0, 0, 0, 1};
}

std::size_t PlanarMesh::corner_of(std::uint32_t tri, std::uint32_t v) const {
    const auto& c = tris_[tri].v;
    return c[0] == v ? 0 : c[1] == v ? 1 : 2;
}

std::size_t PlanarMesh::edge_to(std::uint32_t tri, std::uint32_t neighbour) const {
    const auto& n = tris_[tri].next;
    return n[0] == neighbour ? 0 : n[1] == neighbour ? 1 : 2;
}

void PlanarMesh::link(std::uint32_t t, std::size_t e, std::uint32_t u) {
    tris_[t].next[e] = u;
    if (u == kNoTri) return;
    const std::uint32_t from = tris_[t].v[after(e)];
    // Edge e runs from v[e+1] to v[e+2]; on the other side it ends at `from`, so it is opposite the corner after that one.
    tris_[u].next[after(corner_of(u, from))] = t;
}

PlanarMesh::Place PlanarMesh::locate(const Point2& p) {
    std::uint32_t t = recent_;
    for (std::uint64_t step = 0;; ++step) {  // the random first edge makes this walk end in any triangulation [Devillers02]
        const std::size_t start = mix64(step) % 3;
        std::array<Sign, 3> side{};
        bool moved = false;
        for (std::size_t k = 0; k < 3 && !moved; ++k) {
            const std::size_t i = (start + k) % 3;
            side[i] = orient2d(points_[tris_[t].v[after(i)]], points_[tris_[t].v[before(i)]], p);
            if (side[i] == Sign::negative && tris_[t].next[i] != kNoTri) t = tris_[t].next[i], moved = true;
        }
        if (moved) continue;
        recent_ = t;
        Place place{t, -1, -1};
        int zeros = 0;
        for (std::size_t i = 0; i < 3; ++i)
            if (side[i] == Sign::zero) ++zeros, place.edge = static_cast<int>(i);
        if (zeros == 2)
            for (std::size_t i = 0; i < 3; ++i)
                if (side[i] != Sign::zero) place.corner = static_cast<int>(i);
        return place;
    }
}

void PlanarMesh::split_triangle(std::uint32_t t, std::uint32_t v) {
    const Tri old = tris_[t];
    const std::array<std::uint32_t, 3> id{t, static_cast<std::uint32_t>(tris_.size()), static_cast<std::uint32_t>(tris_.size() + 1)};
    tris_.resize(tris_.size() + 2);
    for (std::size_t i = 0; i < 3; ++i) {
        Tri& n = tris_[id[i]];
        n = {};
        n.v = {v, old.v[after(i)], old.v[before(i)]};
        n.constrained[0] = old.constrained[i];
        at_[old.v[after(i)]] = id[i];
    }
    for (std::size_t i = 0; i < 3; ++i) {
        link(id[i], 0, old.next[i]);
        tris_[id[i]].next[1] = id[after(i)];   // opposite old.v[i+1]: edge (old.v[i+2], v)
        tris_[id[i]].next[2] = id[before(i)];  // opposite old.v[i+2]: edge (v, old.v[i+1])
    }
    at_[v] = t;
}

void PlanarMesh::split_edge(std::uint32_t t, std::size_t e, std::uint32_t v) {
    const std::uint32_t u = tris_[t].next[e];
    const Tri a = tris_[t], b = tris_[u];
    const std::size_t f = edge_to(u, t);
    const bool constrained = a.constrained[e];
    const std::uint32_t p = a.v[after(e)], q = a.v[before(e)], apex = a.v[e], other = b.v[f];
    const auto t2 = static_cast<std::uint32_t>(tris_.size()), u2 = t2 + 1;
    tris_.resize(tris_.size() + 2);
    // Around v, counter-clockwise: (v, q, apex), (v, apex, p), (v, p, other), (v, other, q); edge 0 of each is an old edge.
    const std::array<std::uint32_t, 4> id{t, t2, u, u2}, rim{q, apex, p, other};
    const std::array<std::uint32_t, 4> outer{a.next[after(e)], a.next[before(e)], b.next[after(f)], b.next[before(f)]};
    const std::array<bool, 4> outer_constrained{a.constrained[after(e)], a.constrained[before(e)], b.constrained[after(f)], b.constrained[before(f)]};
    for (std::size_t i = 0; i < 4; ++i) {
        Tri& n = tris_[id[i]];
        n = {};
        n.v = {v, rim[i], rim[(i + 1) % 4]};
        n.constrained[0] = outer_constrained[i];
        at_[rim[i]] = id[i];
    }
    for (std::size_t i = 0; i < 4; ++i) {
        link(id[i], 0, outer[i]);
        tris_[id[i]].next[1] = id[(i + 1) % 4];
        tris_[id[i]].next[2] = id[(i + 3) % 4];
    }
    // The halves of the old edge: v-q between the first and the last, v-p between the second and the third.
    tris_[t].constrained[2] = tris_[u2].constrained[1] = constrained;
    tris_[t2].constrained[1] = tris_[u].constrained[2] = constrained;
    at_[v] = t;
}

void PlanarMesh::flip(std::uint32_t t, std::size_t e) {
    const std::uint32_t u = tris_[t].next[e];
    const Tri a = tris_[t], b = tris_[u];
    const std::size_t f = edge_to(u, t);
    const std::uint32_t apex = a.v[e], other = b.v[f], p = a.v[after(e)], q = a.v[before(e)];
    tris_[t] = {};
    tris_[t].v = {apex, p, other};
    tris_[u] = {};
    tris_[u].v = {other, q, apex};
    tris_[t].constrained = {b.constrained[after(f)], false, a.constrained[before(e)]};
    tris_[u].constrained = {a.constrained[after(e)], false, b.constrained[before(f)]};
    tris_[t].next[1] = u;
    tris_[u].next[1] = t;
    link(t, 0, b.next[after(f)]);
    link(t, 2, a.next[before(e)]);
    link(u, 0, a.next[after(e)]);
    link(u, 2, b.next[before(f)]);
    at_[apex] = at_[p] = at_[other] = t;
    at_[q] = u;
}

bool PlanarMesh::flippable(std::uint32_t t, std::size_t e) const {
    const std::uint32_t u = tris_[t].next[e];
    if (u == kNoTri || tris_[t].constrained[e]) return false;
    const std::uint32_t apex = tris_[t].v[e], other = tris_[u].v[edge_to(u, t)];
    return turn(apex, tris_[t].v[after(e)], other) == Sign::positive && turn(other, tris_[t].v[before(e)], apex) == Sign::positive;
}

bool PlanarMesh::surely_not_delaunay(std::uint32_t t, std::size_t e) const {
    const std::uint32_t u = tris_[t].next[e];
    if (u == kNoTri) return false;
    const Point2& d = points_[tris_[u].v[edge_to(u, t)]];
    std::array<double, 3> x{}, y{}, lift{};
    for (std::size_t i = 0; i < 3; ++i) {
        x[i] = points_[tris_[t].v[i]].x - d.x;
        y[i] = points_[tris_[t].v[i]].y - d.y;
        lift[i] = x[i] * x[i] + y[i] * y[i];
    }
    double det = 0, size = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = after(i), k = before(i);
        det += lift[i] * (x[j] * y[k] - x[k] * y[j]);
        size += lift[i] * (std::abs(x[j] * y[k]) + std::abs(x[k] * y[j]));
    }
    return det > 32 * kRoundingUnit * size;  // at most 10 roundings relative to each term [Shewchuk97]
}

void PlanarMesh::improve(std::vector<std::uint32_t>& suspects) {
    while (!suspects.empty()) {
        const std::uint32_t t = suspects.back();
        suspects.pop_back();
        for (std::size_t e = 0; e < 3; ++e) {
            if (!surely_not_delaunay(t, e) || !flippable(t, e)) continue;
            const std::uint32_t u = tris_[t].next[e];
            flip(t, e);
            suspects.push_back(t);
            suspects.push_back(u);
            break;
        }
    }
}

std::uint32_t PlanarMesh::insert(const Point2& p) {
    const Place place = locate(p);
    if (place.corner >= 0) return tris_[place.tri].v[static_cast<std::size_t>(place.corner)];
    const auto v = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
    at_.push_back(place.tri);
    std::vector<std::uint32_t> suspects{place.tri};
    if (place.edge >= 0) {
        suspects.push_back(tris_[place.tri].next[static_cast<std::size_t>(place.edge)]);
        split_edge(place.tri, static_cast<std::size_t>(place.edge), v);
    } else {
        split_triangle(place.tri, v);
    }
    suspects.push_back(static_cast<std::uint32_t>(tris_.size() - 2));
    suspects.push_back(static_cast<std::uint32_t>(tris_.size() - 1));
    improve(suspects);
    recent_ = at_[v];
    return v;
}

PlanarMesh::EdgeAt PlanarMesh::find_edge(std::uint32_t a, std::uint32_t b) const {
    if (a < 4) std::swap(a, b);  // the triangles at an outer vertex are no closed fan
    std::uint32_t t = at_[a];
    const std::uint32_t first = t;
    do {  // counter-clockwise about a
        const std::size_t i = corner_of(t, a);
        if (tris_[t].v[after(i)] == b) return {t, before(i), true};
        t = tris_[t].next[after(i)];
    } while (t != first && t != kNoTri);
    return {};
}

std::uint32_t PlanarMesh::cross(std::uint32_t a, std::uint32_t b, std::vector<std::array<std::uint32_t, 2>>& crossed) const {
    crossed.clear();
    std::uint32_t t = at_[a];
    std::size_t i = 0;
    for (;;) {  // the triangle at a through which the segment leaves it
        i = corner_of(t, a);
        const std::uint32_t p = tris_[t].v[after(i)], q = tris_[t].v[before(i)];
        if (p == b || q == b) return b;
        const Sign right = turn(a, p, b), left = turn(a, b, q);
        const auto ahead = [&](std::uint32_t v) {  // v is on the line ab: is it on b's side of a?
            return (points_[v].x - points_[a].x) * (points_[b].x - points_[a].x) + (points_[v].y - points_[a].y) * (points_[b].y - points_[a].y) > 0;
        };
        if (right == Sign::zero && ahead(p)) return p;
        if (left == Sign::zero && ahead(q)) return q;
        if (right == Sign::positive && left == Sign::positive) break;
        t = tris_[t].next[after(i)];
    }
    for (;;) {
        const std::uint32_t p = tris_[t].v[after(i)], q = tris_[t].v[before(i)];  // p right of the way, q left
        crossed.push_back({p, q});
        const std::uint32_t u = tris_[t].next[i];
        const std::size_t apex = edge_to(u, t);
        const std::uint32_t r = tris_[u].v[apex];
        if (r == b) return b;
        const Sign side = turn(a, b, r);
        if (side == Sign::zero) return r;
        // r left: the way leaves through edge (p, r), opposite q; else through (r, q), opposite p. In u, apex is opposite (q, p).
        i = side == Sign::positive ? corner_of(u, q) : corner_of(u, p);
        t = u;
    }
}

// Every crossed edge whose quadrilateral is strictly convex is flipped; the others wait until flips nearby have made theirs convex.
void PlanarMesh::force_edge(std::uint32_t a, std::uint32_t b, std::vector<std::array<std::uint32_t, 2>>& crossed) {
    std::deque<std::array<std::uint32_t, 2>> queue(crossed.begin(), crossed.end());
    std::vector<std::uint32_t> suspects;
    while (!queue.empty()) {
        const auto [p, q] = queue.front();
        queue.pop_front();
        const EdgeAt edge = find_edge(p, q);
        if (!edge.found) continue;
        if (!flippable(edge.tri, edge.edge)) {
            queue.push_back({p, q});
            continue;
        }
        const std::uint32_t u = tris_[edge.tri].next[edge.edge];
        const std::uint32_t r = tris_[edge.tri].v[edge.edge], s = tris_[u].v[edge_to(u, edge.tri)];
        flip(edge.tri, edge.edge);
        suspects.push_back(edge.tri);
        suspects.push_back(u);
        const Sign side_r = turn(a, b, r), side_s = turn(a, b, s);
        const bool crosses = r != a && r != b && s != a && s != b && side_r != side_s && side_r != Sign::zero && side_s != Sign::zero;
        if (crosses) queue.push_back({r, s});
    }
    for (const auto& [from, to] : {std::array{a, b}, std::array{b, a}}) {
        const EdgeAt edge = find_edge(from, to);
        if (edge.found) tris_[edge.tri].constrained[edge.edge] = true;
    }
    improve(suspects);
}

bool PlanarMesh::constrain(std::uint32_t a, std::uint32_t b) {
    std::vector<std::array<std::uint32_t, 2>> todo{{a, b}}, crossed;
    while (!todo.empty()) {
        const auto [from, to] = todo.back();
        todo.pop_back();
        if (from == to) continue;
        const std::uint32_t reached = cross(from, to, crossed);
        const auto blocking = std::find_if(crossed.begin(), crossed.end(), [&](const auto& c) {
            const EdgeAt edge = find_edge(c[0], c[1]);
            return tris_[edge.tri].constrained[edge.edge];
        });
        if (blocking == crossed.end()) {
            if (reached != to) todo.push_back({reached, to});
            force_edge(from, reached, crossed);
            continue;
        }
        if (++crossings_ > max_crossings) return false;
        const auto [p, q] = *blocking;
        const Point2 &c = points_[p], &d = points_[q], &e = points_[from], &f = points_[to];
        const double dx = f.x - e.x, dy = f.y - e.y;
        const double over = dx * (c.y - e.y) - dy * (c.x - e.x), under = dx * (d.y - e.y) - dy * (d.x - e.x);
        const double s = over == under ? 0.5 : std::clamp(over / (over - under), 0.0, 1.0);
        const Point2 x{c.x + s * (d.x - c.x), c.y + s * (d.y - c.y)};
        for (const auto& [g, h] : {std::array{p, q}, std::array{q, p}}) {
            const EdgeAt edge = find_edge(g, h);
            tris_[edge.tri].constrained[edge.edge] = false;
        }
        const std::uint32_t v = insert(x);
        if (v == from || v == to) {  // rounded to an end: the other edge bends to it
            todo.push_back({from, to});
        } else {
            todo.push_back({v, to});
            todo.push_back({from, v});
        }
        todo.push_back({p, v});
        todo.push_back({v, q});
    }
    return true;
}

void PlanarMesh::flood(std::uint32_t start) {
    std::vector<std::uint32_t> stack{start};
    while (!stack.empty()) {
        Tri& t = tris_[stack.back()];
        stack.pop_back();
        if (t.marked) continue;
        t.marked = true;
        for (std::size_t e = 0; e < 3; ++e)
            if (!t.constrained[e] && t.next[e] != kNoTri) stack.push_back(t.next[e]);
    }
}

void PlanarMesh::mark_from_outside() { flood(at_[0]); }

void PlanarMesh::mark_from(const Point2& p) {
    for (std::size_t k = 0; k < 4; ++k)  // a point beyond the outer vertices has no triangle, and is outside anyway
        if (orient2d(points_[k], points_[(k + 1) % 4], p) == Sign::negative) return;
    flood(locate(p).tri);
}

std::vector<std::array<std::uint32_t, 3>> PlanarMesh::unmarked() const {
    std::vector<std::array<std::uint32_t, 3>> result;
    for (const Tri& t : tris_)
        if (!t.marked) result.push_back(t.v);
    return result;
}

}  // namespace wellmesh::certifying
