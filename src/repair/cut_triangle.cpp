// SPDX-License-Identifier: Apache-2.0
#include "repair/cut_triangle.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/vec3_math.hpp"
#include "validation/closest_points.hpp"
#include "validation/triangulate_facet.hpp"
#include "validation/working_complex.hpp"

namespace wellmesh {
namespace {

using Edge = std::array<std::uint32_t, 2>;
using Corners = std::array<std::uint32_t, 3>;

/// An axis along which every triangle of a plane keeps at least half of its area. Coplanar triangles must get the same one although rounding tilts
/// them: the largest component of (1, 0, 1) would not decide. One of three squares that add up to 1 is at least 0.33.
Vec3 projection_axis(const Vec3& normal) {
    constexpr double kLeastSquare = 0.31;
    const double limit = kLeastSquare * squared_norm(normal);
    if (normal.z * normal.z >= limit) return {0, 0, std::copysign(1.0, normal.z)};
    if (normal.y * normal.y >= limit) return {0, std::copysign(1.0, normal.y), 0};
    return {std::copysign(1.0, normal.x), 0, 0};
}

/// Last touches to a triangulation. Triangles with a corner within reach of the opposite edge are flipped away: small and near a short edge, such a
/// needle may be Delaunay, and would be found to touch itself. Then diagonals between triangles with a common circumcircle are flipped until each
/// touches the lowest vertex of its four.
class Flipper {
public:
    Flipper(std::vector<Corners>& triangles, const std::vector<Edge>& lines, std::span<const Vec3> points, const PlaneProjection& projection, double reach)
        : triangles_(triangles), points_(points), projection_(projection), reach_(reach) {
        for (const Edge& e : lines) sides_[edge_key(VertexId{e[0]}, VertexId{e[1]})].fixed = true;
        for (std::uint32_t t = 0; t < triangles.size(); ++t)
            for (std::size_t i = 0; i < 3; ++i) at(t, i).add(t);
    }

    void run() {
        flip_all([&](const Quad& q) { return is_needle(q.a, q.b, q.c) && !is_needle(q.c, q.d, q.a) && !is_needle(q.c, q.d, q.b); });
        // every flip takes an edge to a lower vertex of its circle
        flip_all([&](const Quad& q) {
            return std::min(q.c, q.d) < std::min(q.a, q.b) && on_one_circle({q.a, q.b, q.c, q.d}) && !is_needle(q.c, q.d, q.a) && !is_needle(q.c, q.d, q.b);
        });
    }

private:
    static constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);
    struct Sides {
        std::array<std::uint32_t, 2> triangle{kNone, kNone};
        bool fixed = false;
        void add(std::uint32_t t) { triangle[triangle[0] == kNone ? 0 : 1] = t; }
        void replace(std::uint32_t from, std::uint32_t to) { triangle[triangle[0] == from ? 0 : 1] = to; }
    };
    Sides& at(std::uint32_t t, std::size_t i) { return sides_[edge_key(VertexId{triangles_[t][i]}, VertexId{triangles_[t][(i + 1) % 3]})]; }
    std::array<double, 2> flat(std::uint32_t v) const { return projection_(points_[v]); }

    /// Do the four lie on one circle, as far as rounding can tell? The determinant of the lifted differences from the first, against its terms.
    bool on_one_circle(std::array<std::uint32_t, 4> v) const {
        std::sort(v.begin(), v.end());  // the same answer for the same four
        const auto o = flat(v[0]);
        std::array<std::array<double, 3>, 3> m{};
        for (std::size_t i = 0; i < 3; ++i) {
            const auto p = flat(v[i + 1]);
            m[i] = {p[0] - o[0], p[1] - o[1], 0};
            m[i][2] = m[i][0] * m[i][0] + m[i][1] * m[i][1];
        }
        double sum = 0, terms = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto &p = m[(i + 1) % 3], &q = m[(i + 2) % 3];
            const double left = p[0] * q[1], right = p[1] * q[0];
            sum += m[i][2] * (left - right);
            terms += m[i][2] * (std::abs(left) + std::abs(right));
        }
        constexpr double kTie = 1e-9;  // corners of rotated rectangles are off by some 1e-16 of their distance, more far from the origin
        return std::abs(sum) <= kTie * terms;
    }

    /// Triangles (a, b, c) and (b, a, d).
    struct Quad {
        std::uint32_t a = 0, b = 0, c = 0, d = 0;
    };
    [[nodiscard]] bool is_needle(std::uint32_t a, std::uint32_t b, std::uint32_t apex) const {
        return distance_to_segment(points_[apex], points_[a], points_[b]) <= reach_;
    }

    template <class Wanted>
    void flip_all(Wanted&& wanted) {
        const std::size_t most = 16 * triangles_.size() + 16;  // in case that rounding makes circles contradict each other
        std::size_t flips = 0;
        for (bool any = true; any && flips < most;) {
            any = false;
            for (std::uint32_t t = 0; t < triangles_.size(); ++t)
                for (std::size_t i = 0; i < 3; ++i)
                    if (flip(t, i, wanted)) {
                        any = true;
                        ++flips;
                    }
        }
    }

    template <class Wanted>
    bool flip(std::uint32_t t, std::size_t i, Wanted&& wanted) {
        const Sides& between = at(t, i);
        if (between.fixed || between.triangle[0] == kNone || between.triangle[1] == kNone) return false;
        const std::uint32_t s = between.triangle[0] == t ? between.triangle[1] : between.triangle[0];
        const std::uint32_t a = triangles_[t][i], b = triangles_[t][(i + 1) % 3], c = triangles_[t][(i + 2) % 3];
        const Corners& other = triangles_[s];
        const std::uint32_t d = other[0] != a && other[0] != b ? other[0] : other[1] != a && other[1] != b ? other[1] : other[2];
        if (!wanted(Quad{a, b, c, d})) return false;
        if (orient2d(flat(c), flat(a), flat(d)) != Sign::positive || orient2d(flat(d), flat(b), flat(c)) != Sign::positive) return false;
        sides_.erase(edge_key(VertexId{a}, VertexId{b}));
        triangles_[t] = {c, a, d};
        triangles_[s] = {d, b, c};
        sides_[edge_key(VertexId{a}, VertexId{d})].replace(s, t);
        sides_[edge_key(VertexId{b}, VertexId{c})].replace(t, s);
        Sides& across = sides_[edge_key(VertexId{c}, VertexId{d})];
        across.add(t);
        across.add(s);
        return true;
    }

    std::vector<Corners>& triangles_;
    std::span<const Vec3> points_;
    const PlaneProjection& projection_;
    const double reach_;
    std::unordered_map<EdgeKey, Sides> sides_;
};

/// Replaces an edge in a list by the two parts at x; an end at x leaves it as it is.
void split(std::vector<Edge>& edges, const Edge& e, std::uint32_t x) {
    if (x == e[0] || x == e[1]) return;
    const std::size_t n = edges.size();
    for (std::size_t i = 0; i < n; ++i)
        if (std::minmax(edges[i][0], edges[i][1]) == std::minmax(e[0], e[1])) {
            edges.push_back({x, edges[i][1]});
            edges[i][1] = x;
        }
}

}  // namespace

std::vector<Edge> border_of(std::vector<std::uint32_t> loop) {
    for (bool changed = true; changed && loop.size() > 2;) {
        changed = false;
        for (std::size_t i = 0; i < loop.size() && loop.size() > 2; ++i) {
            const std::size_t n = loop.size(), next = (i + 1) % n;
            if (loop[i] == loop[next]) {
                loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(next));
                changed = true;
            } else if (loop[(i + n - 1) % n] == loop[next]) {  // there and back
                std::rotate(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(i), loop.end());
                loop.erase(loop.begin(), loop.begin() + 2);
                changed = true;
            }
        }
    }
    std::vector<Edge> edges;
    if (loop.size() < 3) return edges;
    for (std::size_t i = 0; i < loop.size(); ++i) edges.push_back({loop[i], loop[(i + 1) % loop.size()]});
    // an edge passed there and back elsewhere on the loop has nothing between its two sides
    std::vector<Edge> kept;
    for (const Edge& e : edges)
        if (std::find(edges.begin(), edges.end(), Edge{e[1], e[0]}) == edges.end()) kept.push_back(e);
    return kept;
}

CutResult cut(CutTask task, VertexPool& pool) {
    constexpr std::size_t kMostRounds = 1000;  // each adds a vertex where lines cross; what is left over then is found again later
    const PlaneProjection projection(projection_axis(task.normal));
    CutResult result;
    for (std::size_t round = 0;; ++round) {
        std::vector<std::uint32_t> ids = task.points;
        std::vector<Edge> edges = task.border;
        edges.insert(edges.end(), task.lines.begin(), task.lines.end());
        for (const Edge& e : edges) ids.insert(ids.end(), e.begin(), e.end());
        std::sort(ids.begin(), ids.end());
        ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
        std::vector<Vec3> points;
        for (const std::uint32_t v : ids) points.push_back(pool[v]);
        const auto local = [&](std::uint32_t v) { return static_cast<std::uint32_t>(std::lower_bound(ids.begin(), ids.end(), v) - ids.begin()); };
        for (Edge& e : edges) e = {local(e[0]), local(e[1])};
        FacetTriangulation flat = triangulate_facet(points, projection, edges, task.holes, 0.5 * pool.reach());
        bool again = false;
        for (const auto& [e, f] : round < kMostRounds ? flat.crossings : std::vector<std::array<Edge, 2>>{}) {
            const Edge here{ids[e[0]], ids[e[1]]}, there{ids[f[0]], ids[f[1]]};
            const ClosestPair closest = closest_between({pool[here[0]], pool[here[1]]}, {pool[there[0]], pool[there[1]]});
            const std::uint32_t x = pool.find_or_add(closest.on_first + 0.5 * (closest.on_second - closest.on_first));
            // triangulate_facet() may have split the lines stated into these parts: both ends and splits are stated, too, from now on
            for (auto* list : {&task.border, &task.lines})
                for (const auto& s : flat.splits) split(*list, {ids[s.edge[0]], ids[s.edge[1]]}, ids[s.inside]);
            for (auto* list : {&task.border, &task.lines})
                for (const Edge& one : {here, there}) split(*list, one, x);
            again = true;
        }
        if (again) continue;
        Flipper(flat.triangles, flat.constraints, points, projection, pool.reach()).run();
        for (const auto& t : flat.triangles) result.triangles.push_back({ids[t[0]], ids[t[1]], ids[t[2]]});
        for (const Edge& e : flat.constraints) result.lines.push_back({ids[e[0]], ids[e[1]]});
        for (const auto& pair : flat.coincident) result.stacked.push_back({ids[pair[0]], ids[pair[1]]});
        return result;
    }
}

}  // namespace wellmesh
