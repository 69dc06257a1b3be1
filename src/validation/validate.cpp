// SPDX-License-Identifier: Apache-2.0
// Stage validate: runs the checks in order and, when none found an error, hands out the complex. Each check goes on as far as it can
// after errors, so that one run lists everything; what would only follow from earlier errors (cells of a complex that intersects
// itself) is not asked.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/check.hpp"
#include "core/vec3_math.hpp"
#include "predicates/exact_range.hpp"
#include "validation/examine.hpp"
#include "validation/facet_planarity.hpp"
#include "validation/fill_cells.hpp"
#include "validation/find_duplicates.hpp"
#include "validation/find_intersections.hpp"
#include "validation/merge_coplanar.hpp"
#include "validation/sharp_features.hpp"
#include "validation/triangulate_facet.hpp"
#include "validation/valid_plc.hpp"

namespace wellmesh {

/// The only maker of ValidPlc.
struct ValidPlcBuilder {
    ValidPlcBuilder(const Plc& stated, const MeshOptions& options, const Checkpoint& stop = {}, const SourceNumbers* source = nullptr)
        : plc(stated), checkpoint(stop), report(stated, source) {
        rounding.relative = std::max(0.0, stated.relative_rounding);
        rounding.override_with = options.coplanar_tolerance;
    }

    void run();
    void find_segments();
    void find_facets();
    void set_triangles(std::uint32_t group, ValidFacet& facet);
    void find_open_edges(Severity severity);
    void attach_cells(const CellMap& map);
    void drop_outside(const LineQuery& lines, const CellMap& map);
    void keep_isolated_vertices(const LineQuery& lines, const CellMap& map);
    void compress_vertices();
    void keep_vertex_markers(const std::vector<VertexId>& number);
    void summarise();
    void examine_further();

    const Plc& plc;
    const Checkpoint checkpoint;
    Report report;
    Rounding rounding;
    CleanInput input;
    Soup soup;
    EdgeTable edges;
    FacetGroups groups;
    std::vector<std::uint32_t> segment_of_edge;
    std::optional<double> near;  ///< distance of near misses, where a full examination is asked for
    ValidPlc out;
};

void ValidPlcBuilder::run() {
    if (plc.vertices.empty() || (plc.facets.empty() && plc.segments.empty())) {
        report.add(DefectKind::empty_input, Severity::error, {}, plc.vertices.empty() ? "the input has no vertices" : "the input has no facets");
        return;
    }
    for (const Vec3& p : plc.vertices)
        if (in_exact_range(p)) rounding.largest_coordinate = std::max({rounding.largest_coordinate, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    pass(checkpoint);
    input = clean_input(plc, rounding, report);
    pass(checkpoint);
    soup = make_soup(input, plc, rounding, report);
    edges = make_edge_table(soup.triangles);
    pass(checkpoint);
    find_intersections(input, soup, edges, report, checkpoint);
    groups = merge_coplanar(input, soup, edges, plc, rounding);
    pass(checkpoint);
    find_thin_features(input, soup, edges, groups, rounding, report);
    pass(checkpoint);
    if (plc.fill == FillRule::nonzero_winding) find_open_edges(Severity::error);
    find_segments();
    find_facets();
    if (near) examine_further();
    if (report.has_errors()) return;
    pass(checkpoint);
    const LineQuery lines(input.points, soup.triangles);
    const CellMap map = find_cells(input.points, soup.triangles, edges, lines);
    pass(checkpoint);
    out.cells = fill_cells(input, soup, map, lines, rounding, report);
    if (out.cells.size() == 1) find_open_edges(Severity::warning);  // it encloses nothing: where is it open?
    attach_cells(map);
    if (!report.has_errors()) drop_outside(lines, map);
    keep_isolated_vertices(lines, map);
    compress_vertices();
    pass(checkpoint);
    out.acute_features = find_sharp_features(out, rounding, report);
}

void ValidPlcBuilder::find_segments() {
    constexpr auto kNone = static_cast<std::uint32_t>(-1);
    segment_of_edge.assign(edges.keys.size(), kNone);
    const auto add = [&](EdgeKey key) {
        ValidSegment segment;
        segment.ends = edge_ends(key);
        if (const auto hard = soup.hard_edges.find(key); hard != soup.hard_edges.end()) segment.marker = hard->second;
        out.segments.push_back(std::move(segment));
    };
    for (std::size_t e = 0; e < edges.keys.size(); ++e) {
        if (!groups.is_segment[e]) continue;
        segment_of_edge[e] = static_cast<std::uint32_t>(out.segments.size());
        add(edges.keys[e]);
        auto& facets = out.segments.back().facets;
        for (const std::uint32_t corner : edges.around(e)) facets.emplace_back(groups.group_of[corner / 3]);
        std::sort(facets.begin(), facets.end());
        facets.erase(std::unique(facets.begin(), facets.end()), facets.end());
    }
    for (const auto& wire : soup.wires) add(edge_key(wire[0], wire[1]));
}

void ValidPlcBuilder::find_facets() {
    for (std::uint32_t g = 0; g < groups.planes.size(); ++g) {
        ValidFacet facet;
        const FittedPlane& plane = groups.planes[g];
        facet.origin = plane.origin;
        facet.normal = plane.normal;
        facet.axis_u = plane.axis_u;
        facet.axis_v = plane.axis_v;
        // vertices are as good as their last bit, however well a plane fits them
        facet.tolerance = std::max(plane.residual, rounding.ulps(1));
        facet.vertices = groups.vertices[g];
        facet.source_facet = static_cast<std::uint32_t>(plc.facets.size());
        for (const std::uint32_t t : groups.triangles[g]) {
            facet.source_facet = std::min(facet.source_facet, input.facets[soup.triangles[t].facet].source);
            for (std::uint32_t s = 0; s < 3; ++s) {
                const std::uint32_t edge = edges.edge_of[3 * t + s];
                if (groups.is_segment[edge]) facet.segments.emplace_back(segment_of_edge[edge]);
            }
        }
        std::sort(facet.segments.begin(), facet.segments.end());
        facet.segments.erase(std::unique(facet.segments.begin(), facet.segments.end()), facet.segments.end());
        facet.marker = plc.facets[facet.source_facet].marker;
        set_triangles(g, facet);
        out.coplanar_tolerance = std::max(out.coplanar_tolerance, facet.tolerance);
        out.facets.push_back(std::move(facet));
    }
}

/// The group's triangles, turned to agree with the normal. Needles lower than the tolerance may turn the wrong way in the facet's plane;
/// then the facet gets new triangles over the same vertices and segments.
void ValidPlcBuilder::set_triangles(std::uint32_t group, ValidFacet& facet) {
    const PlaneProjection project(facet.normal);
    const auto flat = [&](VertexId v) { return project(input.points[v.index()]); };
    bool all_turn = true;
    for (const std::uint32_t t : groups.triangles[group]) {
        std::array<VertexId, 3> v = soup.triangles[t].v;
        if (groups.is_turned[t]) std::swap(v[1], v[2]);
        all_turn = all_turn && orient2d(flat(v[0]), flat(v[1]), flat(v[2])) == Sign::positive;
        facet.triangles.push_back(v);
    }
    if (all_turn) return;
    std::vector<Vec3> points;
    for (const VertexId v : facet.vertices) points.push_back(input.points[v.index()]);
    const auto number = [&](VertexId v) {
        return static_cast<std::uint32_t>(std::lower_bound(facet.vertices.begin(), facet.vertices.end(), v) - facet.vertices.begin());
    };
    std::vector<std::array<std::uint32_t, 2>> constraints;
    for (const SegmentId s : facet.segments) constraints.push_back({number(out.segments[s.index()].ends[0]), number(out.segments[s.index()].ends[1])});
    const FacetTriangulation again = triangulate_facet(points, project, constraints, {}, 0);
    if (!again.crossings.empty() || !again.coincident.empty() || !again.splits.empty() || again.constraints.size() != constraints.size() || again.triangles.empty()) {
        report.add(DefectKind::feature_too_thin, Severity::error, {report.facet(facet.source_facet, facet.origin)},
                   fmt::format("the coplanar triangles around {} near {} overlap within rounding: remove the needles among them",
                               report.name_facet(facet.source_facet), format_point(facet.origin)));
        return;
    }
    facet.triangles.clear();
    for (const auto& t : again.triangles) facet.triangles.push_back({facet.vertices[t[0]], facet.vertices[t[1]], facet.vertices[t[2]]});
}

void ValidPlcBuilder::attach_cells(const CellMap& map) {
    for (std::uint32_t g = 0; g < groups.planes.size(); ++g) {
        const std::uint32_t t = groups.triangles[g].front();
        const std::uint32_t turned = groups.is_turned[t] ? 1 : 0;
        out.facets[g].cells = {CellId{map.cell_of_side[2 * t + turned]}, CellId{map.cell_of_side[2 * t + 1 - turned]}};
    }
}

/// What touches no filled cell can't be part of a mesh of the domain: fins on the outside, sheets and segments in holes or elsewhere.
void ValidPlcBuilder::drop_outside(const LineQuery& lines, const CellMap& map) {
    std::vector<ElementRef> facets_dropped, segments_dropped;
    std::vector<FacetId> number(out.facets.size());
    std::vector<ValidFacet> kept;
    kept.reserve(out.facets.size());
    for (std::size_t f = 0; f < out.facets.size(); ++f) {
        ValidFacet& facet = out.facets[f];
        if (std::any_of(facet.cells.begin(), facet.cells.end(), [&](CellId c) { return out.cells[c.index()].filled; })) {
            number[f] = FacetId{kept.size()};
            kept.push_back(std::move(facet));
        } else {
            facets_dropped.push_back(report.facet(facet.source_facet, input.points[facet.triangles.front()[0].index()]));
        }
    }
    out.facets = std::move(kept);
    std::vector<SegmentId> segment_number(out.segments.size());
    std::vector<ValidSegment> segments;
    segments.reserve(out.segments.size());
    for (std::size_t s = 0; s < out.segments.size(); ++s) {
        ValidSegment& segment = out.segments[s];
        const bool had_facets = !segment.facets.empty();
        for (FacetId& f : segment.facets) f = number[f.index()];
        std::erase_if(segment.facets, [](FacetId f) { return !f.valid(); });
        bool keep = !segment.facets.empty();
        const Vec3 &a = input.points[segment.ends[0].index()], &b = input.points[segment.ends[1].index()], middle = a + 0.5 * (b - a);
        if (!keep && !had_facets) {  // a segment of its own crosses no facet, so its middle tells
            const auto place = lines.locate(middle);
            keep = place.on || (place.sees && out.cells[map.cell_of_side[*place.sees]].filled);
            if (!keep) segments_dropped.push_back(report.vertex(input.source_vertex[segment.ends[0].index()]));
        }
        if (!keep) continue;
        segment_number[s] = SegmentId{segments.size()};
        segments.push_back(std::move(segment));
    }
    out.segments = std::move(segments);
    for (ValidFacet& f : out.facets)
        for (SegmentId& s : f.segments) s = segment_number[s.index()];
    const auto tell = [&](std::vector<ElementRef>&& dropped, const char* what) {
        if (dropped.empty()) return;
        const auto n = static_cast<double>(dropped.size());
        const std::string place = dropped.front().where ? format_point(*dropped.front().where) : std::string("?");
        report.add(DefectKind::outside_domain, Severity::warning, std::move(dropped),
                   fmt::format("{} {} of the input, the first at {}, touch no filled cell and were dropped: they can't be part of a mesh of the domain", n, what, place), n);
    };
    tell(std::move(facets_dropped), "facets");
    tell(std::move(segments_dropped), "segments");
}

/// A surface file must be closed: an edge with one triangle is a hole in it. Facets of a .poly may dangle.
void ValidPlcBuilder::find_open_edges(Severity severity) {
    if (severity != Severity::error && report.count(DefectKind::open_edge, Severity::error) > 0) return;  // listed already
    for (std::size_t e = 0; e < edges.keys.size(); ++e) {
        if (edges.around(e).size() != 1) continue;
        const auto ends = edge_ends(edges.keys[e]);
        const std::uint32_t a = input.source_vertex[ends[0].index()], b = input.source_vertex[ends[1].index()];
        const std::uint32_t facet = input.facets[soup.triangles[edges.around(e)[0] / 3].facet].source;
        report.add(DefectKind::open_edge, severity, {report.vertex(a), report.vertex(b), report.facet(facet)},
                   fmt::format("the edge from {} at {} to {} at {} bounds only {}: the surface is not closed", report.name_vertex(a),
                               format_point(input.points[ends[0].index()]), report.name_vertex(b), format_point(input.points[ends[1].index()]),
                               report.name_facet(facet)));
    }
}

/// Vertices that neither a facet nor a segment uses: volume points of a .poly, leftovers of a surface file.
void ValidPlcBuilder::keep_isolated_vertices(const LineQuery& lines, const CellMap& map) {
    std::vector<char> used(input.points.size(), 0), stated(input.points.size(), 0);
    for (const ValidFacet& f : out.facets)
        for (const VertexId v : f.vertices) used[v.index()] = 1;
    for (const ValidSegment& s : out.segments) used[s.ends[0].index()] = used[s.ends[1].index()] = 1;
    for (const VertexId v : input.lone_vertices) stated[v.index()] = 1;
    std::vector<ElementRef> dropped;
    for (std::size_t v = 0; v < input.points.size(); ++v) {
        if (used[v]) continue;
        bool keep = plc.fill == FillRule::bounded_cells || stated[v];
        if (keep) {
            const auto place = lines.locate(input.points[v]);
            keep = place.sees && out.cells[map.cell_of_side[*place.sees]].filled;
        }
        if (keep)
            out.isolated_vertices.emplace_back(v);
        else
            dropped.push_back(report.vertex(input.source_vertex[v]));
    }
    if (!dropped.empty()) {
        const std::size_t n = dropped.size();
        report.add(DefectKind::isolated_vertex, Severity::note, std::move(dropped),
                   fmt::format("{} vertices that no facet uses were dropped{}", n, plc.fill == FillRule::bounded_cells ? ": they lie outside of the filled cells" : ""),
                   static_cast<double>(n));
    }
}

void ValidPlcBuilder::compress_vertices() {
    std::vector<VertexId> number(input.points.size());
    std::vector<char> used(input.points.size(), 0);
    const auto use = [&](VertexId v) { used[v.index()] = 1; };
    for (const ValidFacet& f : out.facets) std::for_each(f.vertices.begin(), f.vertices.end(), use);
    for (const ValidSegment& s : out.segments) std::for_each(s.ends.begin(), s.ends.end(), use);
    std::for_each(out.isolated_vertices.begin(), out.isolated_vertices.end(), use);
    for (std::size_t v = 0; v < used.size(); ++v) {
        if (!used[v]) continue;
        number[v] = VertexId{out.vertices.size()};
        out.vertices.push_back(input.points[v]);
        out.source_vertex.push_back(input.source_vertex[v]);
        if (plc.vertex_sizes.size() == plc.vertices.size()) out.vertex_sizes.push_back(plc.vertex_sizes[input.source_vertex[v]]);
    }
    keep_vertex_markers(number);
    const auto renumber = [&](VertexId& v) { v = number[v.index()]; };  // keeps the order, so sorted lists stay sorted
    for (ValidFacet& f : out.facets) {
        std::for_each(f.vertices.begin(), f.vertices.end(), renumber);
        for (auto& t : f.triangles) std::for_each(t.begin(), t.end(), renumber);
    }
    for (ValidSegment& s : out.segments) std::for_each(s.ends.begin(), s.ends.end(), renumber);
    std::for_each(out.isolated_vertices.begin(), out.isolated_vertices.end(), renumber);
}

/// Of vertices at one place the first that has a marker gives it.
void ValidPlcBuilder::keep_vertex_markers(const std::vector<VertexId>& number) {
    if (plc.vertex_markers.size() != plc.vertices.size()) return;
    out.vertex_markers.assign(out.vertices.size(), 0);
    for (std::size_t v = 0; v < plc.vertices.size(); ++v) {
        const VertexId clean = input.of_input[v];
        if (!clean.valid() || !number[clean.index()].valid()) continue;
        std::int32_t& marker = out.vertex_markers[number[clean.index()].index()];
        if (marker == 0) marker = plc.vertex_markers[v];
    }
}

void ValidPlcBuilder::summarise() {
    Diagnosis& d = out.diagnosis;
    d.defects = report.take();
    for (const ValidCell& c : out.cells) {
        d.cells.push_back({c.region, c.volume, c.inside, c.filled});
        if (const std::string* name = c.filled ? plc.names.find(3, c.region) : nullptr) d.cells.back().name = *name;
    }
    d.vertices = out.vertices.empty() ? input.points.size() : out.vertices.size();
    d.segments = out.segments.size();
    d.facets = out.facets.size();
    d.coplanar_tolerance = out.coplanar_tolerance;
}

ValidPlc validate(const Plc& plc, const MeshOptions& options, const Checkpoint& checkpoint, const SourceNumbers* source) {
    ValidPlcBuilder builder(plc, options, checkpoint, source);
    builder.run();
    builder.summarise();
    throw_if_invalid(builder.out.diagnosis, plc.source_name);
    return std::move(builder.out);
}

/// What a valid complex may have, and what is told about an invalid one all the same.
void ValidPlcBuilder::examine_further() {
    const Complexes complex{input, soup, edges, groups};
    if (report.has_errors()) {
        find_seeds_beyond(complex, report);
        find_acute_angles(complex, rounding, report);
    }
    find_surface_defects(complex, report);
    out.diagnosis.smallest = find_smallest_features(complex);
    find_near_misses(complex, *near, report);
}

Diagnosis examine(const Plc& plc, const ExamineOptions& options) {
    constexpr double kNear = 1e-4;  // elements there would be ten thousand times smaller than the model: worth a look
    if (options.near && !(*options.near >= 0 && std::isfinite(*options.near)))
        throw MeshError(ErrorCode::bad_options, Stage::validate, fmt::format("the distance of near misses must be 0 or more, not {}", *options.near));
    MeshOptions meshing;
    meshing.coplanar_tolerance = options.coplanar_tolerance;
    ValidPlcBuilder builder(plc, meshing);
    Box box;
    for (const Vec3& p : plc.vertices)
        if (in_exact_range(p)) box.add(p);
    builder.near = options.near.value_or(box.empty() ? 0 : kNear * distance(box.low, box.high));
    builder.run();
    builder.summarise();
    return std::move(builder.out.diagnosis);
}

Diagnosis diagnose(const Plc& plc, const MeshOptions& options) {
    ValidPlcBuilder builder(plc, options);
    builder.run();
    builder.summarise();
    return std::move(builder.out.diagnosis);
}

}  // namespace wellmesh
