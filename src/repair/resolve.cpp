// SPDX-License-Identifier: Apache-2.0
#include "repair/resolve.hpp"

#include <algorithm>
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
    void append_chain(Vertex a, Vertex b, std::vector<Vertex>& loop) const {
        loop.push_back(a);
        const auto found = contacts_.on_edge.find(piece_edge(a, b));
        if (found == contacts_.on_edge.end()) return;
        if (a < b)
            loop.insert(loop.end(), found->second.begin(), found->second.end());
        else
            loop.insert(loop.end(), found->second.rbegin(), found->second.rend());
    }
    void add(std::uint32_t number, const Piece& piece);
    void split_wires();
    void rename();

    StatedPieces& stated_;
    Pieces& pieces_;
    const Contacts& contacts_;
    EdgeSplits& splits_;
    Aliases aliases_;
    TriplePoints triples_;
};

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
        const Vec3& a = pieces_.pool[piece.v[0]];
        task.normal = cross(pieces_.pool[piece.v[1]] - a, pieces_.pool[piece.v[2]] - a);
        result = cut(std::move(task), pieces_.pool, triples_);
        for (const auto& split : result.splits) splits_.try_emplace(piece_edge(split.edge[0], split.edge[1]), split.inside);
    }
    if (result.triangles.empty()) ++pieces_.actions.degenerate_dropped;
    for (const auto& [kept, gone] : result.stacked) aliases_.add(kept, gone);
    for (const auto& v : result.triangles) pieces_.triangles.push_back({v, piece.source, piece.winding, true});
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
    for (Vertex& v : pieces_.lone) v = aliases_(v);
    std::sort(pieces_.lone.begin(), pieces_.lone.end());
    pieces_.lone.erase(std::unique(pieces_.lone.begin(), pieces_.lone.end()), pieces_.lone.end());
    for (std::uint32_t& v : stated_.of_input)
        if (v != StatedPieces::kUnusable) v = aliases_(v);
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
