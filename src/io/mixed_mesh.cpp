// SPDX-License-Identifier: Apache-2.0
#include "io/mixed_mesh.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "io/number_parsing.hpp"
#include "io/plc_building.hpp"

namespace wellmesh::io {
namespace {

constexpr std::array<std::string_view, 4> kMarkerPrefix{"vertex_marker_", "segment_marker_", "facet_marker_", "region_"};
constexpr std::array<std::string_view, 4> kEntityPrefix{"vertex_", "segment_", "facet_", "cell_"};

/// The number in "PREFIXnumber" as this program writes it: no sign +, no leading zeros.
std::optional<std::int32_t> number_after(std::string_view prefix, std::string_view name) {
    if (!name.starts_with(prefix)) return std::nullopt;
    const auto number = parse_integer(name.substr(prefix.size()));
    using Limits = std::numeric_limits<std::int32_t>;
    if (!number || *number < Limits::min() || *number > Limits::max() || fmt::format("{}{}", prefix, *number) != name) return std::nullopt;
    return static_cast<std::int32_t>(*number);
}

template <class Corners>
void rename(CellList<Corners>& cells, const std::map<std::int32_t, std::int32_t>& marker, const std::map<std::int32_t, std::int32_t>& entity) {
    for (std::size_t i = 0; i < cells.corners.size(); ++i) {
        std::int32_t& m = cells.markers[i];
        if (const auto is = entity.find(m); is != entity.end()) {
            cells.entities[i] = is->second;
            m = 0;
        } else if (const auto to = marker.find(m); to != marker.end()) {
            m = to->second;
        }
    }
}

/// Without markers the file's own parts are told apart.
template <class Corners>
void mark_by_entity(CellList<Corners>& cells, bool marked) {
    if (!marked) cells.markers = cells.entities;
}

bool any_marked(const std::vector<std::int32_t>& markers) {
    return std::any_of(markers.begin(), markers.end(), [](std::int32_t m) { return m != 0; });
}

/// Markers of the vertices that have one; empty if none has.
std::vector<std::int32_t> vertex_markers(const MixedMesh& mesh) {
    std::vector<std::int32_t> markers;
    const auto& stated = mesh.vertices.markers;
    if (!any_marked(stated)) return markers;
    markers.assign(mesh.points.size(), 0);
    for (std::size_t i = 0; i < stated.size(); ++i) {
        std::int32_t& marker = markers[mesh.vertices.corners[i][0]];
        if (marker == 0) marker = stated[i];  // of several the first
    }
    return markers;
}

}  // namespace

std::string generated_name(std::size_t dimension, std::int32_t marker) { return fmt::format("{}{}", kMarkerPrefix[dimension], marker); }

std::string generated_entity_name(std::size_t dimension, std::int32_t entity) { return fmt::format("{}{}", kEntityPrefix[dimension], entity); }

void resolve_generated_names(MixedMesh& mesh) {
    for (std::size_t dimension = 0; dimension < 4; ++dimension) {
        std::map<std::int32_t, std::int32_t> marker, entity;  // what a marker of the file stands for
        auto& names = mesh.names.of_dimension[dimension];
        for (auto at = names.begin(); at != names.end();) {
            const auto is_marker = number_after(kMarkerPrefix[dimension], at->second);
            const auto is_entity = is_marker ? std::nullopt : number_after(kEntityPrefix[dimension], at->second);
            if (is_marker) marker[at->first] = *is_marker;
            if (is_entity) entity[at->first] = *is_entity;
            at = is_marker || is_entity ? names.erase(at) : std::next(at);
        }
        // A file that names some of its groups itself has numbers of its own, which those of the generated names must not meet.
        const bool clash =
            std::any_of(marker.begin(), marker.end(), [&](const auto& m) { return names.contains(m.second) && !marker.contains(m.second); });
        if (clash || (marker.empty() && entity.empty())) continue;
        if (dimension == 0) rename(mesh.vertices, marker, entity);
        if (dimension == 1) rename(mesh.lines, marker, entity);
        if (dimension == 2) rename(mesh.triangles, marker, entity), rename(mesh.polygons, marker, entity);
        if (dimension == 3) rename(mesh.tets, marker, entity);
    }
}

bool resolve_generated_names(Plc& plc) {
    bool any = false;
    for (std::size_t dimension = 1; dimension <= 2; ++dimension) {
        std::map<std::int32_t, std::int32_t> marker;
        auto& names = plc.names.of_dimension[dimension];
        for (const auto& [key, name] : names)
            if (const auto number = number_after(kMarkerPrefix[dimension], name)) marker[key] = *number;
        if (marker.empty() ||
            std::any_of(marker.begin(), marker.end(), [&](const auto& m) { return names.contains(m.second) && !marker.contains(m.second); }))
            continue;
        any = true;
        for (const auto& [key, number] : marker) names.erase(key);
        const auto rename_all = [&](auto& cells) {
            for (auto& cell : cells)
                if (const auto to = marker.find(cell.marker); to != marker.end()) cell.marker = to->second;
        };
        if (dimension == 1) rename_all(plc.segments);
        else rename_all(plc.facets);
    }
    return any;
}

TetMesh to_tet_mesh(MixedMesh mesh, const SourceFile& source) {
    if (mesh.tets.corners.empty()) fail_in_file(source, "the file has no tetrahedra");
    if (!mesh.polygons.corners.empty())
        fail_in_file(source, fmt::format("the file has {} faces of more than three corners; a tetrahedral mesh has triangles alone",
                                         mesh.polygons.corners.size()));
    TetMesh out;
    out.vertex_markers = vertex_markers(mesh);
    out.vertices = std::move(mesh.points);
    out.relative_rounding = mesh.relative_rounding;
    // Without groups the file's own parts tell the materials apart.
    const bool marked = any_marked(mesh.tets.markers);
    out.tets = std::move(mesh.tets.corners);
    out.tet_regions = marked ? std::move(mesh.tets.markers) : std::move(mesh.tets.entities);
    out.subfaces = std::move(mesh.triangles.corners);
    out.subface_markers = std::move(mesh.triangles.markers);
    out.subface_facets = std::move(mesh.triangles.entities);
    out.subsegments = std::move(mesh.lines.corners);
    out.subsegment_markers = std::move(mesh.lines.markers);
    out.subsegment_segments = std::move(mesh.lines.entities);
    if (const auto weights = mesh.fields.find("weight"); weights != mesh.fields.end()) {
        const auto& w = weights->second;
        if (std::none_of(w.begin(), w.end(), [](double x) { return x != x; })) out.weights = w;
    }
    out.names = std::move(mesh.names);
    return out;
}

bool is_oriented_closed_surface(const std::vector<PlcFacet>& facets) {
    std::vector<std::array<std::uint32_t, 2>> edges;
    for (const PlcFacet& facet : facets)
        for (const auto& polygon : facet.polygons)
            for (std::size_t i = 0; i < polygon.size(); ++i) edges.push_back({polygon[i], polygon[(i + 1) % polygon.size()]});
    std::sort(edges.begin(), edges.end());
    for (std::size_t i = 0; i < edges.size(); ++i) {
        if (i > 0 && edges[i] == edges[i - 1]) return false;
        if (!std::binary_search(edges.begin(), edges.end(), std::array{edges[i][1], edges[i][0]})) return false;
    }
    return true;
}

Plc to_plc(MixedMesh mesh, const SourceFile& source) {
    if (mesh.triangles.corners.empty() && mesh.polygons.corners.empty())
        fail_in_file(source, "the file has neither triangles nor other faces: it holds no surface");
    const bool marked = any_marked(mesh.triangles.markers) || any_marked(mesh.polygons.markers);
    mark_by_entity(mesh.triangles, marked);
    mark_by_entity(mesh.polygons, marked);
    mark_by_entity(mesh.lines, any_marked(mesh.lines.markers));
    Plc plc = make_surface(source);
    plc.vertex_markers = vertex_markers(mesh);
    plc.vertices = std::move(mesh.points);
    normalise_zeros(plc.vertices);
    plc.first_number = 1;
    plc.relative_rounding = mesh.relative_rounding;
    plc.facets.reserve(mesh.triangles.corners.size() + mesh.polygons.corners.size());
    for (std::size_t i = 0; i < mesh.triangles.corners.size(); ++i) {
        const auto& c = mesh.triangles.corners[i];
        add_polygon(plc, {c[0], c[1], c[2]}, mesh.triangles.markers[i]);
    }
    for (std::size_t i = 0; i < mesh.polygons.corners.size(); ++i) add_polygon(plc, std::move(mesh.polygons.corners[i]), mesh.polygons.markers[i]);
    for (std::size_t i = 0; i < mesh.lines.corners.size(); ++i) plc.segments.push_back({mesh.lines.corners[i], mesh.lines.markers[i]});
    if (!is_oriented_closed_surface(plc.facets)) plc.fill = FillRule::bounded_cells;
    plc.names = std::move(mesh.names);
    plc.names.of_dimension[3].clear();  // regions come from seeds, and these formats have none
    return plc;
}

}  // namespace wellmesh::io
