// SPDX-License-Identifier: Apache-2.0
#include "certify/plc_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "certify/plane_triangulation.hpp"
#include "certify/suspect_mesh.hpp"
#include "core/vec3_math.hpp"
#include "predicates/exact_range.hpp"

namespace wellmesh::certifying {
namespace {

std::string problem_with(const Plc& plc) {
    const std::size_t n = plc.vertices.size();
    for (std::size_t v = 0; v < n; ++v) {
        const Vec3 p = flush_to_exact_range(plc.vertices[v]);
        if (!in_exact_range(p)) return fmt::format("PLC vertex {} has a coordinate that is not finite or too large", v + plc.first_number);
    }
    for (std::size_t f = 0; f < plc.facets.size(); ++f)
        for (const auto& polygon : plc.facets[f].polygons) {
            if (polygon.empty()) return fmt::format("facet {} of the PLC has an empty polygon", f + 1);
            for (const std::uint32_t v : polygon)
                if (v >= n) return fmt::format("facet {} of the PLC names a vertex that is not there", f + 1);
        }
    for (std::size_t s = 0; s < plc.segments.size(); ++s)
        if (plc.segments[s].vertices[0] >= n || plc.segments[s].vertices[1] >= n) return fmt::format("segment {} of the PLC names a vertex that is not there", s + 1);
    return {};
}

/// One number for all vertices at one place: the lowest.
class Places {
public:
    explicit Places(const std::vector<Vec3>& points) : points_(points), order_(points.size()), first_(points.size()) {
        std::iota(order_.begin(), order_.end(), 0U);
        std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
            return lexicographically_less(points[a], points[b]) || (points[a] == points[b] && a < b);
        });
        for (std::size_t i = 0; i < order_.size(); ++i)
            first_[order_[i]] = i > 0 && points[order_[i - 1]] == points[order_[i]] ? first_[order_[i - 1]] : order_[i];
    }
    [[nodiscard]] std::uint32_t of(std::uint32_t v) const { return first_[v]; }
    /// kNone if no vertex is there.
    [[nodiscard]] std::uint32_t at(const Vec3& p) const {
        const auto it = std::lower_bound(order_.begin(), order_.end(), p, [&](std::uint32_t v, const Vec3& q) { return lexicographically_less(points_[v], q); });
        return it != order_.end() && points_[*it] == p ? *it : kNone;
    }

private:
    const std::vector<Vec3>& points_;
    std::vector<std::uint32_t> order_, first_;
};

/// An edge of a triangle of the surface.
struct Side {
    std::uint32_t a = 0, b = 0, triangle = 0;
    Vec3 opposite{};
};

class EdgeSelection {
public:
    EdgeSelection(const PlcSurface& surface, const Places& places, double flat_angle, double bend_tolerance)
        : points_(surface.points), facets_(surface.facets), flat_angle_(flat_angle), bend_tolerance_(bend_tolerance) {
        const auto& triangles = surface.triangles.triangles();
        for (std::uint32_t t = 0; t < triangles.size(); ++t) {
            std::array<std::uint32_t, 3> v{};
            for (std::size_t k = 0; k < 3; ++k) v[k] = places.at(triangles[t][k]);
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t a = v[k], b = v[(k + 1) % 3];
                if (a != kNone && b != kNone) sides_.push_back({std::min(a, b), std::max(a, b), t, triangles[t][(k + 2) % 3]});
            }
        }
        std::sort(sides_.begin(), sides_.end(), [](const Side& s, const Side& o) { return std::tie(s.a, s.b, s.triangle) < std::tie(o.a, o.b, o.triangle); });
    }

    /// See PlcSurface::edges. @pre a < b, both the first at their place.
    [[nodiscard]] bool wanted(std::uint32_t a, std::uint32_t b) const {
        const auto [begin, end] = std::equal_range(sides_.begin(), sides_.end(), Side{a, b, 0, {}}, [](const Side& s, const Side& o) { return std::tie(s.a, s.b) < std::tie(o.a, o.b); });
        if (end - begin != 2 || facets_[begin->triangle] == facets_[(begin + 1)->triangle]) return true;
        const Vec3 along = points_[b] - points_[a];
        const Vec3 n0 = cross(along, begin->opposite - points_[a]), n1 = cross((begin + 1)->opposite - points_[a], along);
        const double height = std::sqrt(std::min(squared_norm(n0), squared_norm(n1))) / norm(along);
        return !(std::atan2(norm(cross(n0, n1)), dot(n0, n1)) < std::max(flat_angle_, bend_tolerance_ / height));
    }

private:
    const std::vector<Vec3>& points_;
    const std::vector<std::uint32_t>& facets_;
    double flat_angle_, bend_tolerance_;
    std::vector<Side> sides_;
};

void collect_vertices(const Plc& plc, const Places& places, PlcSurface& surface) {
    std::vector<std::uint8_t> used(plc.vertices.size(), 0);  // 1 by a facet
    for (const PlcFacet& f : plc.facets)
        for (const auto& polygon : f.polygons)
            for (const std::uint32_t v : polygon) used[places.of(v)] = 1;
    // What nothing uses is a point of a complex, but a leftover in a file that states the surface of a solid.
    std::vector<std::uint8_t> meant(plc.vertices.size(), plc.fill == FillRule::bounded_cells ? 1 : 0);
    for (const PlcSegment& s : plc.segments)
        for (const std::uint32_t v : s.vertices) meant[places.of(v)] = 1;
    for (std::uint32_t v = 0; v < used.size(); ++v) {
        if (places.of(v) != v) continue;
        if (used[v]) surface.facet_vertices.push_back(v);
        else if (meant[v]) surface.other_vertices.push_back(v);
    }
}

/// Facets of which an earlier one has the same polygons: shared walls of solids that touch are listed twice, and are one facet.
std::vector<bool> find_repetitions(const Plc& plc, const Places& places) {
    using Outline = std::vector<std::uint32_t>;
    std::vector<std::pair<std::vector<Outline>, std::uint32_t>> outlines;
    for (std::uint32_t f = 0; f < plc.facets.size(); ++f) {
        std::vector<Outline> polygons;
        for (const auto& polygon : plc.facets[f].polygons) {
            // The same from whatever corner and in whichever direction it is listed.
            Outline forward;
            for (const std::uint32_t v : polygon) forward.push_back(places.of(v));
            std::rotate(forward.begin(), std::min_element(forward.begin(), forward.end()), forward.end());
            Outline backward(forward.rbegin(), forward.rend());
            std::rotate(backward.begin(), std::min_element(backward.begin(), backward.end()), backward.end());
            polygons.push_back(std::min(forward, backward));
        }
        std::sort(polygons.begin(), polygons.end());
        outlines.emplace_back(std::move(polygons), f);
    }
    std::sort(outlines.begin(), outlines.end());
    std::vector<bool> repeated(plc.facets.size(), false);
    for (std::size_t i = 1; i < outlines.size(); ++i)
        if (outlines[i].first == outlines[i - 1].first && plc.facets[outlines[i].second].holes.size() == plc.facets[outlines[i - 1].second].holes.size())
            repeated[outlines[i].second] = true;
    return repeated;
}

/// Triangles that bound no cell: fins, flaps and free sheets. One with an edge that no other triangle has is such a one; without it, so may
/// be its neighbours.
std::vector<bool> find_dangling(const std::vector<Corners>& triangles) {
    struct Use {
        std::array<double, 6> edge;
        std::uint32_t triangle;
    };
    const auto key = [](const Vec3& a, const Vec3& b) {
        const bool order = lexicographically_less(a, b);
        const Vec3 &p = order ? a : b, &q = order ? b : a;
        return std::array<double, 6>{p.x + 0.0, p.y + 0.0, p.z + 0.0, q.x + 0.0, q.y + 0.0, q.z + 0.0};  // -0 + 0 is 0
    };
    std::vector<Use> uses;
    uses.reserve(3 * triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) uses.push_back({key(triangles[t][k], triangles[t][(k + 1) % 3]), t});
    std::sort(uses.begin(), uses.end(), [](const Use& u, const Use& v) { return std::tie(u.edge, u.triangle) < std::tie(v.edge, v.triangle); });
    std::vector<std::uint32_t> edge_of(uses.size()), left;
    std::vector<std::array<std::uint32_t, 3>> edges(triangles.size());
    std::vector<std::size_t> filled(triangles.size(), 0), first;
    for (std::size_t i = 0; i < uses.size(); ++i) {
        if (i == 0 || uses[i].edge != uses[i - 1].edge) {
            left.push_back(0);
            first.push_back(i);
        }
        edge_of[i] = static_cast<std::uint32_t>(left.size() - 1);
        ++left.back();
        edges[uses[i].triangle][filled[uses[i].triangle]++] = edge_of[i];
    }
    first.push_back(uses.size());
    std::vector<bool> dangling(triangles.size(), false);
    std::vector<std::uint32_t> waiting;
    for (std::uint32_t e = 0; e < left.size(); ++e)
        if (left[e] == 1) waiting.push_back(e);
    while (!waiting.empty()) {
        const std::uint32_t e = waiting.back();
        waiting.pop_back();
        for (std::size_t i = first[e]; i < first[e + 1]; ++i) {
            const std::uint32_t t = uses[i].triangle;
            if (dangling[t]) continue;
            dangling[t] = true;
            for (const std::uint32_t other : edges[t])
                if (--left[other] == 1) waiting.push_back(other);
        }
    }
    return dangling;
}

void collect_edges(const Plc& plc, const Places& places, double flat_angle, double bend_tolerance, PlcSurface& surface) {
    const EdgeSelection selection(surface, places, flat_angle, bend_tolerance);
    struct Use {
        std::uint32_t a, b, facet;
        auto operator<=>(const Use&) const = default;
    };
    std::vector<Use> uses;
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t facet) {
        const auto [low, high] = std::minmax({places.of(a), places.of(b)});
        if (low != high) uses.push_back({low, high, facet});
    };
    std::vector<bool> has_area(plc.facets.size(), false);
    for (const std::uint32_t f : surface.facets) has_area[f] = true;
    for (std::uint32_t f = 0; f < plc.facets.size(); ++f)
        for (const auto& polygon : plc.facets[f].polygons)
            for (std::size_t i = 0; has_area[f] && i < polygon.size(); ++i) add(polygon[i], polygon[(i + 1) % polygon.size()], f);
    std::erase_if(uses, [&](const Use& e) { return !selection.wanted(e.a, e.b); });
    for (const PlcSegment& s : plc.segments) add(s.vertices[0], s.vertices[1], kNone);
    std::sort(uses.begin(), uses.end());
    for (const Use& u : uses) {
        if (surface.edges.empty() || surface.edges.back().a != u.a || surface.edges.back().b != u.b) surface.edges.push_back({u.a, u.b, {}});
        if (u.facet != kNone) surface.edges.back().facets.push_back(u.facet);
    }
}

}  // namespace

PlcReading read_surface(const Plc& plc, double flat_angle, double relative_tolerance) {
    if (std::string problem = problem_with(plc); !problem.empty()) return {std::nullopt, std::move(problem)};
    PlcSurface surface;
    surface.points = plc.vertices;
    for (Vec3& p : surface.points) p = flush_to_exact_range(p);
    const Places places(surface.points);
    const std::vector<bool> repeated = find_repetitions(plc, places);
    std::vector<Corners> triangles;
    for (std::uint32_t f = 0; f < plc.facets.size(); ++f) {
        if (repeated[f]) continue;
        const std::optional<std::vector<Corners>> cover = triangulate_facet(surface.points, plc.facets[f]);
        if (!cover) return {std::nullopt, fmt::format("the edges of facet {} of the PLC cross each other too often", f + 1)};
        triangles.insert(triangles.end(), cover->begin(), cover->end());
        surface.facets.resize(triangles.size(), f);
    }
    if (triangles.empty()) return {std::nullopt, "the PLC has no facet with an area"};
    surface.dangling = find_dangling(triangles);
    surface.triangles = TriangleTree(std::move(triangles));
    const Box3 box = Box3::of(surface.points.data(), surface.points.size());
    surface.diagonal = norm(box.high - box.low);
    double largest = 0;
    for (const Vec3& p : surface.points) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    collect_vertices(plc, places, surface);
    // Three kinds of fuzz: rounding of doubles, rounding before they became doubles (two triangles, a few coordinates each), and what the
    // caller tolerates as the distance between a mesh and the PLC.
    const double bend = std::max({32 * std::numeric_limits<double>::epsilon() * largest, 8 * plc.relative_rounding * largest, 4 * relative_tolerance * surface.diagonal});
    collect_edges(plc, places, flat_angle, bend, surface);
    return {std::move(surface), {}};
}

}  // namespace wellmesh::certifying
