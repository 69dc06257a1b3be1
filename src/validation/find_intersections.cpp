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
constexpr std::size_t kMaxListed = 100000;

/// Triangles, then wires, then lone vertices, in one numbering.
class IntersectionFinder {
public:
    IntersectionFinder(const CleanInput& input, const Soup& soup, Report& report) : input_(input), soup_(soup), report_(report) {
        std::vector<char> used(input.points.size(), 0);
        for (const SoupTriangle& t : soup.triangles)
            for (const VertexId v : t.v) used[v.index()] = 1;
        for (const auto& w : soup.wires) used[w[0].index()] = used[w[1].index()] = 1;
        for (std::size_t v = 0; v < used.size(); ++v)
            if (!used[v]) lone_.emplace_back(v);
    }

    void run() {
        std::vector<Box> boxes(first_lone() + lone_.size());
        for (std::size_t i = 0; i < boxes.size(); ++i)
            for (std::size_t k = 0; k < corners(i); ++k) boxes[i].add(point(vertex(i, k)));
        const BoxTree tree(boxes);
        for (std::uint32_t i = 0; i < boxes.size() && listed_ < kMaxListed; ++i)
            tree.query([&](const Box& b) { return b.meets(boxes[i]); },
                       [&](std::uint32_t j) {
                           if (j > i) test(i, j);
                       });
        if (listed_ >= kMaxListed)
            report_.add(DefectKind::self_intersection, Severity::error, {}, fmt::format("there are more intersections than the {} listed", kMaxListed));
    }

private:
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
    [[nodiscard]] NamedSegment wire(std::size_t i) const {
        const auto& v = soup_.wires[i - first_wire()];
        return {{point(v[0]), point(v[1])}, {v[0].value(), v[1].value()}};
    }
    [[nodiscard]] std::optional<Vec3> meeting_point(std::size_t i, std::size_t j) const;
    void test(std::uint32_t i, std::uint32_t j);
    [[nodiscard]] std::uint64_t owner(std::size_t i) const { return i < first_wire() ? soup_.triangles[i].facet : input_.facets.size() + i; }
    void describe(std::size_t i, const Vec3& where, std::vector<ElementRef>& elements, std::string& text) const;

    const CleanInput& input_;
    const Soup& soup_;
    Report& report_;
    std::vector<VertexId> lone_;
    std::unordered_set<std::uint64_t> seen_;
    std::size_t listed_ = 0;
};

/// @pre i < j, so that i has at least as many corners.
std::optional<Vec3> IntersectionFinder::meeting_point(std::size_t i, std::size_t j) const {
    if (j < first_wire()) return contact(triangle(i), triangle(j));
    if (j < first_lone()) return i < first_wire() ? contact(wire(j), triangle(i)) : contact(wire(j), wire(i));
    const Vec3& p = point(vertex(j, 0));
    const bool on = i < first_wire() ? is_on(p, triangle(i).p) : i < first_lone() && is_on(p, wire(i).p);
    return on ? std::optional(p) : std::nullopt;
}

void IntersectionFinder::test(std::uint32_t i, std::uint32_t j) {
    const std::uint64_t a = owner(i), b = owner(j);
    if (a == b) return;  // one facet's triangles are disjoint in its projection
    const auto where = meeting_point(i, j);
    if (!where) return;
    if (!seen_.insert(std::min(a, b) << 32 | std::max(a, b)).second || listed_ >= kMaxListed) return;
    ++listed_;
    std::vector<ElementRef> elements;
    std::string first, second;
    describe(i, *where, elements, first);
    describe(j, *where, elements, second);
    report_.add(DefectKind::self_intersection, Severity::error, std::move(elements), fmt::format("{} and {} meet at {}", first, second, format_point(*where)));
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

void find_intersections(const CleanInput& input, const Soup& soup, Report& report) { IntersectionFinder(input, soup, report).run(); }

}  // namespace wellmesh
