// SPDX-License-Identifier: Apache-2.0
#include "repair/resolve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/vec3_math.hpp"
#include "repair/cut_triangle.hpp"
#include "repair/find_contacts.hpp"
#include "wellmesh/error.hpp"

namespace wellmesh {
namespace {

using Vertex = std::uint32_t;

/// Vertices that stand for others from now on.
class Aliases {
public:
    void add(Vertex kept, Vertex gone) {
        kept = (*this)(kept);
        gone = (*this)(gone);
        if (kept != gone) of_[std::max(kept, gone)] = std::min(kept, gone);
    }
    [[nodiscard]] Vertex operator()(Vertex v) const {
        for (auto found = of_.find(v); found != of_.end(); found = of_.find(v)) v = found->second;
        return v;
    }
    [[nodiscard]] bool empty() const { return of_.empty(); }

private:
    std::map<Vertex, Vertex> of_;  // to smaller ones
};

class Round {
public:
    Round(StatedPieces& stated, const Contacts& contacts, EdgeSplits& splits)
        : stated_(stated), pieces_(stated.pieces), contacts_(contacts), splits_(splits) {}

    void run() {
        std::vector<Piece> old = std::move(pieces_.triangles);
        pieces_.triangles.clear();
        for (std::uint32_t t = 0; t < old.size(); ++t) add(t, old[t]);
        split_wires();
        if (!aliases_.empty()) rename();
        merge_copies(pieces_);
    }

private:
    /// All vertices from a to b, but for b.
    void append_chain(Vertex a, Vertex b, std::vector<Vertex>& chain) const {
        std::vector<Vertex> stops{b};  // from the last to the next
        if (const auto found = contacts_.on_edge.find(piece_edge(a, b)); found != contacts_.on_edge.end()) {
            stops.insert(stops.end(), found->second.begin(), found->second.end());
            if (a < b) std::reverse(stops.begin() + 1, stops.end());
        }
        // Another triangle may have split the edge in this round already; two that split it each in their way would no longer meet.
        append_split_chain(splits_, a, std::move(stops), chain);
    }
    void add(std::uint32_t number, const Piece& piece);
    void split_wires();
    void rename();
    void rename_splits();
    void note_split(const std::array<Vertex, 2>& edge, Vertex inside);
    [[nodiscard]] Vec3 normal_of(const Piece& piece) const;

    StatedPieces& stated_;
    Pieces& pieces_;
    const Contacts& contacts_;
    EdgeSplits& splits_;
    Aliases aliases_;
    TriplePoints triples_;
};

/// A normal for the choice of a projection: of a triangle without area, one that keeps its vertices apart.
Vec3 Round::normal_of(const Piece& piece) const {
    const Vec3& a = pieces_.pool[piece.v[0]];
    const Vec3 u = pieces_.pool[piece.v[1]] - a, v = pieces_.pool[piece.v[2]] - a, normal = cross(u, v);
    constexpr double kNoise = 4 * std::numeric_limits<double>::epsilon();  // what products of rounded differences are off by, at least
    if (norm(normal) > kNoise * norm(u) * norm(v)) return normal;
    const Vec3 along = squared_norm(u) > squared_norm(v) ? u : v;
    const double x = std::abs(along.x), y = std::abs(along.y), z = std::abs(along.z);
    return x <= y && x <= z ? Vec3{1, 0, 0} : y <= z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
}

void Round::add(std::uint32_t number, const Piece& piece) {
    const auto& inside = contacts_.inside[number];
    const auto& lines = contacts_.lines[number];
    std::vector<Vertex> loop;
    for (std::size_t i = 0; i < 3; ++i) append_chain(piece.v[i], piece.v[(i + 1) % 3], loop);
    if (loop.size() == 3 && inside.empty() && lines.empty()) {
        pieces_.triangles.push_back(piece);
        pieces_.triangles.back().fresh = false;
        return;
    }
    stated_.facet_changed[pieces_.sources[piece.source].facet] = 1;
    CutTask task;
    task.border = border_of(std::move(loop));
    CutResult result;
    if (!task.border.empty()) {
        task.lines = lines;
        task.self = number;
        task.only_border_encloses = true;
        task.points = inside;
        task.normal = normal_of(piece);
        result = cut(std::move(task), pieces_.pool, triples_);
        for (const auto& split : result.splits) note_split(split.edge, split.inside);
    }
    if (result.triangles.empty()) ++pieces_.actions.degenerate_dropped;
    for (const auto& [kept, gone] : result.stacked) aliases_.add(kept, gone);
    for (std::size_t i = 0; i < result.triangles.size(); ++i)
        pieces_.triangles.push_back({result.triangles[i], piece.source, piece.winding * result.windings[i], true});
}

void Round::split_wires() {
    std::vector<WirePiece> old = std::move(pieces_.wires);
    pieces_.wires.clear();
    for (const WirePiece& wire : old) {
        std::vector<Vertex> chain;
        append_chain(wire.v[0], wire.v[1], chain);
        chain.push_back(wire.v[1]);
        for (std::size_t i = 0; i + 1 < chain.size(); ++i) pieces_.wires.push_back({{chain[i], chain[i + 1]}, wire.owner, wire.stated, chain.size() > 2});
    }
}

void Round::rename() {
    std::erase_if(pieces_.triangles, [&](Piece& t) {
        for (Vertex& v : t.v)
            if (const Vertex w = aliases_(v); w != v) {
                v = w;
                t.fresh = true;
                stated_.facet_changed[pieces_.sources[t.source].facet] = 1;
            }
        return t.v[0] == t.v[1] || t.v[1] == t.v[2] || t.v[2] == t.v[0];
    });
    std::erase_if(pieces_.wires, [&](WirePiece& wire) {
        for (Vertex& v : wire.v)
            if (const Vertex w = aliases_(v); w != v) {
                v = w;
                wire.fresh = true;
            }
        return wire.v[0] == wire.v[1];
    });
    rename_splits();
    for (Vertex& v : pieces_.lone) v = aliases_(v);
    std::sort(pieces_.lone.begin(), pieces_.lone.end());
    pieces_.lone.erase(std::unique(pieces_.lone.begin(), pieces_.lone.end()), pieces_.lone.end());
    for (std::uint32_t& v : stated_.of_input)
        if (v != StatedPieces::kUnusable) v = aliases_(v);
}

/// If one triangle finds x on an edge from v, and another finds v on the edge from x to the same end, both within half the reach, the two are one.
void Round::note_split(const std::array<Vertex, 2>& edge, Vertex inside) {
    for (std::size_t i = 0; i < 2; ++i)
        if (const auto found = splits_.find(piece_edge(edge[i], inside)); found != splits_.end() && found->second == edge[1 - i]) {
            aliases_.add(inside, edge[1 - i]);
            return;
        }
    splits_.try_emplace(piece_edge(edge[0], edge[1]), inside);
}

/// Those who have the edge under its new name must hear of the split, too. Where two edges become one it is split at both vertices, in their order.
void Round::rename_splits() {
    std::vector<std::pair<EdgeKey, Vertex>> old(splits_.begin(), splits_.end());
    std::sort(old.begin(), old.end());
    splits_.clear();
    for (const auto& [key, inside] : old) {
        Vertex a = aliases_(edge_ends(key)[0].value()), b = aliases_(edge_ends(key)[1].value());
        const Vertex x = aliases_(inside);
        while (a != b && x != a && x != b) {
            const auto [known, fresh] = splits_.try_emplace(piece_edge(a, b), x);
            const Vertex y = known->second;
            if (fresh || y == x) break;
            const Vec3 along = pieces_.pool[b] - pieces_.pool[a];
            (dot(pieces_.pool[x] - pieces_.pool[y], along) < 0 ? b : a) = y;
        }
    }
}

}  // namespace

void merge_copies(Pieces& pieces) {
    std::vector<std::uint32_t> order(pieces.triangles.size());
    std::vector<std::array<Vertex, 3>> sorted(order.size());
    for (std::uint32_t t = 0; t < order.size(); ++t) {
        order[t] = t;
        sorted[t] = pieces.triangles[t].v;
        std::sort(sorted[t].begin(), sorted[t].end());
    }
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return sorted[a] != sorted[b] ? sorted[a] < sorted[b] : a < b; });
    std::vector<char> gone(order.size(), 0);
    for (std::size_t i = 0; i < order.size();) {
        Piece& first = pieces.triangles[order[i]];
        const auto at = static_cast<std::size_t>(std::min_element(first.v.begin(), first.v.end()) - first.v.begin());
        std::size_t j = i + 1;
        for (; j < order.size() && sorted[order[j]] == sorted[order[i]]; ++j) {
            const Piece& copy = pieces.triangles[order[j]];
            const auto there = static_cast<std::size_t>(std::min_element(copy.v.begin(), copy.v.end()) - copy.v.begin());
            first.winding += first.v[(at + 1) % 3] == copy.v[(there + 1) % 3] ? copy.winding : -copy.winding;
            first.fresh = first.fresh || copy.fresh;
            gone[order[j]] = 1;
            ++pieces.actions.duplicates_dropped;
        }
        i = j;
    }
    std::size_t kept = 0;
    for (std::size_t t = 0; t < gone.size(); ++t)
        if (!gone[t]) pieces.triangles[kept++] = pieces.triangles[t];
    pieces.triangles.resize(kept);

    const auto key = [](const WirePiece& w) { return piece_edge(w.v[0], w.v[1]); };
    std::stable_sort(pieces.wires.begin(), pieces.wires.end(), [&](const WirePiece& a, const WirePiece& b) {
        if (key(a) != key(b)) return key(a) < key(b);
        return a.stated && !b.stated;
    });
    pieces.wires.erase(std::unique(pieces.wires.begin(), pieces.wires.end(), [&](const WirePiece& a, const WirePiece& b) { return key(a) == key(b); }),
                       pieces.wires.end());
}

Resolution resolve(StatedPieces& stated, double least_reach, const std::stop_token& stop) {
    constexpr std::size_t kMostGrowth = 24;  // overlapping bodies of thousands of facets grew three- to tenfold
    constexpr unsigned kMostRounds = 60;  // inputs with thousands of intersections took five to ten
    // What lies closer than the tolerance may have no triangulation without needles lower than it, and joining one would make the next: everything is
    // joined once. From then on the reach merely keeps vertices apart from contacts of a few ulp.
    Pieces& pieces = stated.pieces;
    Resolution result;
    EdgeSplits splits;
    merge_copies(pieces);
    const std::size_t most_triangles = kMostGrowth * pieces.triangles.size() + 10000;
    while (result.rounds < kMostRounds && pieces.triangles.size() <= most_triangles) {
        if (stop.stop_requested()) throw MeshError(ErrorCode::cancelled, Stage::validate, "interrupted while repairing");
        ++result.rounds;
        if (result.rounds > 1) pieces.pool.shrink_reach(least_reach);
        pieces.join_needles = result.rounds <= 2;
        const std::uint32_t vertices = pieces.pool.size();
        const Contacts contacts = find_contacts(pieces, splits);
        splits.clear();
        if (contacts.empty()) {
            result.complete = true;
            break;
        }
        Round(stated, contacts, splits).run();
        pieces.first_fresh_vertex = vertices;
    }
    return result;
}

}  // namespace wellmesh
