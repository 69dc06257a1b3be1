// SPDX-License-Identifier: Apache-2.0
#include "repair/find_contacts.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/compressed_rows.hpp"
#include "core/vec3_math.hpp"
#include "repair/piercing_point.hpp"
#include "validation/box_tree.hpp"
#include "validation/closest_points.hpp"
#include "wellmesh/predicates.hpp"

namespace wellmesh {
namespace {

using Vertex = std::uint32_t;
/// A triangle, or after all triangles a wire.
using Carrier = std::uint32_t;

/// All of some boxes in a tree, and those of them that are fresh in another.
class FreshTrees {
public:
    FreshTrees(std::vector<Box> boxes, const std::vector<char>& fresh) : boxes_(std::move(boxes)), all_(boxes_) {
        for (std::uint32_t i = 0; i < boxes_.size(); ++i)
            if (fresh[i]) numbers_.push_back(i);
        for (const std::uint32_t i : numbers_) fresh_boxes_.push_back(boxes_[i]);
        fresh_.emplace(fresh_boxes_);
    }
    FreshTrees(const FreshTrees&) = delete;
    FreshTrees& operator=(const FreshTrees&) = delete;
    [[nodiscard]] const Box& box(std::size_t i) const { return boxes_[i]; }

    /// Boxes that something meets: all if it is fresh itself, otherwise the fresh ones.
    template <class Meets, class Visit>
    void query(bool is_fresh, Meets&& meets, Visit&& visit) const {
        if (is_fresh)
            all_.query(meets, visit);
        else
            fresh_->query(meets, [&](std::uint32_t i) { visit(numbers_[i]); });
    }

private:
    std::vector<Box> boxes_, fresh_boxes_;
    std::vector<std::uint32_t> numbers_;
    BoxTree all_;
    std::optional<BoxTree> fresh_;
};

struct Edges {
    std::vector<EdgeKey> keys;  ///< ascending
    std::vector<char> fresh;
    CompressedRows<Carrier> carriers;  ///< of each
    [[nodiscard]] std::size_t find(Vertex a, Vertex b) const {
        return static_cast<std::size_t>(std::lower_bound(keys.begin(), keys.end(), piece_edge(a, b)) - keys.begin());
    }
};

class ContactFinder {
public:
    ContactFinder(Pieces& pieces, const EdgeSplits& splits) : pieces_(pieces), splits_(splits), pool_(pieces.pool), reach_(pieces.pool.reach()) {
        found_.inside.resize(pieces.triangles.size());
        found_.lines.resize(pieces.triangles.size());
        collect_edges();
        collect_vertices();
        make_trees();
    }

    Contacts run() {
        for (const Vertex v : vertices_) {
            vertex_to_edges(v);
            vertex_to_triangles(v);
        }
        for (std::uint32_t e = 0; e < edges_.keys.size(); ++e) follow_split(e);
        for (std::uint32_t e = 0; e < edges_.keys.size(); ++e) edge_to_edges(e);
        for (std::uint32_t e = 0; e < edges_.keys.size(); ++e) edge_to_triangles(e);
        hand_down_to_splits();
        sort_lists();
        gather_from_splits();
        draw_lines();
        return std::move(found_);
    }

private:
    using Ends = std::array<Vertex, 2>;
    using Corners = std::array<Vertex, 3>;
    /// That a vertex lies on both of two carriers.
    struct Common {
        Carrier first = 0, second = 0;
        Vertex vertex = 0;
        friend auto operator<=>(const Common&, const Common&) = default;
    };

    void collect_edges();
    void collect_vertices();
    void make_trees();
    void vertex_to_edges(Vertex v);
    void follow_split(std::uint32_t e);
    void vertex_to_triangles(Vertex v);
    void edge_to_edges(std::uint32_t e);
    void edge_to_triangles(std::uint32_t e);
    void hand_down_to_splits();
    void gather_from_splits();
    void sort_lists();
    void draw_lines();
    void draw_lines(Carrier s, Carrier t, std::vector<Vertex> common);
    void draw_along_edges(Carrier s, Carrier t, const std::vector<Vertex>& common);

    [[nodiscard]] bool is_triangle(Carrier c) const { return c < pieces_.triangles.size(); }
    [[nodiscard]] const Corners& corners(std::uint32_t t) const { return pieces_.triangles[t].v; }
    [[nodiscard]] std::array<Vec3, 3> points(std::uint32_t t) const { return {pool_[corners(t)[0]], pool_[corners(t)[1]], pool_[corners(t)[2]]}; }
    [[nodiscard]] Ends ends(std::uint32_t e) const { return {edge_ends(edges_.keys[e])[0].value(), edge_ends(edges_.keys[e])[1].value()}; }
    [[nodiscard]] std::array<Vec3, 2> segment(std::uint32_t e) const { return {pool_[ends(e)[0]], pool_[ends(e)[1]]}; }
    [[nodiscard]] bool is_fresh(Vertex v) const { return v >= pieces_.first_fresh_vertex; }
    [[nodiscard]] bool is_near_edge_of(const Vec3& p, std::uint32_t t) const {
        const auto q = points(t);
        for (std::size_t i = 0; i < 3; ++i)
            if (distance_to_segment(p, q[i], q[(i + 1) % 3]) <= reach_) return true;
        return false;
    }
    [[nodiscard]] bool is_needle(Vertex v, std::uint32_t e) const {
        const auto at_edge = edges_.carriers[e];
        return std::any_of(at_edge.begin(), at_edge.end(), [&](Carrier c) { return is_triangle(c) && std::find(corners(c).begin(), corners(c).end(), v) != corners(c).end(); });
    }
    void put_on_edge(Vertex v, std::uint32_t e) {
        if (v == ends(e)[0] || v == ends(e)[1]) return;
        found_.is_empty = false;
        found_.on_edge[edges_.keys[e]].push_back(v);
    }
    void put_inside(Vertex v, std::uint32_t t) {
        if (v == corners(t)[0] || v == corners(t)[1] || v == corners(t)[2]) return;
        found_.is_empty = false;
        found_.inside[t].push_back(v);
    }
    void note_common(std::span<const Carrier> some, std::span<const Carrier> others, Vertex v) {
        for (const Carrier s : some)
            for (const Carrier t : others)
                if (s != t) common_.push_back({std::min(s, t), std::max(s, t), v});
    }

    Pieces& pieces_;
    const EdgeSplits& splits_;
    VertexPool& pool_;
    const double reach_;
    Edges edges_;
    std::vector<Vertex> vertices_;  // used ones
    CompressedRows<Carrier> carriers_of_vertex_;
    std::optional<FreshTrees> edge_trees_, triangle_trees_;
    std::vector<Common> common_;
    std::vector<std::pair<EdgeKey, std::vector<Vertex>>> split_chains_;  // edges that were split elsewhere, with all vertices from end to end
    Contacts found_;
};

void ContactFinder::collect_edges() {
    std::vector<std::pair<EdgeKey, Carrier>> all;
    for (Carrier t = 0; t < pieces_.triangles.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i) all.emplace_back(piece_edge(corners(t)[i], corners(t)[(i + 1) % 3]), t);
    for (std::size_t w = 0; w < pieces_.wires.size(); ++w)
        all.emplace_back(piece_edge(pieces_.wires[w].v[0], pieces_.wires[w].v[1]), static_cast<Carrier>(pieces_.triangles.size() + w));
    std::sort(all.begin(), all.end());
    std::vector<std::array<std::uint32_t, 2>> pairs;
    for (const auto& [key, carrier] : all) {
        if (edges_.keys.empty() || edges_.keys.back() != key) {
            edges_.keys.push_back(key);
            edges_.fresh.push_back(0);
        }
        pairs.push_back({static_cast<std::uint32_t>(edges_.keys.size() - 1), carrier});
        const bool fresh = is_triangle(carrier) ? pieces_.triangles[carrier].fresh : pieces_.wires[carrier - pieces_.triangles.size()].fresh;
        if (fresh) edges_.fresh.back() = 1;
    }
    edges_.carriers = CompressedRows<Carrier>(edges_.keys.size(), pairs);
}

void ContactFinder::collect_vertices() {
    std::vector<std::array<std::uint32_t, 2>> pairs;
    for (Carrier t = 0; t < pieces_.triangles.size(); ++t)
        for (const Vertex v : corners(t)) pairs.push_back({v, t});
    for (std::size_t w = 0; w < pieces_.wires.size(); ++w)
        for (const Vertex v : pieces_.wires[w].v) pairs.push_back({v, static_cast<Carrier>(pieces_.triangles.size() + w)});
    std::sort(pairs.begin(), pairs.end());
    std::vector<char> used(pool_.size(), 0);
    for (const auto& [v, c] : pairs) used[v] = 1;
    for (const Vertex v : pieces_.lone) used[v] = 1;
    for (Vertex v = 0; v < used.size(); ++v)
        if (used[v]) vertices_.push_back(v);
    carriers_of_vertex_ = CompressedRows<Carrier>(pool_.size(), pairs);
}

void ContactFinder::make_trees() {
    std::vector<Box> boxes(edges_.keys.size());
    for (std::uint32_t e = 0; e < boxes.size(); ++e)
        for (const Vec3& p : segment(e)) boxes[e].add(p);
    edge_trees_.emplace(std::move(boxes), edges_.fresh);
    boxes.assign(pieces_.triangles.size(), {});
    std::vector<char> fresh(pieces_.triangles.size());
    for (std::uint32_t t = 0; t < boxes.size(); ++t) {
        for (const Vec3& p : points(t)) boxes[t].add(p);
        fresh[t] = pieces_.triangles[t].fresh;
    }
    triangle_trees_.emplace(std::move(boxes), fresh);
}

void ContactFinder::vertex_to_edges(Vertex v) {
    const Vec3 p = pool_[v];
    Box around;
    around.add(p);
    around = around.grown(reach_);
    edge_trees_->query(is_fresh(v), [&](const Box& b) { return b.meets(around); }, [&](std::uint32_t e) {
        const auto [a, b] = ends(e);
        if (a == v || b == v) return;
        const double gap = distance_to_segment(p, pool_[a], pool_[b]);
        // what is a contact for validation (half the least reach) must be joined in any case
        if (gap > reach_ || (!pieces_.join_needles && gap > 0.6 * reach_ && is_needle(v, e))) return;
        put_on_edge(v, e);
        ++pieces_.actions.vertices_joined_to_edges;
        note_common(carriers_of_vertex_[v], edges_.carriers[e], v);
    });
}

void ContactFinder::vertex_to_triangles(Vertex v) {
    const Vec3 p = pool_[v];
    Box around;
    around.add(p);
    around = around.grown(reach_);
    triangle_trees_->query(is_fresh(v), [&](const Box& b) { return b.meets(around); }, [&](std::uint32_t t) {
        const Corners& c = corners(t);
        if (c[0] == v || c[1] == v || c[2] == v || distance_to_triangle(p, points(t)) > reach_ || is_near_edge_of(p, t)) return;
        put_inside(v, t);
        ++pieces_.actions.vertices_joined_to_facets;
        const std::array<Carrier, 1> one{t};
        note_common(carriers_of_vertex_[v], one, v);
    });
}

/// Splits of splits, too, as deep as they go: each was made later than the one that it splits.
void ContactFinder::follow_split(std::uint32_t e) {
    if (!splits_.contains(edges_.keys[e])) return;
    std::vector<Vertex> chain;
    append_split_chain(splits_, ends(e)[0], {ends(e)[1]}, chain);
    chain.push_back(ends(e)[1]);
    for (const Vertex v : chain) put_on_edge(v, e);
    split_chains_.emplace_back(edges_.keys[e], std::move(chain));
}

/// What is near an edge that others have in pieces is a matter of these pieces: the others must find it, too.
void ContactFinder::hand_down_to_splits() {
    for (const auto& [key, chain] : split_chains_) {
        for (const Vertex v : std::exchange(found_.on_edge[key], {})) {
            if (std::find(chain.begin(), chain.end(), v) != chain.end()) continue;
            std::size_t nearest = 0;
            double least = std::numeric_limits<double>::infinity();
            for (std::size_t i = 0; i + 1 < chain.size(); ++i)
                if (const double gap = distance_to_segment(pool_[v], pool_[chain[i]], pool_[chain[i + 1]]); gap < least) {
                    least = gap;
                    nearest = i;
                }
            found_.on_edge[piece_edge(chain[nearest], chain[nearest + 1])].push_back(v);
        }
    }
}

void ContactFinder::gather_from_splits() {
    for (const auto& [key, chain] : split_chains_) {
        std::vector<Vertex> all;
        for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
            if (i > 0) all.push_back(chain[i]);
            const auto found = found_.on_edge.find(piece_edge(chain[i], chain[i + 1]));
            if (found == found_.on_edge.end()) continue;
            all.insert(all.end(), found->second.begin(), found->second.end());
            if (chain[i] > chain[i + 1]) std::reverse(all.end() - static_cast<std::ptrdiff_t>(found->second.size()), all.end());
        }
        found_.on_edge[key] = std::move(all);
    }
}

void ContactFinder::edge_to_edges(std::uint32_t e) {
    const auto [a, b] = ends(e);
    const auto here = segment(e);
    const Box around = edge_trees_->box(e).grown(reach_);
    const bool fresh = edges_.fresh[e] != 0;
    const SegmentClipper line(here[0], here[1]);
    edge_trees_->query(fresh, [&](const Box& box) { return box.meets(around) && line.meets(box.grown(reach_)); }, [&](std::uint32_t f) {
        if (f <= e && (fresh || f == e) && edges_.fresh[f] != 0) return;  // once for each pair
        if (f == e) return;
        const auto [c, d] = ends(f);
        if (a == c || a == d || b == c || b == d) return;
        const auto there = segment(f);
        const ClosestPair closest = closest_between(here, there);
        if (distance(closest.on_first, closest.on_second) > reach_) return;
        for (const Vec3& p : here)
            if (distance_to_segment(p, there[0], there[1]) <= reach_) return;  // a matter of vertices
        for (const Vec3& p : there)
            if (distance_to_segment(p, here[0], here[1]) <= reach_) return;
        const Vertex x = pool_.find_or_add(closest.on_first + 0.5 * (closest.on_second - closest.on_first));
        put_on_edge(x, e);
        put_on_edge(x, f);
        note_common(edges_.carriers[e], edges_.carriers[f], x);
    });
}

void ContactFinder::edge_to_triangles(std::uint32_t e) {
    const auto [a, b] = ends(e);
    const auto here = segment(e);
    const Box around = edge_trees_->box(e);
    const SegmentClipper line(here[0], here[1]);
    triangle_trees_->query(edges_.fresh[e] != 0, [&](const Box& box) { return box.meets(around) && line.meets(box); }, [&](std::uint32_t t) {
        for (const Vertex v : corners(t))
            if (v == a || v == b) return;
        const auto q = points(t);
        const Sign from = orient3d(q[0], q[1], q[2], here[0]), to = orient3d(q[0], q[1], q[2], here[1]);
        if (from == to || from == Sign::zero || to == Sign::zero) return;
        const Sign first = orient3d(here[0], here[1], q[0], q[1]);
        if (first == Sign::zero || orient3d(here[0], here[1], q[1], q[2]) != first || orient3d(here[0], here[1], q[2], q[0]) != first) return;
        for (const Vec3& p : here)
            if (distance_to_triangle(p, q) <= reach_) return;  // a matter of vertices
        for (std::size_t i = 0; i < 3; ++i) {
            const ClosestPair closest = closest_between(here, {q[i], q[(i + 1) % 3]});
            if (distance(closest.on_first, closest.on_second) <= reach_) return;  // a matter of edges
        }
        const Vertex x = pool_.find_or_add(piercing_point(here, q));
        put_on_edge(x, e);
        put_inside(x, t);
        const std::array<Carrier, 1> one{t};
        note_common(edges_.carriers[e], one, x);
    });
}

void ContactFinder::sort_lists() {
    for (auto& [key, list] : found_.on_edge) {
        const Vec3 &a = pool_[edge_ends(key)[0].value()], &b = pool_[edge_ends(key)[1].value()];
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
        std::stable_sort(list.begin(), list.end(), [&](Vertex v, Vertex w) { return dot(pool_[v] - a, b - a) < dot(pool_[w] - a, b - a); });
    }
    for (auto& list : found_.inside) {
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    }
}

void ContactFinder::draw_lines() {
    std::sort(common_.begin(), common_.end());
    common_.erase(std::unique(common_.begin(), common_.end()), common_.end());
    std::vector<Vertex> common;
    for (std::size_t i = 0; i < common_.size();) {
        const Carrier s = common_[i].first, t = common_[i].second;
        common.clear();
        for (; i < common_.size() && common_[i].first == s && common_[i].second == t; ++i) common.push_back(common_[i].vertex);
        if (!is_triangle(s)) continue;  // two wires
        for (const Vertex v : corners(s)) {
            const bool shared = is_triangle(t) ? std::find(corners(t).begin(), corners(t).end(), v) != corners(t).end()
                                               : v == pieces_.wires[t - pieces_.triangles.size()].v[0] || v == pieces_.wires[t - pieces_.triangles.size()].v[1];
            if (shared) common.push_back(v);
        }
        std::sort(common.begin(), common.end());
        common.erase(std::unique(common.begin(), common.end()), common.end());
        if (common.size() > 1) draw_lines(s, t, common);
    }
}

/// Common vertices on one line: the triangles intersect along it. Otherwise they lie in one plane, and the edges of each run through the other.
void ContactFinder::draw_lines(Carrier s, Carrier t, std::vector<Vertex> common) {
    Vertex a = common[0], b = common[1];
    for (std::size_t i = 0; i < common.size(); ++i)
        for (std::size_t j = i + 1; j < common.size(); ++j)
            if (distance(pool_[common[i]], pool_[common[j]]) > distance(pool_[a], pool_[b])) {
                a = common[i];
                b = common[j];
            }
    const bool on_line = std::all_of(common.begin(), common.end(), [&](Vertex v) { return distance_to_segment(pool_[v], pool_[a], pool_[b]) <= 2 * reach_; });
    if (on_line) {
        const Vec3 from = pool_[a], along = pool_[b] - pool_[a];
        std::stable_sort(common.begin(), common.end(), [&](Vertex v, Vertex w) { return dot(pool_[v] - from, along) < dot(pool_[w] - from, along); });
        for (std::size_t i = 0; i + 1 < common.size(); ++i)
            for (const Carrier c : {s, t})
                if (is_triangle(c)) found_.lines[c].push_back({{common[i], common[i + 1]}, c == s ? t : s});
        return;
    }
    draw_along_edges(s, t, common);
    draw_along_edges(t, s, common);
}

/// Parts of the edges of s between vertices that t has, too, are lines of t.
void ContactFinder::draw_along_edges(Carrier s, Carrier t, const std::vector<Vertex>& common) {
    if (!is_triangle(t)) return;
    std::vector<Ends> sides;
    if (is_triangle(s))
        for (std::size_t i = 0; i < 3; ++i) sides.push_back({corners(s)[i], corners(s)[(i + 1) % 3]});
    else
        sides.push_back(pieces_.wires[s - pieces_.triangles.size()].v);
    const auto is_common = [&](Vertex v) { return std::binary_search(common.begin(), common.end(), v); };
    for (const auto& [a, b] : sides) {
        std::vector<Vertex> chain{std::min(a, b)};
        if (const auto split = found_.on_edge.find(piece_edge(a, b)); split != found_.on_edge.end())
            chain.insert(chain.end(), split->second.begin(), split->second.end());
        chain.push_back(std::max(a, b));
        for (std::size_t i = 0; i + 1 < chain.size(); ++i)
            if (is_common(chain[i]) && is_common(chain[i + 1])) found_.lines[t].push_back({{chain[i], chain[i + 1]}, s});
    }
}

}  // namespace

Contacts find_contacts(Pieces& pieces, const EdgeSplits& splits) { return ContactFinder(pieces, splits).run(); }

}  // namespace wellmesh
