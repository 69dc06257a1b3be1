// SPDX-License-Identifier: Apache-2.0
#include "validation/facet_planarity.hpp"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include <fmt/format.h>

#include "core/vec3_math.hpp"
#include "validation/find_duplicates.hpp"
#include "validation/plane.hpp"
#include "validation/triangulate_facet.hpp"

namespace wellmesh {
namespace {

using LocalEdge = std::array<std::uint32_t, 2>;

/// A facet with its own small numbering.
struct LocalFacet {
    std::vector<VertexId> ids;  // ascending
    std::vector<Vec3> points;
    std::vector<LocalEdge> edges;
    FacetTriangulation triangulation;
};

class SoupMaker {
public:
    SoupMaker(CleanInput& input, const Plc& plc, const Rounding& rounding, Report& report)
        : input_(input), plc_(plc), rounding_(rounding), report_(report), locals_(input.facets.size()) {}

    Soup run() {
        std::vector<std::uint32_t> todo;
        for (std::uint32_t f = 0; f < input_.facets.size(); ++f)
            if (is_polygonal(f)) todo.push_back(f);
        // a split found in one facet concerns all facets with that edge; every round needs a new split, so this ends
        while (!todo.empty()) {
            EdgeChains chains(input_.points);
            for (const std::uint32_t f : todo) triangulate(f, chains);
            todo = expand(chains);
        }
        for (std::uint32_t f = 0; f < input_.facets.size(); ++f) emit(f);
        emit_wires();
        return std::move(soup_);
    }

private:
    [[nodiscard]] bool is_polygonal(std::uint32_t f) const {
        const CleanFacet& facet = input_.facets[f];
        return facet.polygons.size() != 1 || facet.polygons[0].size() != 3 || !plc_.facets[facet.source].holes.empty();
    }
    /// May its boundary edges vanish between it and a coplanar neighbour?
    [[nodiscard]] bool may_merge(const CleanFacet& facet) const {
        return plc_.merge_coplanar == MergeRule::all || (plc_.merge_coplanar == MergeRule::triangles && facet.single_triangle);
    }
    void triangulate(std::uint32_t f, EdgeChains& chains);
    std::vector<std::uint32_t> expand(const EdgeChains& chains);
    void emit(std::uint32_t f);
    void emit_polygonal(std::uint32_t f);
    void report_findings(std::uint32_t f, const LocalFacet& local);
    void check_planar(const CleanFacet& facet, const LocalFacet& local, const FittedPlane& plane);
    void emit_wires();

    CleanInput& input_;
    const Plc& plc_;
    const Rounding& rounding_;
    Report& report_;
    std::vector<LocalFacet> locals_;
    Soup soup_;
};

/// Twice the area vector of the largest polygon: the facet's own idea of its front.
Vec3 area_vector(const CleanFacet& facet, const std::vector<Vec3>& points) {
    Vec3 largest{};
    for (const auto& polygon : facet.polygons) {
        Vec3 sum{};
        const Vec3& o = points[polygon[0].index()];
        for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
            sum = sum + cross(points[polygon[i].index()] - o, points[polygon[i + 1].index()] - o);
        if (squared_norm(sum) > squared_norm(largest)) largest = sum;
    }
    return largest;
}

void SoupMaker::triangulate(std::uint32_t f, EdgeChains& chains) {
    const CleanFacet& facet = input_.facets[f];
    LocalFacet local;
    for (const auto& polygon : facet.polygons) local.ids.insert(local.ids.end(), polygon.begin(), polygon.end());
    std::sort(local.ids.begin(), local.ids.end());
    local.ids.erase(std::unique(local.ids.begin(), local.ids.end()), local.ids.end());
    for (const VertexId v : local.ids) local.points.push_back(input_.points[v.index()]);
    const auto number = [&](VertexId v) {
        return static_cast<std::uint32_t>(std::lower_bound(local.ids.begin(), local.ids.end(), v) - local.ids.begin());
    };
    for (const auto& polygon : facet.polygons)
        for (std::size_t i = 0; i < polygon.size() && polygon.size() > 1; ++i)
            local.edges.push_back({number(polygon[i]), number(polygon[(i + 1) % polygon.size()])});
    FittedPlane plane = fit_plane(local.points);
    if (dot(plane.normal, area_vector(facet, input_.points)) < 0) plane.flip();
    local.triangulation =
        triangulate_facet(local.points, PlaneProjection(plane.normal), local.edges, plc_.facets[facet.source].holes, rounding_.on_edge());
    for (const auto& split : local.triangulation.splits)
        chains.split(local.ids[split.edge[0]], local.ids[split.edge[1]], local.ids[split.inside]);
    locals_[f] = std::move(local);
}

std::vector<std::uint32_t> SoupMaker::expand(const EdgeChains& chains) {
    std::vector<std::uint32_t> changed;
    if (chains.empty()) return changed;
    for (std::uint32_t f = 0; f < input_.facets.size(); ++f) {
        bool any = false;
        for (auto& polygon : input_.facets[f].polygons) any |= chains.expand(polygon);
        if (any) changed.push_back(f);
    }
    std::vector<std::array<VertexId, 2>> wires;
    std::vector<std::int32_t> markers;
    for (std::size_t w = 0; w < input_.wires.size(); ++w) {
        std::vector<VertexId> chain{input_.wires[w][0]};
        chains.append_between(input_.wires[w][0], input_.wires[w][1], chain);
        chain.push_back(input_.wires[w][1]);
        for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
            wires.push_back({chain[i], chain[i + 1]});
            markers.push_back(input_.wire_markers[w]);
        }
    }
    input_.wires = std::move(wires);
    input_.wire_markers = std::move(markers);
    return changed;
}

void SoupMaker::check_planar(const CleanFacet& facet, const LocalFacet& local, const FittedPlane& plane) {
    if (plane.residual <= rounding_.accepting()) return;
    const VertexId worst = local.ids[plane.worst];
    report_.add(DefectKind::non_planar_facet, Severity::error,
                {report_.facet(facet.source, input_.points[worst.index()]), report_.vertex(input_.source_vertex[worst.index()])},
                fmt::format("{} is not planar: {} at {} is {:.3g} off its plane, rounding explains {:.3g}; split the facet, or accept it with a "
                            "coplanar tolerance of at least that distance",
                            report_.name_facet(facet.source), report_.name_vertex(input_.source_vertex[worst.index()]),
                            format_point(input_.points[worst.index()]), plane.residual, rounding_.accepting()),
                plane.residual);
}

void SoupMaker::report_findings(std::uint32_t f, const LocalFacet& local) {
    const CleanFacet& facet = input_.facets[f];
    const auto number_of = [&](std::uint32_t v) { return input_.source_vertex[local.ids[v].index()]; };
    for (const auto& [e, g] : local.triangulation.crossings) {
        const Vec3& where = local.points[e[0]];
        report_.add(DefectKind::self_intersection, Severity::error,
                    {report_.facet(facet.source, where), report_.vertex(number_of(e[0])), report_.vertex(number_of(e[1])), report_.vertex(number_of(g[0])),
                     report_.vertex(number_of(g[1]))},
                    fmt::format("{} has two edges that cross: between {} and {}, and between {} and {}", report_.name_facet(facet.source),
                                report_.name_vertex(number_of(e[0])), report_.name_vertex(number_of(e[1])), report_.name_vertex(number_of(g[0])),
                                report_.name_vertex(number_of(g[1]))));
    }
    for (const auto& [v, w] : local.triangulation.coincident)
        report_.add(DefectKind::feature_too_thin, Severity::error,
                    {report_.facet(facet.source, local.points[v]), report_.vertex(number_of(v)), report_.vertex(number_of(w))},
                    fmt::format("{} has two vertices, {} and {}, at one place of its plane", report_.name_facet(facet.source),
                                report_.name_vertex(number_of(v)), report_.name_vertex(number_of(w))),
                    distance(local.points[v], local.points[w]));
    for (const std::size_t h : local.triangulation.idle_holes) {
        const Vec3& where = plc_.facets[facet.source].holes[h];
        report_.add(DefectKind::seed_outside, Severity::warning, {report_.facet(facet.source, where)},
                    fmt::format("hole point {} of {} at {} lies outside the facet and has no effect", h + plc_.first_number,
                                report_.name_facet(facet.source), format_point(where)));
    }
}

void SoupMaker::emit_polygonal(std::uint32_t f) {
    const LocalFacet& local = locals_[f];
    const CleanFacet& facet = input_.facets[f];
    check_planar(facet, local, fit_plane(local.points));
    report_findings(f, local);
    if (local.triangulation.triangles.empty()) {
        report_.add(DefectKind::degenerate_facet, Severity::warning, {report_.facet(facet.source, local.points[0])},
                    fmt::format("{} encloses no area", report_.name_facet(facet.source)));
    }
    std::unordered_map<EdgeKey, int> covered;
    std::vector<char> used(local.ids.size(), 0);
    for (const auto& t : local.triangulation.triangles) {
        soup_.triangles.push_back({{local.ids[t[0]], local.ids[t[1]], local.ids[t[2]]}, f});
        for (std::size_t i = 0; i < 3; ++i) {
            ++covered[edge_key(local.ids[t[i]], local.ids[t[(i + 1) % 3]])];
            used[t[i]] = 1;
        }
    }
    for (const LocalEdge& e : local.triangulation.constraints) {
        const EdgeKey key = edge_key(local.ids[e[0]], local.ids[e[1]]);
        const auto sides = covered.find(key);
        if (sides == covered.end() || sides->second == 2 || !may_merge(facet)) soup_.hard_edges.try_emplace(key, 0);
        used[e[0]] = used[e[1]] = 1;
        if (sides == covered.end()) {  // outside what the facet encloses, or in a hole: a segment all the same
            input_.wires.push_back({local.ids[e[0]], local.ids[e[1]]});
            input_.wire_markers.push_back(0);
        }
    }
    for (std::size_t v = 0; v < used.size(); ++v)
        if (!used[v]) input_.lone_vertices.push_back(local.ids[v]);
}

void SoupMaker::emit(std::uint32_t f) {
    if (is_polygonal(f)) {
        emit_polygonal(f);
        return;
    }
    const CleanFacet& facet = input_.facets[f];
    const auto& p = facet.polygons[0];
    soup_.triangles.push_back({{p[0], p[1], p[2]}, f});
    if (!may_merge(facet))
        for (std::size_t i = 0; i < 3; ++i) soup_.hard_edges.try_emplace(edge_key(p[i], p[(i + 1) % 3]), 0);
}

void SoupMaker::emit_wires() {
    std::unordered_set<EdgeKey> of_triangles, seen;
    for (const SoupTriangle& t : soup_.triangles)
        for (std::size_t i = 0; i < 3; ++i) of_triangles.insert(edge_key(t.v[i], t.v[(i + 1) % 3]));
    for (std::size_t w = 0; w < input_.wires.size(); ++w) {
        const EdgeKey key = edge_key(input_.wires[w][0], input_.wires[w][1]);
        std::int32_t& marker = soup_.hard_edges.try_emplace(key, 0).first->second;
        if (marker == 0) marker = input_.wire_markers[w];
        if (!of_triangles.contains(key) && seen.insert(key).second) soup_.wires.push_back(input_.wires[w]);
    }
}

}  // namespace

Soup make_soup(CleanInput& input, const Plc& plc, const Rounding& rounding, Report& report) { return SoupMaker(input, plc, rounding, report).run(); }

}  // namespace wellmesh
