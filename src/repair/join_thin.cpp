// SPDX-License-Identifier: Apache-2.0
#include "repair/join_thin.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "core/vec3_math.hpp"
#include "predicates/exact_range.hpp"
#include "repair/taper_edges.hpp"
#include "validation/closest_points.hpp"

namespace wellmesh {
namespace {

using Vertex = std::uint32_t;
using Polygon = std::vector<Vertex>;
using AscendingEdge = std::pair<Vertex, Vertex>;

AscendingEdge edge(Vertex a, Vertex b) { return {std::min(a, b), std::max(a, b)}; }

/// Facets and edges that are to be led through vertices.
class Leader {
public:
    explicit Leader(JoinedPlc& joined) : joined_(joined), plc_(joined.plc) {}

    /// False if the vertex is near another one rather than the facet or an edge of it: no facet can be led through both.
    bool note(Vertex v, std::uint32_t f, double gap) {
        const double most = joined_.statistics.tolerance;
        double nearest = most;
        AscendingEdge through{};
        for (const Polygon& p : plc_.facets[f].polygons)
            for (std::size_t i = 0; i < p.size(); ++i) {
                const Vertex a = p[i], b = p[(i + 1) % p.size()];
                if (a == b || a == v || b == v) continue;
                const double d = distance_to_segment(point(v), point(a), point(b));
                if (d > nearest) continue;
                nearest = d;
                through = edge(a, b);
            }
        const bool by_edge = through.first != through.second;
        if (by_edge) {
            const Vec3 &a = point(through.first), &b = point(through.second);
            const double length = distance(a, b), at = dot(point(v) - a, b - a) / length;
            if (at <= most || at >= length - most) return near_corner(v, at < length / 2 ? through.first : through.second);
            auto& stops = on_edge_[through];
            if (std::any_of(stops.begin(), stops.end(), [&](const auto& s) { return s.second == v; })) return true;
            stops.emplace_back(at, v);
        } else {
            nearest = gap;
            auto& inside = inside_[f];
            if (std::find(inside.begin(), inside.end(), v) != inside.end()) return true;
            inside.push_back(v);
        }
        const ElementRef with{EntityKind::facet, std::uint64_t{joined_.source.facet[f]} + plc_.first_number, point(v)};
        joined_.statistics.joined.push_back({{EntityKind::vertex, std::uint64_t{joined_.source.vertex[v]} + plc_.first_number, point(v)}, with, nearest});
        joined_.statistics.largest_move = std::max(joined_.statistics.largest_move, nearest);
        return true;
    }

    void lead() {
        for (auto& [e, stops] : on_edge_) std::sort(stops.begin(), stops.end());
        const auto facets = static_cast<std::uint32_t>(plc_.facets.size());
        for (std::uint32_t f = 0; f < facets; ++f) lead_facet(f);
        std::vector<PlcSegment> pieces;
        for (const PlcSegment& s : plc_.segments) {
            Polygon stops;
            append(s.vertices[0], s.vertices[1], stops);
            stops.push_back(s.vertices[1]);
            for (std::size_t i = 0; i + 1 < stops.size(); ++i) pieces.push_back({{stops[i], stops[i + 1]}, s.marker});
        }
        plc_.segments = std::move(pieces);
    }

private:
    [[nodiscard]] const Vec3& point(Vertex v) const { return plc_.vertices[v]; }

    /// With an edge in between, taper_short_edges() does it.
    [[nodiscard]] bool near_corner(Vertex v, Vertex corner) const {
        for (const PlcFacet& f : plc_.facets)
            for (const Polygon& p : f.polygons)
                for (std::size_t i = 0; i < p.size(); ++i)
                    if (edge(p[i], p[(i + 1) % p.size()]) == edge(v, corner)) return true;
        return false;
    }

    /// All vertices from a to b, but for b.
    void append(Vertex a, Vertex b, Polygon& out) const {
        out.push_back(a);
        const auto found = on_edge_.find(edge(a, b));
        if (found == on_edge_.end()) return;
        const std::size_t at = out.size();
        for (const auto& stop : found->second) out.push_back(stop.second);
        if (a > b) std::reverse(out.begin() + static_cast<std::ptrdiff_t>(at), out.end());
    }

    void lead_facet(std::uint32_t f) {
        const auto inside = inside_.find(f);
        std::vector<Polygon> led;
        bool changed = inside != inside_.end();
        for (const Polygon& polygon : plc_.facets[f].polygons) {
            if (polygon.size() == 1) {
                led.push_back(polygon);
                continue;
            }
            Polygon longer;
            for (std::size_t i = 0; i < polygon.size() && (polygon.size() > 2 || i == 0); ++i) append(polygon[i], polygon[(i + 1) % polygon.size()], longer);
            if (polygon.size() == 2) longer.push_back(polygon[1]);
            changed = changed || longer.size() != polygon.size();
            if (polygon.size() == 2) {
                for (std::size_t i = 0; i + 1 < longer.size(); ++i) led.push_back({longer[i], longer[i + 1]});
                continue;
            }
            if (longer.size() != polygon.size()) drop_spurs(longer);
            if (longer.size() >= 3) led.push_back(std::move(longer));
        }
        if (!changed) return;
        const auto& stated = plc_.facets[f].polygons;
        if (stated.size() == 1 && stated[0].size() == 3 && !led.empty()) {
            const Polygon corners = stated[0];
            return split_triangle(f, corners, led[0], inside == inside_.end() ? Polygon{} : inside->second);
        }
        if (inside != inside_.end())
            for (const Vertex v : inside->second) led.push_back({v});
        plc_.facets[f].polygons = std::move(led);
    }

    /// Triangles stay triangles, exactly plane: with one vertex more, by its edges to the corners.
    void split_triangle(std::uint32_t f, const Polygon& corners, const Polygon& border, const Polygon& inside) {
        std::vector<Polygon> pieces;
        const std::size_t n = border.size();
        if (inside.size() == 1 && n == 3) {
            for (std::size_t i = 0; i < 3; ++i) pieces.push_back({border[i], border[(i + 1) % 3], inside[0]});
        } else if (inside.empty() && n == 4) {
            const auto extra = static_cast<std::size_t>(std::find_if(border.begin(), border.end(), [&](Vertex v) { return std::find(corners.begin(), corners.end(), v) == corners.end(); }) - border.begin());
            for (const std::size_t i : {extra + 1, extra + 2}) pieces.push_back({border[extra % n], border[i % n], border[(i + 1) % n]});
        } else {
            PlcFacet& facet = plc_.facets[f];
            facet.polygons = {border};
            for (const Vertex v : inside) facet.polygons.push_back({v});
            return;
        }
        plc_.facets[f].polygons = {pieces[0]};
        for (std::size_t i = 1; i < pieces.size(); ++i) {
            PlcFacet facet;
            facet.polygons = {pieces[i]};
            facet.marker = plc_.facets[f].marker;
            plc_.facets.push_back(std::move(facet));
            joined_.source.facet.push_back(joined_.source.facet[f]);
        }
    }

    JoinedPlc& joined_;
    Plc& plc_;
    std::map<AscendingEdge, std::vector<std::pair<double, Vertex>>> on_edge_;  // by position
    std::map<std::uint32_t, Polygon> inside_;
};

/// Polygons and segments by the first of the vertices at a place, which is what validation makes of them.
void use_first_copies(Plc& plc) {
    const auto n = static_cast<Vertex>(plc.vertices.size());
    std::vector<Vertex> order(n), first(n);
    std::iota(order.begin(), order.end(), Vertex{0});
    std::sort(order.begin(), order.end(), [&](Vertex a, Vertex b) {
        const Vec3 &p = plc.vertices[a], &q = plc.vertices[b];
        return p == q ? a < b : lexicographically_less(p, q);
    });
    for (Vertex i = 0; i < n; ++i) first[order[i]] = i > 0 && plc.vertices[order[i]] == plc.vertices[order[i - 1]] ? first[order[i - 1]] : order[i];
    for (PlcFacet& f : plc.facets)
        for (Polygon& p : f.polygons)
            for (Vertex& v : p) v = first[v];
    for (PlcSegment& s : plc.segments)
        for (Vertex& v : s.vertices) v = first[v];
}

}  // namespace

JoinedPlc nothing_joined(const Plc& plc, double tolerance) {
    JoinedPlc joined{plc, {}, {}};
    joined.source.vertex.resize(plc.vertices.size());
    std::iota(joined.source.vertex.begin(), joined.source.vertex.end(), 0U);
    joined.source.facet.resize(plc.facets.size());
    std::iota(joined.source.facet.begin(), joined.source.facet.end(), 0U);
    joined.statistics.tolerance = tolerance;
    use_first_copies(joined.plc);
    return joined;
}

bool join_thin(JoinedPlc& joined, const Diagnosis& found) {
    const std::size_t before = joined.statistics.joined.size();
    Leader leader(joined);
    for (const Defect& d : found.defects) {
        if (d.severity != Severity::error) continue;
        if (d.kind != DefectKind::feature_too_thin) return false;
        if (d.elements.size() != 2) continue;  // needles among coplanar triangles
        const std::uint64_t v = d.elements[0].number - joined.plc.first_number, f = d.elements[1].number - joined.plc.first_number;
        if (!leader.note(static_cast<Vertex>(v), static_cast<std::uint32_t>(f), d.value)) return false;
    }
    leader.lead();
    return taper_short_edges(joined) && joined.statistics.joined.size() > before;
}

}  // namespace wellmesh
