// SPDX-License-Identifier: Apache-2.0
#include "validation/find_intersections.hpp"

#include <algorithm>
#include <unordered_set>

#include <fmt/format.h>

#include "validation/box_tree.hpp"
#include "validation/triangle_contact.hpp"

namespace wellmesh {
namespace {

/// Pairs listed before the search gives up: a file in which everything meets everything has quadratically many.
constexpr std::size_t kMostIntersectionsListed = 100000;
constexpr std::size_t kBetweenCheckpoints = 256;  // edges

/// Triangles, then wires, then lone vertices, in one numbering.
class IntersectionFinder {
public:
    IntersectionFinder(const CleanInput& input, const Soup& soup, const EdgeTable& edges, Report& report, const Checkpoint& checkpoint)
        : input_(input), soup_(soup), edges_(edges), report_(report), checkpoint_(checkpoint) {
        std::vector<char> used(input.points.size(), 0);
        for (const SoupTriangle& t : soup.triangles)
            for (const VertexId v : t.v) used[v.index()] = 1;
        for (const auto& w : soup.wires) used[w[0].index()] = used[w[1].index()] = 1;
        for (std::size_t v = 0; v < used.size(); ++v)
            if (!used[v]) lone_.emplace_back(v);
        for (std::size_t i = 0; i < first_lone() + lone_.size(); ++i) {
            Box box;
            for (std::size_t k = 0; k < corners(i); ++k) box.add(point(vertex(i, k)));
            boxes_.push_back(box);
        }
    }

    void run() {
        const BoxTree tree(boxes_);
        for (std::size_t e = 0; e < edges_.keys.size() && !full(); ++e) {
            if (e % kBetweenCheckpoints == 0) pass(checkpoint_);
            test_edge(e, tree);
        }
        for (std::uint32_t i = static_cast<std::uint32_t>(first_wire()); i < boxes_.size() && !full(); ++i)
            tree.query([&](const Box& b) { return b.meets(boxes_[i]); },
                       [&](std::uint32_t j) {
                           if (j < i) test_wire_or_vertex(i, j);
                       });
        for (std::size_t e = 0; e < edges_.keys.size() && !full(); ++e) test_folds(e);
        if (full()) report_.add(DefectKind::self_intersection, Severity::error, {}, fmt::format("there may be more intersections than the {} listed", kMostIntersectionsListed));
    }

private:
    [[nodiscard]] bool full() const { return listed_ >= kMostIntersectionsListed; }
    [[nodiscard]] std::size_t first_wire() const { return soup_.triangles.size(); }
    [[nodiscard]] std::size_t first_lone() const { return first_wire() + soup_.wires.size(); }
    [[nodiscard]] std::size_t corners(std::size_t i) const { return i < first_wire() ? 3 : i < first_lone() ? 2 : 1; }
    [[nodiscard]] VertexId vertex(std::size_t i, std::size_t k) const {
        return i < first_wire() ? soup_.triangles[i].v[k] : i < first_lone() ? soup_.wires[i - first_wire()][k] : lone_[i - first_lone()];
    }
    [[nodiscard]] const Vec3& point(VertexId v) const { return input_.points[v.index()]; }
    [[nodiscard]] NamedTriangle triangle(std::size_t i) const {
        const auto& v = soup_.triangles[i].v;
        return {{point(v[0]), point(v[1]), point(v[2])}, {v[0].value(), v[1].value(), v[2].value()}};
    }
    [[nodiscard]] NamedSegment segment(const std::array<VertexId, 2>& v) const {
        return {{point(v[0]), point(v[1])}, {v[0].value(), v[1].value()}};
    }
    [[nodiscard]] NamedSegment wire(std::size_t i) const { return segment(soup_.wires[i - first_wire()]); }
    void test_edge(std::size_t edge, const BoxTree& tree);
    void test_wire_or_vertex(std::uint32_t i, std::uint32_t j);
    void test_folds(std::size_t edge);
    void add(std::size_t i, std::size_t j, const Vec3& where);
    [[nodiscard]] std::uint64_t owner(std::size_t i) const { return i < first_wire() ? soup_.triangles[i].facet : input_.facets.size() + i; }
    void describe(std::size_t i, const Vec3& where, std::vector<ElementRef>& elements, std::string& text) const;

    const CleanInput& input_;
    const Soup& soup_;
    const EdgeTable& edges_;
    Report& report_;
    const Checkpoint& checkpoint_;
    std::vector<VertexId> lone_;
    std::vector<Box> boxes_;
    std::unordered_set<std::uint64_t> seen_;
    std::size_t listed_ = 0;
};

/// An edge of some triangles against the triangles that share no end with it.
void IntersectionFinder::test_edge(std::size_t edge, const BoxTree& tree) {
    const auto ends = edge_ends(edges_.keys[edge]);
    const auto around = edges_.around(edge);
    Box box;
    box.add(point(ends[0]));
    box.add(point(ends[1]));
    const SegmentClipper line(point(ends[0]), point(ends[1]));
    tree.query([&](const Box& b) { return b.meets(box) && line.meets(b); },
               [&](std::uint32_t t) {
                   if (t >= first_wire()) return;
                   const auto& v = soup_.triangles[t].v;
                   for (const VertexId end : ends)
                       if (end == v[0] || end == v[1] || end == v[2]) return;
                   // one facet's triangles are disjoint in its projection
                   if (std::all_of(around.begin(), around.end(), [&](std::uint32_t c) { return owner(c / 3) == owner(t); })) return;
                   if (const auto where = contact(segment(ends), triangle(t)))
                       for (const std::uint32_t c : around) add(c / 3, t, *where);
               });
}

/// @pre i is a wire or a lone vertex and j comes before it, so that j has at least as many corners.
void IntersectionFinder::test_wire_or_vertex(std::uint32_t i, std::uint32_t j) {
    if (i < first_lone()) {
        if (const auto where = j < first_wire() ? contact(wire(i), triangle(j)) : contact(wire(i), wire(j))) add(j, i, *where);
        return;
    }
    const Vec3& p = point(vertex(i, 0));
    if (j < first_wire() ? is_on(p, triangle(j).p) : j < first_lone() && is_on(p, wire(j).p)) add(j, i, p);
}

/// Triangles at one edge: folded onto each other, or with the same corners.
void IntersectionFinder::test_folds(std::size_t edge) {
    const auto around = edges_.around(edge);
    for (std::size_t i = 0; i < around.size(); ++i)
        for (std::size_t j = i + 1; j < around.size() && !full(); ++j) {
            const std::uint32_t s = around[i] / 3, t = around[j] / 3;
            if (owner(s) == owner(t)) continue;
            if (const auto where = contact(triangle(s), triangle(t))) add(s, t, *where);
        }
}

void IntersectionFinder::add(std::size_t i, std::size_t j, const Vec3& where) {
    const std::uint64_t a = owner(i), b = owner(j);
    if (a == b || full() || !seen_.insert(std::min(a, b) << 32 | std::max(a, b)).second) return;
    ++listed_;
    std::vector<ElementRef> elements;
    std::string first, second;
    describe(i, where, elements, first);
    describe(j, where, elements, second);
    std::vector<Vec3> ends{where};
    if (i < first_wire() && j < first_wire()) {
        const auto [from, to] = contact_ends(triangle(i), triangle(j));
        ends = {from, to};
        if (from == to) ends.pop_back();
    }
    const std::string place = ends.size() == 2 ? fmt::format("from {} to {}", format_point(ends[0]), format_point(ends[1])) : "at " + format_point(ends[0]);
    report_.add(DefectKind::self_intersection, Severity::error, std::move(elements), fmt::format("{} and {} meet {}", first, second, place), 0, std::move(ends));
}

void IntersectionFinder::describe(std::size_t i, const Vec3& where, std::vector<ElementRef>& elements, std::string& text) const {
    if (i < first_wire()) {
        const std::uint32_t source = input_.facets[soup_.triangles[i].facet].source;
        elements.push_back(report_.facet(source, where));
        text = report_.name_facet(source);
        return;
    }
    for (std::size_t k = 0; k < corners(i); ++k) {
        const std::uint32_t source = input_.source_vertex[vertex(i, k).index()];
        elements.push_back(report_.vertex(source));
        text += (k == 0 ? (corners(i) == 2 ? "the segment from " : "") : " to ") + report_.name_vertex(source);
    }
}

}  // namespace

void find_intersections(const CleanInput& input, const Soup& soup, const EdgeTable& edges, Report& report, const Checkpoint& checkpoint) {
    IntersectionFinder(input, soup, edges, report, checkpoint).run();
}

}  // namespace wellmesh
