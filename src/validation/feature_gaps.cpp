// SPDX-License-Identifier: Apache-2.0
// Distances between vertices, segments and facets that have no vertex in common.
#include <algorithm>
#include <map>

#include <fmt/format.h>

#include "core/vec3_math.hpp"
#include "validation/box_tree.hpp"
#include "validation/closest_points.hpp"
#include "validation/examine.hpp"

namespace wellmesh {
namespace {

/// Pairs listed before the search gives up.
constexpr std::size_t kMostGapsListed = 100000;

/// A vertex, or a segment, with a facet or a segment apart from it.
struct Gap {
    double distance = 0;
    Vec3 from{}, to{};
};

class GapFinder {
public:
    explicit GapFinder(const Complexes& complex) : complex_(complex), used_(complex.input.points.size(), 0) {
        for (const SoupTriangle& t : complex.soup.triangles) {
            for (const VertexId v : t.v) used_[v.index()] = 1;
            triangle_boxes_.emplace_back();
            for (const VertexId v : t.v) triangle_boxes_.back().add(complex.point(v));
        }
        for (std::size_t e = 0; e < complex.edges.keys.size(); ++e)
            if (complex.groups.is_segment[e]) segments_.push_back(edge_ends(complex.edges.keys[e]));
        for (const auto& wire : complex.soup.wires) segments_.push_back(wire);
        for (const auto& [a, b] : segments_) {
            used_[a.index()] = used_[b.index()] = 1;
            segment_boxes_.emplace_back();
            segment_boxes_.back().add(complex.point(a));
            segment_boxes_.back().add(complex.point(b));
        }
        triangle_tree_.emplace(triangle_boxes_);
        segment_tree_.emplace(segment_boxes_);
    }

    [[nodiscard]] const std::vector<std::array<VertexId, 2>>& segments() const { return segments_; }

    /// Calls at_facet(vertex, triangle, gap) and at_segments(segment, segment, gap) for what is nearer than `limit`, which they may lower.
    template <class AtFacet, class AtSegments>
    void visit(double& limit, AtFacet&& at_facet, AtSegments&& at_segments) const {
        for (std::uint32_t i = 0; i < used_.size(); ++i)
            if (used_[i]) vertex_to_facets(VertexId{i}, limit, at_facet);
        for (std::uint32_t s = 0; s < segments_.size(); ++s) segment_to_segments(s, limit, at_segments);
    }

private:
    template <class AtFacet>
    void vertex_to_facets(VertexId v, double& limit, AtFacet&& at_facet) const {
        const Vec3& p = complex_.point(v);
        Box place;
        place.add(p);
        triangle_tree_->query([&](const Box& b) { return b.meets(place.grown(limit)); }, [&](std::uint32_t t) {
            const auto& own = complex_.groups.vertices[complex_.groups.group_of[t]];
            if (std::binary_search(own.begin(), own.end(), v)) return;
            const auto& c = complex_.soup.triangles[t].v;
            const std::array<Vec3, 3> q{complex_.point(c[0]), complex_.point(c[1]), complex_.point(c[2])};
            const double d = distance_to_triangle(p, q);
            if (d < limit) at_facet(v, t, Gap{d, p, closest_on_triangle(p, q)});
        });
    }

    template <class AtSegments>
    void segment_to_segments(std::uint32_t s, double& limit, AtSegments&& at_segments) const {
        const std::array<VertexId, 2>& ends = segments_[s];
        const std::array<Vec3, 2> here{complex_.point(ends[0]), complex_.point(ends[1])};
        segment_tree_->query([&](const Box& box) { return box.meets(segment_boxes_[s].grown(limit)); }, [&](std::uint32_t t) {
            const auto [c, d] = segments_[t];
            if (t <= s || ends[0] == c || ends[0] == d || ends[1] == c || ends[1] == d) return;
            const ClosestPair closest = closest_between(here, {complex_.point(c), complex_.point(d)});
            const double gap = distance(closest.on_first, closest.on_second);
            if (gap < limit) at_segments(s, t, Gap{gap, closest.on_first, closest.on_second});
        });
    }

    const Complexes& complex_;
    std::vector<char> used_;
    std::vector<Box> triangle_boxes_, segment_boxes_;
    std::vector<std::array<VertexId, 2>> segments_;
    std::optional<BoxTree> triangle_tree_, segment_tree_;
};

}  // namespace

void find_near_misses(const Complexes& complex, double limit, Report& report) {
    if (!(limit > 0)) return;
    const GapFinder finder(complex);
    std::map<std::array<std::uint32_t, 2>, std::pair<Gap, std::uint32_t>> at_facets;  // vertex and group: nearest triangle
    std::vector<std::pair<Gap, std::array<std::uint32_t, 2>>> at_segments;
    finder.visit(
        limit,
        [&](VertexId v, std::uint32_t t, const Gap& gap) {
            if (at_facets.size() >= kMostGapsListed) return;
            const auto [it, fresh] = at_facets.try_emplace({v.value(), complex.groups.group_of[t]}, gap, t);
            if (!fresh && gap.distance < it->second.first.distance) it->second = {gap, t};
        },
        [&](std::uint32_t s, std::uint32_t t, const Gap& gap) {
            const auto at_end = [&](const std::array<VertexId, 2>& ends, const Vec3& p) { return p == complex.point(ends[0]) || p == complex.point(ends[1]); };
            // a gap at an end is one between that vertex and a facet, unless there is no facet
            const bool is_wire = s + complex.soup.wires.size() >= finder.segments().size() || t + complex.soup.wires.size() >= finder.segments().size();
            if (!is_wire && (at_end(finder.segments()[s], gap.from) || at_end(finder.segments()[t], gap.to))) return;
            if (at_segments.size() < kMostGapsListed) at_segments.push_back({gap, {s, t}});
        });
    struct Entry {
        Gap gap;
        std::vector<ElementRef> elements;
        std::string text;
    };
    std::vector<Entry> entries;
    const auto source = [&](VertexId v) { return complex.input.source_vertex[v.index()]; };
    for (const auto& [key, found] : at_facets) {
        const auto& [gap, t] = found;
        if (gap.distance == 0) continue;  // contact is another matter
        const std::uint32_t facet = complex.input.facets[complex.soup.triangles[t].facet].source, vertex = source(VertexId{key[0]});
        entries.push_back({gap, {report.vertex(vertex), report.facet(facet, gap.to)},
                           fmt::format("{} at {} and {} are {:.3g} apart", report.name_vertex(vertex), format_point(gap.from), report.name_facet(facet), gap.distance)});
    }
    for (const auto& [gap, pair] : at_segments) {
        if (gap.distance == 0) continue;
        std::vector<ElementRef> elements;
        for (const std::uint32_t s : pair)
            for (const VertexId v : finder.segments()[s]) elements.push_back(report.vertex(source(v)));
        const auto name = [&](std::uint32_t s) {
            return fmt::format("the segment from {} to {}", report.name_vertex(source(finder.segments()[s][0])), report.name_vertex(source(finder.segments()[s][1])));
        };
        entries.push_back({gap, std::move(elements), fmt::format("{} and {} are {:.3g} apart near {}", name(pair[0]), name(pair[1]), gap.distance, format_point(gap.from))});
    }
    std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.gap.distance < b.gap.distance; });
    for (Entry& e : entries) report.add(DefectKind::near_miss, Severity::warning, std::move(e.elements), std::move(e.text), e.gap.distance, {e.gap.from, e.gap.to});
}

SmallestFeatures find_smallest_features(const Complexes& complex) {
    SmallestFeatures smallest;
    const GapFinder finder(complex);
    for (const auto& [a, b] : finder.segments()) {
        const double length = distance(complex.point(a), complex.point(b));
        if (smallest.segment.points.empty() || length < smallest.segment.value) smallest.segment = {length, {complex.point(a), complex.point(b)}};
    }
    smallest.gap = smallest.segment;  // its ends are vertices apart from each other
    const auto lower = [&](std::uint32_t, std::uint32_t, const Gap& gap) { smallest.gap = {gap.distance, {gap.from, gap.to}}; };
    finder.visit(smallest.gap.value, [&](VertexId v, std::uint32_t t, const Gap& gap) { lower(v.value(), t, gap); }, lower);
    if (const auto angles = placed_angles(complex); !angles.empty()) {
        smallest.angle.value = angles.front().degrees;
        for (const VertexId v : angles.front().at) smallest.angle.points.push_back(complex.point(v));
    }
    return smallest;
}

}  // namespace wellmesh
