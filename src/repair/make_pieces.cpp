// SPDX-License-Identifier: Apache-2.0
#include "repair/make_pieces.hpp"

#include <algorithm>
#include <unordered_map>

#include "core/vec3_math.hpp"
#include "predicates/exact_range.hpp"
#include "repair/cut_triangle.hpp"
#include "validation/plane.hpp"

namespace wellmesh {
namespace {

using Polygon = std::vector<std::uint32_t>;

class PieceMaker {
public:
    PieceMaker(const Plc& plc, double reach) : plc_(plc), out_(reach) {}

    StatedPieces run() {
        add_vertices();
        out_.facet_changed.assign(plc_.facets.size(), 0);
        for (std::uint32_t f = 0; f < plc_.facets.size(); ++f) add_facet(f);
        for (std::uint32_t s = 0; s < plc_.segments.size(); ++s) add_segment(s);
        if (plc_.fill == FillRule::bounded_cells)  // there, vertices that nothing uses are points to keep
            for (const std::uint32_t v : out_.of_input)
                if (v != StatedPieces::kUnusable) out_.pieces.lone.push_back(v);
        std::sort(out_.pieces.lone.begin(), out_.pieces.lone.end());
        out_.pieces.lone.erase(std::unique(out_.pieces.lone.begin(), out_.pieces.lone.end()), out_.pieces.lone.end());
        return std::move(out_);
    }

private:
    void add_vertices();
    bool usable(const Polygon& stated, Polygon& polygon, bool& moved) const;
    void add_facet(std::uint32_t f);
    void add_polygons(std::uint32_t f, const std::vector<Polygon>& polygons);
    void add_segment(std::uint32_t s);
    void add_triangle(std::uint32_t f, const std::array<std::uint32_t, 3>& v, const std::array<Vec3, 3>& stated) {
        out_.pieces.triangles.push_back({v, static_cast<std::uint32_t>(out_.pieces.sources.size()), 1, true});
        out_.pieces.sources.push_back({stated, f});
    }
    [[nodiscard]] const Vec3& point(std::uint32_t v) const { return out_.pieces.pool[v]; }

    const Plc& plc_;
    StatedPieces out_;
};

void PieceMaker::add_vertices() {
    for (const Vec3& p : plc_.vertices) {
        if (!in_exact_range(p)) {
            out_.of_input.push_back(StatedPieces::kUnusable);
            continue;
        }
        const std::uint32_t before = out_.pieces.pool.size();
        const std::uint32_t v = out_.pieces.pool.find_or_add({p.x + 0.0, p.y + 0.0, p.z + 0.0});  // -0 + 0 is 0
        if (v < before) ++out_.pieces.actions.vertices_merged;
        out_.of_input.push_back(v);
    }
}

/// Without repeated vertices. `moved` becomes true if a vertex is not where the input has it.
bool PieceMaker::usable(const Polygon& stated, Polygon& polygon, bool& moved) const {
    for (const std::uint32_t v : stated) {
        if (v >= out_.of_input.size() || out_.of_input[v] == StatedPieces::kUnusable) return false;
        const std::uint32_t id = out_.of_input[v];
        moved = moved || !(point(id) == plc_.vertices[v]);
        if (polygon.empty() || polygon.back() != id) polygon.push_back(id);
    }
    while (polygon.size() > 1 && polygon.front() == polygon.back()) polygon.pop_back();
    return true;
}

void PieceMaker::add_facet(std::uint32_t f) {
    const PlcFacet& facet = plc_.facets[f];
    std::vector<Polygon> polygons;
    std::size_t corners = 0, stated_corners = 0;
    bool moved = false;
    for (const Polygon& stated : facet.polygons) {
        if (stated.empty()) continue;
        Polygon polygon;
        if (!usable(stated, polygon, moved)) {
            ++out_.pieces.actions.unusable_dropped;
            out_.facet_changed[f] = 1;
            return;
        }
        moved = moved || polygon.size() != stated.size();
        corners = std::max(corners, polygon.size());
        stated_corners = std::max(stated_corners, stated.size());
        polygons.push_back(std::move(polygon));
    }
    if (moved) out_.facet_changed[f] = 1;
    if (corners < 3) {
        if (stated_corners >= 3) {
            ++out_.pieces.actions.degenerate_dropped;
            out_.facet_changed[f] = 1;
            return;
        }
        for (const Polygon& p : polygons)
            if (p.size() == 2)
                out_.pieces.wires.push_back({{p[0], p[1]}, f, false, true});
            else
                out_.pieces.lone.push_back(p[0]);
        return;
    }
    if (polygons.size() == 1 && corners == 3 && facet.holes.empty()) {
        const Polygon& p = polygons[0];
        const auto& stated = facet.polygons.front();
        if (stated.size() == 3)
            add_triangle(f, {p[0], p[1], p[2]}, {plc_.vertices[stated[0]], plc_.vertices[stated[1]], plc_.vertices[stated[2]]});
        else
            add_triangle(f, {p[0], p[1], p[2]}, {point(p[0]), point(p[1]), point(p[2])});
        return;
    }
    add_polygons(f, polygons);
}

void PieceMaker::add_polygons(std::uint32_t f, const std::vector<Polygon>& polygons) {
    CutTask task;
    std::vector<Vec3> points;
    Vec3 area{};
    for (const Polygon& p : polygons) {
        Vec3 sum{};
        for (std::size_t i = 0; i < p.size(); ++i) {
            points.push_back(point(p[i]));
            if (p.size() == 1) task.points.push_back(p[0]);
            if (p.size() > 1) task.border.push_back({p[i], p[(i + 1) % p.size()]});
            if (i > 0 && i + 1 < p.size()) sum = sum + cross(point(p[i]) - point(p[0]), point(p[i + 1]) - point(p[0]));
        }
        if (squared_norm(sum) > squared_norm(area)) area = sum;
    }
    task.normal = fit_plane(points).normal;
    if (dot(task.normal, area) < 0) task.normal = -task.normal;  // the largest polygon says which side is the front
    task.holes = plc_.facets[f].holes;
    const std::size_t edges = task.border.size();
    const std::uint32_t vertices = out_.pieces.pool.size();
    std::vector<std::uint32_t> all = task.points;
    for (const auto& e : task.border) all.push_back(e[0]);
    TriplePoints none;
    const CutResult pieces = cut(std::move(task), out_.pieces.pool, none);
    if (pieces.lines.size() != edges || out_.pieces.pool.size() != vertices || !pieces.stacked.empty() || pieces.triangles.empty()) out_.facet_changed[f] = 1;
    if (pieces.triangles.empty()) ++out_.pieces.actions.degenerate_dropped;
    std::unordered_map<EdgeKey, int> covered;
    for (const auto& t : pieces.triangles) {
        add_triangle(f, t, {point(t[0]), point(t[1]), point(t[2])});
        for (std::size_t i = 0; i < 3; ++i) ++covered[piece_edge(t[i], t[(i + 1) % 3])];
    }
    for (const auto& e : pieces.lines) {
        const auto sides = covered.find(piece_edge(e[0], e[1]));
        if (plc_.merge_coplanar == MergeRule::all && sides != covered.end() && sides->second == 1) continue;  // may vanish next to a coplanar facet
        out_.pieces.wires.push_back({{e[0], e[1]}, f, false, true});
    }
    out_.pieces.lone.insert(out_.pieces.lone.end(), all.begin(), all.end());
}

void PieceMaker::add_segment(std::uint32_t s) {
    const auto& ends = plc_.segments[s].vertices;
    Polygon polygon;
    bool moved = false;
    if (!usable({ends[0], ends[1]}, polygon, moved)) {
        ++out_.pieces.actions.unusable_dropped;
        return;
    }
    if (polygon.size() == 2)
        out_.pieces.wires.push_back({{polygon[0], polygon[1]}, s, true, true});
    else
        out_.pieces.lone.push_back(polygon[0]);
}

}  // namespace

StatedPieces make_pieces(const Plc& plc, double reach) { return PieceMaker(plc, reach).run(); }

void orient_consistently(StatedPieces& stated) {
    Pieces& pieces = stated.pieces;
    std::unordered_map<EdgeKey, std::vector<std::uint32_t>> around;
    for (std::uint32_t t = 0; t < pieces.triangles.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i) around[piece_edge(pieces.triangles[t].v[i], pieces.triangles[t].v[(i + 1) % 3])].push_back(3 * t + static_cast<std::uint32_t>(i));
    const auto area = [&](std::uint32_t t) {
        const auto& v = pieces.triangles[t].v;
        return norm(cross(pieces.pool[v[1]] - pieces.pool[v[0]], pieces.pool[v[2]] - pieces.pool[v[0]]));
    };
    constexpr char kUnknown = 2;
    std::vector<char> turned(pieces.triangles.size(), kUnknown);
    for (std::uint32_t seed = 0; seed < turned.size(); ++seed) {
        if (turned[seed] != kUnknown) continue;
        std::vector<std::uint32_t> part{seed};
        turned[seed] = 0;
        bool orientable = true;
        std::array<double, 2> areas{};
        for (std::size_t k = 0; k < part.size(); ++k) {
            const std::uint32_t t = part[k];
            areas[turned[t] != 0 ? 1 : 0] += area(t);
            for (std::size_t i = 0; i < 3; ++i) {
                const std::uint32_t from = pieces.triangles[t].v[i];
                const auto& corners = around[piece_edge(from, pieces.triangles[t].v[(i + 1) % 3])];
                if (corners.size() != 2) continue;
                const std::uint32_t corner = corners[0] / 3 == t ? corners[1] : corners[0], other = corner / 3;
                const bool same_direction = pieces.triangles[other].v[corner % 3] == from;
                const char wanted = static_cast<char>(same_direction ? 1 - turned[t] : turned[t]);
                if (turned[other] == kUnknown) {
                    turned[other] = wanted;
                    part.push_back(other);
                } else {
                    orientable = orientable && turned[other] == wanted;
                }
            }
        }
        const char turn = areas[1] <= areas[0] ? 1 : 0;
        for (const std::uint32_t t : part) turned[t] = orientable && turned[t] == turn ? 1 : 0;
    }
    std::vector<char> facet_turned(stated.facet_changed.size(), 0);
    for (std::uint32_t t = 0; t < turned.size(); ++t) {
        if (!turned[t]) continue;
        std::swap(pieces.triangles[t].v[1], pieces.triangles[t].v[2]);
        facet_turned[pieces.sources[pieces.triangles[t].source].facet] = 1;
    }
    for (std::size_t f = 0; f < facet_turned.size(); ++f)
        if (facet_turned[f]) {
            ++pieces.actions.facets_turned;
            stated.facet_changed[f] = 1;
        }
}

}  // namespace wellmesh
