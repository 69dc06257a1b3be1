// SPDX-License-Identifier: Apache-2.0
#include "repair/cut_triangle.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/vec3_math.hpp"
#include "repair/pieces.hpp"
#include "validation/closest_points.hpp"
#include "validation/triangulate_facet.hpp"

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
        for (const Edge& e : lines) sides_[piece_edge(e[0], e[1])].fixed = true;
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
    Sides& at(std::uint32_t t, std::size_t i) { return sides_[piece_edge(triangles_[t][i], triangles_[t][(i + 1) % 3])]; }
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
        sides_.erase(piece_edge(a, b));
        triangles_[t] = {c, a, d};
        triangles_[s] = {d, b, c};
        sides_[piece_edge(a, d)].replace(s, t);
        sides_[piece_edge(b, c)].replace(t, s);
        Sides& across = sides_[piece_edge(c, d)];
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

/// The lines of a task while they cut each other into pieces.
class LineArrangement {
public:
    LineArrangement(CutTask task, VertexPool& pool, TriplePoints& triples) : task_(std::move(task)), pool_(pool), triples_(triples) {}

    CutResult run() {
        constexpr std::size_t kMostRounds = 64;  // each adds vertices where lines cross, few but the first; what is left over then is found again later
        const PlaneProjection projection(projection_axis(task_.normal));
        for (std::size_t round = 0;; ++round) {
            std::vector<Edge> edges = number_vertices();
            FacetTriangulation flat = triangulate_facet(points_, projection, edges, task_.holes, 0.5 * pool_.reach());
            for (const auto& s : flat.splits) split({ids_[s.edge[0]], ids_[s.edge[1]]}, ids_[s.inside]);
            if (!flat.coincident.empty()) {  // an edge to one that is left out would be missing
                // one pair at a time: in a list, what was left out for one might be what another is left out for
                const auto& pair = flat.coincident.front();
                stack(std::min(ids_[pair[0]], ids_[pair[1]]), std::max(ids_[pair[0]], ids_[pair[1]]));
                continue;
            }
            if (round < kMostRounds && !flat.crossings.empty()) {
                const std::size_t before = result_.splits.size();
                for (const auto& [e, f] : flat.crossings) cross_at({ids_[e[0]], ids_[e[1]]}, {ids_[f[0]], ids_[f[1]]});
                if (result_.splits.size() != before) continue;  // otherwise they cross at their ends, but for rounding
            }
            Flipper(flat.triangles, flat.constraints, points_, projection, pool_.reach()).run();
            for (const auto& t : flat.triangles) result_.triangles.push_back({ids_[t[0]], ids_[t[1]], ids_[t[2]]});
            if (flat.triangles.empty()) split_along(projection);
            if (task_.only_border_encloses) keep_what_border_encloses();
            for (const Edge& e : flat.constraints) result_.lines.push_back({ids_[e[0]], ids_[e[1]]});
            return std::move(result_);
        }
    }

private:
    /// Collects all vertices; the lines in their numbers.
    std::vector<Edge> number_vertices() {
        std::vector<Edge> edges = task_.border;
        for (const CutLine& line : task_.lines) edges.push_back(line.ends);
        ids_ = task_.points;
        for (const Edge& e : edges) ids_.insert(ids_.end(), e.begin(), e.end());
        std::sort(ids_.begin(), ids_.end());
        ids_.erase(std::unique(ids_.begin(), ids_.end()), ids_.end());
        points_.clear();
        for (const std::uint32_t v : ids_) points_.push_back(pool_[v]);
        const auto local = [&](std::uint32_t v) { return static_cast<std::uint32_t>(std::lower_bound(ids_.begin(), ids_.end(), v) - ids_.begin()); };
        for (Edge& e : edges) e = {local(e[0]), local(e[1])};
        return edges;
    }

    /// The others do lie between lines, but outside. Counts with signs: after joining, part of a border may run the other way round, and there the
    /// triangles must count the other way for the surface to stay closed.
    void keep_what_border_encloses() {
        std::unordered_map<EdgeKey, int> upwards;  // times that the border takes an edge from its lower to its higher vertex, less the other way
        for (const Edge& e : task_.border) upwards[piece_edge(e[0], e[1])] += e[0] < e[1] ? 1 : -1;
        const auto end_of = [&](std::uint32_t t, std::size_t i) { return result_.triangles[t][i % 3]; };
        const auto key_of = [&](std::uint32_t t, std::size_t i) { return piece_edge(end_of(t, i), end_of(t, i + 1)); };
        const auto entering = [&](std::uint32_t t, std::size_t i) {
            const auto found = upwards.find(key_of(t, i));
            return found == upwards.end() ? 0 : end_of(t, i) < end_of(t, i + 1) ? found->second : -found->second;
        };
        constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);
        std::unordered_map<EdgeKey, std::array<std::uint32_t, 2>> sides;
        for (std::uint32_t t = 0; t < result_.triangles.size(); ++t)
            for (std::size_t i = 0; i < 3; ++i) {
                auto& pair = sides.try_emplace(key_of(t, i), std::array{kNone, kNone}).first->second;
                pair[pair[0] == kNone ? 0 : 1] = t;
            }
        std::vector<char> known(result_.triangles.size(), 0);
        std::vector<int> winding(result_.triangles.size(), 0);
        std::vector<std::uint32_t> todo;
        const auto reach = [&](std::uint32_t t, int number) {
            if (known[t]) return;
            known[t] = 1;
            winding[t] = number;
            todo.push_back(t);
        };
        for (std::uint32_t start = 0; start < known.size(); ++start) {
            for (std::size_t i = 0; i < 3; ++i)
                if (sides.at(key_of(start, i))[1] == kNone) reach(start, entering(start, i));
            while (!todo.empty()) {
                const std::uint32_t t = todo.back();
                todo.pop_back();
                for (std::size_t i = 0; i < 3; ++i) {
                    const auto& pair = sides.at(key_of(t, i));
                    const std::uint32_t other = pair[0] == t ? pair[1] : pair[0];
                    if (other != kNone) reach(other, winding[t] - entering(t, i));
                }
            }
        }
        std::size_t kept = 0;
        for (std::uint32_t t = 0; t < known.size(); ++t)
            if (winding[t] != 0) {
                result_.windings.push_back(winding[t]);
                result_.triangles[kept++] = result_.triangles[t];
            }
        result_.triangles.resize(kept);
    }

    static bool same(const Edge& e, const Edge& f) { return (e[0] == f[0] && e[1] == f[1]) || (e[0] == f[1] && e[1] == f[0]); }

    /// Replaces an edge by two; nothing to do if x is one of its ends.
    void split(const Edge& e, std::uint32_t x) {
        if (x == e[0] || x == e[1]) return;
        bool any = false;
        for (std::size_t i = 0, n = task_.border.size(); i < n; ++i)
            if (same(task_.border[i], e)) {
                any = true;
                task_.border.push_back({x, task_.border[i][1]});
                task_.border[i][1] = x;
            }
        for (std::size_t i = 0, n = task_.lines.size(); i < n; ++i)
            if (same(task_.lines[i].ends, e)) {
                any = true;
                task_.lines.push_back({{x, task_.lines[i].ends[1]}, task_.lines[i].with});
                task_.lines[i].ends[1] = x;
            }
        if (any) result_.splits.push_back({e, x});
    }

    void stack(std::uint32_t kept, std::uint32_t gone) {
        result_.stacked.push_back({kept, gone});
        const auto rename = [&](Edge& e) { std::replace(e.begin(), e.end(), gone, kept); };
        for (Edge& e : task_.border) rename(e);
        for (CutLine& line : task_.lines) rename(line.ends);
        std::replace(task_.points.begin(), task_.points.end(), gone, kept);
        std::erase_if(task_.border, [](const Edge& e) { return e[0] == e[1]; });
        std::erase_if(task_.lines, [](const CutLine& line) { return line.ends[0] == line.ends[1]; });
    }

    /// All vertices are on one line: edges are led through those between their ends, so that neighbours are, too, and the border cancels.
    void split_along(const PlaneProjection& projection) {
        std::vector<std::uint32_t> order = ids_;
        std::sort(order.begin(), order.end(), [&](std::uint32_t v, std::uint32_t w) {
            const auto p = projection(pool_[v]), q = projection(pool_[w]);
            return p != q ? p < q : v < w;
        });
        for (const Edge& e : std::vector<Edge>(task_.border)) {
            auto from = std::find(order.begin(), order.end(), e[0]), to = std::find(order.begin(), order.end(), e[1]);
            if (to < from) std::swap(from, to);
            for (auto at = from; at != to && at + 1 != to; ++at) split({*at, *to}, *(at + 1));
        }
    }

    void cross_at(const Edge& e, const Edge& f) {
        const auto line_of = [&](const Edge& x) {
            return std::find_if(task_.lines.begin(), task_.lines.end(), [&](const CutLine& line) { return same(line.ends, x); });
        };
        const auto first = line_of(e), second = line_of(f);
        const auto compute = [&] {
            const ClosestPair closest = closest_between({pool_[e[0]], pool_[e[1]]}, {pool_[f[0]], pool_[f[1]]});
            return pool_.find_or_add(closest.on_first + 0.5 * (closest.on_second - closest.on_first));
        };
        std::uint32_t x = 0;
        if (first != task_.lines.end() && second != task_.lines.end() && first->with != second->with) {
            std::array<std::uint32_t, 3> key{task_.self, first->with, second->with};
            std::sort(key.begin(), key.end());
            const auto known = triples_.find(key);
            x = known != triples_.end() ? known->second : compute();
            triples_.try_emplace(key, x);
        } else {
            x = compute();
        }
        split(e, x);
        split(f, x);
    }

    CutTask task_;
    VertexPool& pool_;
    TriplePoints& triples_;
    CutResult result_;
    std::vector<std::uint32_t> ids_;
    std::vector<Vec3> points_;
};

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
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const auto back = std::find(kept.begin(), kept.end(), Edge{edges[i][1], edges[i][0]});
        if (back != kept.end())
            kept.erase(back);
        else
            kept.push_back(edges[i]);
    }
    return kept;
}

CutResult cut(CutTask task, VertexPool& pool, TriplePoints& triples) { return LineArrangement(std::move(task), pool, triples).run(); }

}  // namespace wellmesh
