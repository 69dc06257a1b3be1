// SPDX-License-Identifier: Apache-2.0
#include "repair/assemble.hpp"

#include <algorithm>
#include <numeric>

#include "core/vec3_math.hpp"
#include "validation/closest_points.hpp"
#include "validation/find_cells.hpp"

namespace wellmesh {
namespace {

class Assembler {
public:
    Assembler(const Plc& plc, StatedPieces& stated) : plc_(plc), stated_(stated), pieces_(stated.pieces), pieces_of_(plc.facets.size()) {}

    Plc run() {
        out_ = plc_;
        for (std::uint32_t t = 0; t < pieces_.triangles.size(); ++t) pieces_of_[facet_of(t)].push_back(t);
        find_kept_facets();
        number_vertices();
        emit_facets();
        emit_segments();
        out_.vertex_lines.clear();
        out_.facet_lines.clear();
        return std::move(out_);
    }

private:
    [[nodiscard]] std::uint32_t facet_of(std::uint32_t t) const { return pieces_.sources[pieces_.triangles[t].source].facet; }
    void find_kept_facets();
    void number_vertices();
    void emit_facets();
    void emit_copies(const PlcFacet& facet, int winding);
    void emit_segments();

    const Plc& plc_;
    StatedPieces& stated_;
    const Pieces& pieces_;
    std::vector<std::vector<std::uint32_t>> pieces_of_;
    std::vector<char> kept_;             // facets that stay as stated
    std::vector<std::uint32_t> number_;  // of pool vertices in the result
    Plc out_;
};

/// A facet stays as it is if all its triangles are left, untouched and stated once.
void Assembler::find_kept_facets() {
    std::vector<std::uint32_t> stated(plc_.facets.size(), 0);
    for (const SourceTriangle& s : pieces_.sources) ++stated[s.facet];
    kept_.assign(plc_.facets.size(), 0);
    for (std::size_t f = 0; f < kept_.size(); ++f) {
        const auto& all = pieces_of_[f];
        const auto same = [&](std::uint32_t t) { return pieces_.triangles[t].winding == pieces_.triangles[all.front()].winding; };
        kept_[f] = !stated_.facet_changed[f] && !all.empty() && all.size() == stated[f] && std::all_of(all.begin(), all.end(), same);
    }
}

void Assembler::number_vertices() {
    std::vector<char> used(pieces_.pool.size(), 0);
    for (const Piece& t : pieces_.triangles)
        for (const std::uint32_t v : t.v) used[v] = 1;
    for (const WirePiece& w : pieces_.wires)
        for (const std::uint32_t v : w.v) used[v] = 1;
    for (const std::uint32_t v : pieces_.lone) used[v] = 1;
    std::vector<std::uint32_t> first_input(pieces_.pool.size(), StatedPieces::kUnusable);
    for (std::uint32_t i = static_cast<std::uint32_t>(stated_.of_input.size()); i-- > 0;)
        if (stated_.of_input[i] != StatedPieces::kUnusable) first_input[stated_.of_input[i]] = i;
    number_.assign(pieces_.pool.size(), StatedPieces::kUnusable);
    out_.vertices.clear();
    out_.vertex_markers.clear();
    out_.vertex_sizes.clear();
    const bool marked = plc_.vertex_markers.size() == plc_.vertices.size(), sized = plc_.vertex_sizes.size() == plc_.vertices.size();
    for (std::uint32_t v = 0; v < used.size(); ++v) {
        if (!used[v]) {
            if (first_input[v] != StatedPieces::kUnusable) ++stated_.pieces.actions.unused_vertices_dropped;
            continue;
        }
        number_[v] = static_cast<std::uint32_t>(out_.vertices.size());
        out_.vertices.push_back(pieces_.pool[v]);
        const bool stated = first_input[v] != StatedPieces::kUnusable;
        if (marked) out_.vertex_markers.push_back(stated ? plc_.vertex_markers[first_input[v]] : 0);
        if (sized) out_.vertex_sizes.push_back(stated ? plc_.vertex_sizes[first_input[v]] : 0);
        if (!stated) ++stated_.pieces.actions.intersection_points;
    }
}

/// In surface files copies carry the winding number on: none for 1, two that cancel for 0, as where solids touch.
void Assembler::emit_copies(const PlcFacet& facet, int winding) {
    const auto turned = [](PlcFacet copy) {
        for (auto& polygon : copy.polygons) std::reverse(polygon.begin() + 1, polygon.end());
        return copy;
    };
    if (plc_.fill != FillRule::nonzero_winding || winding > 0) {
        const int copies = plc_.fill == FillRule::nonzero_winding ? winding : 1;
        for (int i = 0; i < copies; ++i) out_.facets.push_back(facet);
    } else if (winding < 0) {
        for (int i = 0; i < -winding; ++i) out_.facets.push_back(turned(facet));
    } else {
        out_.facets.push_back(facet);
        out_.facets.push_back(turned(facet));
    }
}

void Assembler::emit_facets() {
    out_.facets.clear();
    for (std::uint32_t f = 0; f < plc_.facets.size(); ++f) {
        const PlcFacet& stated = plc_.facets[f];
        if (kept_[f]) {
            PlcFacet facet = stated;
            for (auto& polygon : facet.polygons)
                for (std::uint32_t& v : polygon) v = number_[stated_.of_input[v]];
            emit_copies(facet, pieces_.triangles[pieces_of_[f].front()].winding);
            continue;
        }
        if (pieces_of_[f].size() > 1) ++stated_.pieces.actions.facets_cut;
        for (const std::uint32_t t : pieces_of_[f]) {
            PlcFacet facet;
            facet.marker = stated.marker;
            const auto& v = pieces_.triangles[t].v;
            facet.polygons = {{number_[v[0]], number_[v[1]], number_[v[2]]}};
            emit_copies(facet, pieces_.triangles[t].winding);
        }
    }
}

/// Edges of polygons stay segments where their facet has become triangles, which would melt into coplanar neighbours.
void Assembler::emit_segments() {
    out_.segments.clear();
    for (const WirePiece& w : pieces_.wires) {
        if (!w.stated && kept_[w.owner]) continue;
        const std::int32_t marker = w.stated ? plc_.segments[w.owner].marker : 0;
        out_.segments.push_back({{number_[w.v[0]], number_[w.v[1]]}, marker});
    }
}

}  // namespace

void drop_idle_pieces(Pieces& pieces, bool drop_inner) {
    std::vector<Vec3> points;
    for (std::uint32_t v = 0; v < pieces.pool.size(); ++v) points.push_back(pieces.pool[v]);
    std::vector<SoupTriangle> soup;
    for (const Piece& t : pieces.triangles) soup.push_back({{VertexId{t.v[0]}, VertexId{t.v[1]}, VertexId{t.v[2]}}, 0});
    if (soup.empty()) return;
    const EdgeTable edges = make_edge_table(soup);
    const LineQuery lines(points, soup);
    const CellMap map = find_cells(points, soup, edges, lines);
    std::vector<int> weights;
    for (const Piece& t : pieces.triangles) weights.push_back(t.winding);
    const auto winding = winding_numbers(map, weights);
    if (!winding) return;
    const auto filled = [&](SideId side) { return (*winding)[map.cell_of_side[side]] != 0; };
    std::size_t kept = 0;
    int common = 0;
    for (std::uint32_t t = 0; t < soup.size(); ++t) {
        const Piece& piece = pieces.triangles[t];
        const bool one_cell = map.cell_of_side[2 * t] == map.cell_of_side[2 * t + 1];
        if (piece.winding == 0 && one_cell) {
            ++pieces.actions.folds_dropped;
            continue;
        }
        if (drop_inner && filled(2 * t) == filled(2 * t + 1)) {
            ++pieces.actions.inner_dropped;
            continue;
        }
        Piece next = piece;
        if (drop_inner) next.winding = filled(2 * t) ? -1 : 1;
        common = std::gcd(common, next.winding);
        pieces.triangles[kept++] = next;
    }
    pieces.triangles.resize(kept);
    if (common > 1)  // the whole surface stated several times
        for (Piece& piece : pieces.triangles) piece.winding /= common;
}

Plc assemble(const Plc& plc, StatedPieces& stated) { return Assembler(plc, stated).run(); }

Displacement displacement_of(const Plc& plc, const StatedPieces& stated) {
    Displacement most;
    for (std::size_t i = 0; i < plc.vertices.size(); ++i)
        if (const std::uint32_t v = stated.of_input[i]; v != StatedPieces::kUnusable) most.note(distance(plc.vertices[i], stated.pieces.pool[v]), plc.vertices[i]);
    // distance from a triangle is a convex function, so a piece is nowhere farther than at its worst corner
    for (const Piece& piece : stated.pieces.triangles)
        for (const std::uint32_t v : piece.v)
            most.note(distance_to_triangle(stated.pieces.pool[v], stated.pieces.sources[piece.source].p), stated.pieces.pool[v]);
    for (const WirePiece& wire : stated.pieces.wires) {
        if (!wire.stated) continue;
        const auto& ends = plc.segments[wire.owner].vertices;
        for (const std::uint32_t v : wire.v)
            most.note(distance_to_segment(stated.pieces.pool[v], plc.vertices[ends[0]], plc.vertices[ends[1]]), stated.pieces.pool[v]);
    }
    return most;
}

}  // namespace wellmesh
