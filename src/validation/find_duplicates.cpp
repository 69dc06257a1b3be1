// SPDX-License-Identifier: Apache-2.0
#include "validation/find_duplicates.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "core/vec3_math.hpp"
#include "predicates/exact_range.hpp"
#include "validation/box_tree.hpp"
#include "validation/plane.hpp"

namespace wellmesh {
namespace {

using Polygon = std::vector<VertexId>;

class Cleaner {
public:
    Cleaner(const Plc& plc, const Rounding& rounding, Report& report) : plc_(plc), rounding_(rounding), report_(report) {}

    CleanInput run() {
        merge_vertices();
        for (std::size_t f = 0; f < plc_.facets.size(); ++f) add_facet(f);
        for (std::size_t s = 0; s < plc_.segments.size(); ++s) add_wire(s);
        mend_needles();
        merge_copies();
        report_summaries();
        return std::move(out_);
    }

private:
    void merge_vertices();
    bool is_usable(std::size_t v);
    void require_extent(const std::vector<std::uint32_t>& usable);
    void add_facet(std::size_t f);
    bool clean_polygon(std::size_t f, const std::vector<std::uint32_t>& stated, Polygon& polygon);
    bool is_collinear(const CleanFacet& facet) const;
    bool drop_needle(const CleanFacet& facet);
    void drop_degenerate(std::size_t f, const CleanFacet& facet);
    void add_wire(std::size_t s);
    void mend_needles();
    void merge_copies();
    void report_summaries();

    const Plc& plc_;
    const Rounding& rounding_;
    Report& report_;
    CleanInput out_;
    std::vector<Polygon> needles_;
    std::vector<ElementRef> merged_, degenerate_, copies_;
    std::size_t mended_ = 0;
};

bool Cleaner::is_usable(std::size_t v) {
    const Vec3& p = plc_.vertices[v];
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
        report_.add(DefectKind::non_finite_coordinate, Severity::error, {report_.vertex(v)},
                    fmt::format("{} has a coordinate that is not a number or infinite: {}", report_.name_vertex(v), format_point(p)));
        return false;
    }
    if (!in_exact_range(p)) {
        report_.add(DefectKind::coordinate_range, Severity::error, {report_.vertex(v)},
                    fmt::format("{} at {} has a coordinate outside the range in which predicates are exact, zero or magnitudes of {:.1e} to "
                                "{:.1e}: scale or clean the input",
                                report_.name_vertex(v), format_point(p), kMinMagnitude, kMaxMagnitude));
        return false;
    }
    return true;
}

/// Measures of shape are products of up to eight lengths.
void Cleaner::require_extent(const std::vector<std::uint32_t>& usable) {
    constexpr double kLeast = 1e-36;  // input units
    Box box;
    for (const std::uint32_t v : usable) box.add(plc_.vertices[v]);
    if (box.empty()) return;
    const double extent = std::max({box.high.x - box.low.x, box.high.y - box.low.y, box.high.z - box.low.z});
    if (extent == 0 || extent >= kLeast) return;  // 0: that is another fault
    report_.add(DefectKind::coordinate_range, Severity::error, {report_.vertex(usable.front())},
                fmt::format("the input is only {:.3g} across; below {:.0e} shapes can't be told from each other: scale it", extent, kLeast));
}

void Cleaner::merge_vertices() {
    const std::size_t n = plc_.vertices.size();
    out_.of_input.resize(n);
    std::vector<std::uint32_t> order;
    order.reserve(n);
    for (std::size_t v = 0; v < n; ++v)
        if (is_usable(v)) order.push_back(static_cast<std::uint32_t>(v));
    require_extent(order);
    const auto less = [&](std::uint32_t a, std::uint32_t b) {  // comparisons of doubles: -0 and 0 are one
        const Vec3 &p = plc_.vertices[a], &q = plc_.vertices[b];
        return p == q ? a < b : lexicographically_less(p, q);
    };
    std::sort(order.begin(), order.end(), less);
    std::vector<std::uint32_t> representative(n);
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool again = i > 0 && plc_.vertices[order[i]] == plc_.vertices[order[i - 1]];
        representative[order[i]] = again ? representative[order[i - 1]] : order[i];
    }
    std::sort(order.begin(), order.end());
    for (const std::uint32_t v : order) {
        if (representative[v] != v) {  // smaller than v, hence done
            out_.of_input[v] = out_.of_input[representative[v]];
            merged_.push_back(report_.vertex(v));
            continue;
        }
        out_.of_input[v] = VertexId{out_.points.size()};
        const Vec3& p = plc_.vertices[v];
        out_.points.push_back({p.x + 0.0, p.y + 0.0, p.z + 0.0});  // -0 + 0 is 0
        out_.source_vertex.push_back(v);
    }
}

/// False if the polygon cannot be used; the reason has been reported.
bool Cleaner::clean_polygon(std::size_t f, const std::vector<std::uint32_t>& stated, Polygon& polygon) {
    for (const std::uint32_t v : stated) {
        if (v >= plc_.vertices.size()) {
            report_.add(DefectKind::bad_index, Severity::error, {report_.facet(f)},
                        fmt::format("{} names vertex {}, but the vertices end at {}", report_.name_facet(f),
                                    std::uint64_t{v} + plc_.first_number, static_cast<std::int64_t>(plc_.vertices.size()) - 1 + plc_.first_number));
            return false;
        }
        const VertexId id = out_.of_input[v];
        if (!id.valid()) return false;  // reported with the vertex
        if (polygon.empty() || polygon.back() != id) polygon.push_back(id);
    }
    while (polygon.size() > 1 && polygon.front() == polygon.back()) polygon.pop_back();
    return true;
}

void Cleaner::add_facet(std::size_t f) {
    CleanFacet facet;
    facet.source = static_cast<std::uint32_t>(f);
    const auto& stated = plc_.facets[f].polygons;
    facet.single_triangle = stated.size() == 1 && stated[0].size() == 3 && plc_.facets[f].holes.empty();
    std::size_t corners = 0;
    bool collapsed = false;
    for (const auto& s : stated) {
        if (s.empty()) continue;
        Polygon polygon;
        if (!clean_polygon(f, s, polygon)) return;
        collapsed |= s.size() >= 3 && polygon.size() < 3;
        corners = std::max(corners, polygon.size());
        facet.polygons.push_back(std::move(polygon));
    }
    if (corners >= 3 && !is_collinear(facet)) {
        if (!drop_needle(facet)) out_.facets.push_back(std::move(facet));
        return;
    }
    if (collapsed || corners >= 3 || corners == 0) {
        drop_degenerate(f, facet);
        return;
    }
    for (const Polygon& p : facet.polygons) {  // stated as segments and points only
        if (p.size() == 2) {
            out_.wires.push_back({p[0], p[1]});
            out_.wire_markers.push_back(plc_.facets[f].marker);
        } else {
            out_.lone_vertices.push_back(p[0]);
        }
    }
}

bool Cleaner::is_collinear(const CleanFacet& facet) const {
    VertexId low = facet.polygons[0][0], high = low;
    for (const Polygon& polygon : facet.polygons)
        for (const VertexId v : polygon) {
            if (lexicographically_less(out_.points[v.index()], out_.points[low.index()])) low = v;
            if (lexicographically_less(out_.points[high.index()], out_.points[v.index()])) high = v;
        }
    for (const Polygon& polygon : facet.polygons)
        for (const VertexId v : polygon)
            if (v != low && v != high && !collinear(out_.points[low.index()], out_.points[high.index()], out_.points[v.index()])) return false;
    return true;
}

/// A triangle with an area that is lower than its coordinates can resolve stands for a crack between its longest edge and its other
/// two; closing the crack moves the surface by less than rounding has. True if it was dropped.
bool Cleaner::drop_needle(const CleanFacet& facet) {
    if (facet.polygons.size() != 1 || facet.polygons[0].size() != 3 || !facet.single_triangle) return false;
    Polygon needle = facet.polygons[0];
    const auto at = [&](std::size_t i) -> const Vec3& { return out_.points[needle[i % 3].index()]; };
    std::size_t base = 0;
    for (std::size_t i = 1; i < 3; ++i)
        if (squared_distance(at(i), at(i + 1)) > squared_distance(at(base), at(base + 1))) base = i;
    const Vec3 along = at(base + 1) - at(base), rest = at(base + 2) - at(base);
    const double length = norm(along);
    if (norm(cross(along, rest)) > rounding_.contact() * length) return false;
    // as short as it is low: nothing to close
    if (!(length > 8 * rounding_.contact()) || !(dot(along, rest) > 0) || !(dot(along, along - rest) > 0)) return false;
    degenerate_.push_back(report_.facet(facet.source, at(0)));
    needles_.push_back({needle[base], needle[(base + 2) % 3], needle[(base + 1) % 3]});
    return true;
}

void Cleaner::drop_degenerate(std::size_t f, const CleanFacet& facet) {
    const auto& stated = plc_.facets[f].polygons;
    std::optional<Vec3> where;
    if (!facet.polygons.empty()) where = out_.points[facet.polygons[0][0].index()];
    degenerate_.push_back(report_.facet(f, where));
    if (stated.size() == 1 && !facet.polygons.empty() && facet.polygons[0].size() == 3) {
        Polygon needle = facet.polygons[0];  // along a line, the lexicographic order is the order on the line
        std::sort(needle.begin(), needle.end(), [&](VertexId a, VertexId b) { return lexicographically_less(out_.points[a.index()], out_.points[b.index()]); });
        needles_.push_back(std::move(needle));
    }
}

void Cleaner::add_wire(std::size_t s) {
    std::array<VertexId, 2> ends;
    for (std::size_t i = 0; i < 2; ++i) {
        const std::uint32_t v = plc_.segments[s].vertices[i];
        if (v >= plc_.vertices.size()) {
            const std::uint64_t number = s + plc_.first_number;
            report_.add(DefectKind::bad_index, Severity::error, {{EntityKind::segment, number, std::nullopt}},
                        fmt::format("segment {} names vertex {}, which does not exist", number, std::uint64_t{v} + plc_.first_number));
            return;
        }
        ends[i] = out_.of_input[v];
        if (!ends[i].valid()) return;
    }
    if (ends[0] == ends[1]) {
        out_.lone_vertices.push_back(ends[0]);
        return;
    }
    out_.wires.push_back(ends);
    out_.wire_markers.push_back(plc_.segments[s].marker);
}

void Cleaner::mend_needles() {
    if (needles_.empty()) return;
    std::vector<char> used(out_.points.size(), 0);
    for (const CleanFacet& facet : out_.facets)
        for (const Polygon& polygon : facet.polygons)
            for (const VertexId v : polygon) used[v.index()] = 1;
    EdgeChains chains(out_.points);
    for (const Polygon& n : needles_)
        if (used[n[1].index()]) chains.split(n[0], n[2], n[1]);
    for (CleanFacet& facet : out_.facets) {
        bool changed = false;
        for (Polygon& polygon : facet.polygons) changed |= chains.expand(polygon);
        mended_ += changed;
    }
}

/// A polygon from its smallest vertex in the direction of its smaller neighbour, and whether that reverses it.
std::pair<Polygon, bool> normal_form(const Polygon& polygon) {
    Polygon p = polygon;
    std::rotate(p.begin(), std::min_element(p.begin(), p.end()), p.end());
    const bool reversed = p.size() > 2 && p.back() < p[1];
    if (reversed) std::reverse(p.begin() + 1, p.end());
    return {std::move(p), reversed};
}

void Cleaner::merge_copies() {
    std::map<std::vector<Polygon>, std::pair<std::size_t, bool>> seen;
    std::vector<CleanFacet> kept;
    for (CleanFacet& facet : out_.facets) {
        std::vector<Polygon> key;
        bool reversed = false;
        for (std::size_t i = 0; i < facet.polygons.size(); ++i) {
            auto [form, flipped] = normal_form(facet.polygons[i]);
            if (i == 0) reversed = flipped;
            key.push_back(std::move(form));
        }
        std::sort(key.begin(), key.end());
        // holes in one of two facets with equal polygons make them different; they then overlap, which is found later
        if (!plc_.facets[facet.source].holes.empty()) key.push_back({VertexId{facet.source}});
        const auto [it, fresh] = seen.try_emplace(std::move(key), kept.size(), reversed);
        if (fresh) {
            kept.push_back(std::move(facet));
            continue;
        }
        CleanFacet& first = kept[it->second.first];
        first.winding += it->second.second == reversed ? 1 : -1;
        const Vec3& where = out_.points[facet.polygons[0][0].index()];
        report_.add(DefectKind::duplicate_facet, Severity::warning, {report_.facet(facet.source, where), report_.facet(first.source, where)},
                    fmt::format("{} repeats {} and was dropped", report_.name_facet(facet.source), report_.name_facet(first.source)));
    }
    out_.facets = std::move(kept);
}

void Cleaner::report_summaries() {
    if (!merged_.empty()) {
        const std::size_t n = merged_.size();
        report_.add(DefectKind::duplicate_vertex, Severity::note, std::move(merged_), fmt::format("{} vertices repeat others bit by bit and were merged", n),
                    static_cast<double>(n));
    }
    if (!degenerate_.empty()) {
        const std::size_t n = degenerate_.size();
        report_.add(DefectKind::degenerate_facet, Severity::note, std::move(degenerate_),
                    fmt::format("{} facets without area, exactly or but for rounding, were dropped{}", n,
                                mended_ == 0 ? std::string{} : fmt::format("; {} neighbours of theirs were split at the vertices in between", mended_)),
                    static_cast<double>(n));
    }
}

}  // namespace

void EdgeChains::split(VertexId a, VertexId b, VertexId inside) {
    const Vec3 &p = points_[a.index()], &q = points_[b.index()], &m = points_[inside.index()];
    const double whole = squared_distance(p, q);
    if (squared_distance(p, m) < whole && squared_distance(m, q) < whole) inside_.try_emplace(edge_key(a, b), inside);
}

void EdgeChains::append_between(VertexId a, VertexId b, std::vector<VertexId>& out) const {
    const auto it = inside_.find(edge_key(a, b));
    if (it == inside_.end()) return;
    const VertexId m = it->second;  // both parts are shorter, so this ends
    append_between(a, m, out);
    out.push_back(m);
    append_between(m, b, out);
}

bool EdgeChains::expand(std::vector<VertexId>& polygon) const {
    if (polygon.size() < 2) return false;
    std::vector<VertexId> longer;
    longer.reserve(polygon.size());
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        longer.push_back(polygon[i]);
        append_between(polygon[i], polygon[(i + 1) % polygon.size()], longer);
    }
    const bool changed = longer.size() != polygon.size();
    polygon = std::move(longer);
    return changed;
}

CleanInput clean_input(const Plc& plc, const Rounding& rounding, Report& report) { return Cleaner(plc, rounding, report).run(); }

}  // namespace wellmesh
