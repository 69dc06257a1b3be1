// SPDX-License-Identifier: Apache-2.0
#include "repair/resolve.hpp"

#include <algorithm>
#include <map>
#include <cstdio>
#include <cstdlib>

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
    Round(StatedPieces& stated, const Contacts& contacts) : stated_(stated), pieces_(stated.pieces), contacts_(contacts) {}

    void run() {
        std::vector<Piece> old = std::move(pieces_.triangles);
        pieces_.triangles.clear();
        for (std::uint32_t t = 0; t < old.size(); ++t) add(old[t], contacts_.inside[t], contacts_.lines[t]);
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
    void add(const Piece& piece, const std::vector<Vertex>& inside, const std::vector<std::array<Vertex, 2>>& lines);
    void split_wires();
    void rename();

    StatedPieces& stated_;
    Pieces& pieces_;
    const Contacts& contacts_;
    Aliases aliases_;
};

void Round::add(const Piece& piece, const std::vector<Vertex>& inside, const std::vector<std::array<Vertex, 2>>& lines) {
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
        task.points = inside;
        const Vec3& a = pieces_.pool[piece.v[0]];
        task.normal = cross(pieces_.pool[piece.v[1]] - a, pieces_.pool[piece.v[2]] - a);
        result = cut(task, pieces_.pool);
    }
    if (result.triangles.empty()) ++pieces_.actions.degenerate_dropped;
    if (std::getenv("DBG2")) {
        std::fprintf(stderr, "DBG cut %u %u %u:", piece.v[0], piece.v[1], piece.v[2]);
        for (auto& e : task.border) std::fprintf(stderr, " b%u-%u", e[0], e[1]);
        for (auto& e : lines) std::fprintf(stderr, " l%u-%u", e[0], e[1]);
        for (auto& e : result.triangles) std::fprintf(stderr, " [%u %u %u]", e[0], e[1], e[2]);
        for (auto& e : result.stacked) std::fprintf(stderr, " s%u-%u", e[0], e[1]);
        std::fprintf(stderr, "\n");
        for (auto v : piece.v) std::fprintf(stderr, "DBG    %u %.17g %.17g %.17g\n", v, pieces_.pool[v].x, pieces_.pool[v].y, pieces_.pool[v].z);
    }
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
    constexpr unsigned kMostRounds = 60;  // inputs with thousands of intersections took five to ten
    // What lies closer than the tolerance may have no triangulation without needles lower than it, and joining one makes the next. So after some rounds
    // the reach shrinks, to what merely keeps new vertices apart from contacts of a few ulp.
    constexpr unsigned kFullRounds = 3;
    Pieces& pieces = stated.pieces;
    Resolution result;
    merge_copies(pieces);
    while (result.rounds < kMostRounds) {
        if (stop.stop_requested()) throw MeshError(ErrorCode::cancelled, Stage::validate, "interrupted while repairing");
        ++result.rounds;
        if (result.rounds > kFullRounds) pieces.pool.shrink_reach(std::max(least_reach, 0.5 * pieces.pool.reach()));
        const std::uint32_t vertices = pieces.pool.size();
        const Contacts contacts = find_contacts(pieces);
        if (contacts.empty()) {
            result.complete = true;
            break;
        }
        if (std::getenv("DBG")) {
            std::size_t in = 0, li = 0;
            for (auto& x : contacts.inside) in += x.size();
            for (auto& x : contacts.lines) li += x.size();
            std::fprintf(stderr, "DBG round %u tris %zu wires %zu verts %u on_edge %zu inside %zu lines %zu\n", result.rounds, pieces.triangles.size(), pieces.wires.size(), pieces.pool.size(), contacts.on_edge.size(), in, li);
            if (result.rounds > 50) {
                for (auto& [k, l] : contacts.on_edge) { auto e = edge_ends(k); std::fprintf(stderr, "DBG  edge %u %u (len %g):", e[0].value(), e[1].value(), distance(pieces.pool[e[0].value()], pieces.pool[e[1].value()])); for (auto v : l) std::fprintf(stderr, " %u", v); std::fprintf(stderr, "\n");
                  for (auto& t : pieces.triangles) { int n = 0; for (auto v : t.v) n += v == e[0].value() || v == e[1].value(); if (n == 2) std::fprintf(stderr, "DBG      tri %u %u %u fresh %d w %d\n", t.v[0], t.v[1], t.v[2], t.fresh, t.winding); } }
                for (std::size_t t = 0; t < contacts.inside.size(); ++t) for (auto v : contacts.inside[t]) std::fprintf(stderr, "DBG  tri %u %u %u has %u\n", pieces.triangles[t].v[0], pieces.triangles[t].v[1], pieces.triangles[t].v[2], v);
                for (std::size_t t = 0; t < contacts.inside.size(); ++t) for (auto v : contacts.lines[t]) std::fprintf(stderr, "DBG  tri %u %u %u line %u %u\n", pieces.triangles[t].v[0], pieces.triangles[t].v[1], pieces.triangles[t].v[2], v[0], v[1]);
            }
        }
        Round(stated, contacts).run();
        pieces.first_fresh_vertex = vertices;
    }
    return result;
}

}  // namespace wellmesh
