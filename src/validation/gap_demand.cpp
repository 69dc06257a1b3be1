// SPDX-License-Identifier: Apache-2.0
#include "validation/gap_demand.hpp"

#include <atomic>
#include <cmath>
#include <vector>

#include "validation/box_tree.hpp"
#include "validation/closest_points.hpp"

namespace wellmesh {
namespace {

/// The middle of a facet may be beside a gap though its corners are not. An eighth of its size is looked at; the facet across a smaller gap has
/// corners there.
constexpr Halvings kThorough{6, 8};
constexpr std::size_t kVerticesAPiece = 32, kSegmentsAPiece = 64;

/// Gaps at least so wide take no more than `enough` vertices, whatever is beside them: at no point of the boundary, wherever it is, are two features without a common
/// point within half of the least gap.
double width_that_takes(double enough, const ValidPlc& plc) {
    double area = 0, length = 0;
    for (const ValidFacet& f : plc.facets)
        for (const auto& t : f.triangles) {
            const Vec3 &a = plc.vertices[t[0].index()], &b = plc.vertices[t[1].index()], &c = plc.vertices[t[2].index()];
            area += 0.5 * norm(cross(b - a, c - a));
        }
    for (const ValidSegment& s : plc.segments) length += distance(plc.vertices[s.ends[0].index()], plc.vertices[s.ends[1].index()]);
    // vertices_beside_facet(area, w) + vertices_beside_segment(length, w) = enough, which is quadratic in 1 / w.
    const double square = vertices_beside_facet(area, 1), linear = vertices_beside_segment(length, 1);
    return 2 * (linear + std::sqrt(linear * linear + 4 * enough * square)) / (2 * enough);
}

/// Are there two features without a common point that are nearer to each other than `limit`? They are nearest to each other at a vertex of one, or between two segments.
bool has_gap_within(double limit, const ValidPlc& plc, const LocalFeatureSize& size, Workers& workers) {
    std::atomic<bool> found{false};
    workers.for_ranges(plc.vertices.size(), kVerticesAPiece, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t v = begin; v < end && !found.load(std::memory_order_relaxed); ++v)
            if (!(size(plc.vertices[v]) >= limit)) found = true;
    });
    if (found) return true;
    std::vector<Box> boxes(plc.segments.size());
    const auto end_of = [&](std::size_t s, unsigned k) -> const Vec3& { return plc.vertices[plc.segments[s].ends[k].index()]; };
    for (std::size_t s = 0; s < boxes.size(); ++s)
        for (const unsigned k : {0U, 1U}) boxes[s].add(end_of(s, k));
    const BoxTree tree(boxes, workers);
    workers.for_ranges(boxes.size(), kSegmentsAPiece, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t s = begin; s < end && !found.load(std::memory_order_relaxed); ++s) {
            const std::array<VertexId, 2>& ends = plc.segments[s].ends;
            tree.query([&, reach = boxes[s].grown(limit)](const Box& box) { return box.meets(reach); }, [&](std::uint32_t t) {
                const auto& [c, d] = plc.segments[t].ends;
                if (t <= s || ends[0] == c || ends[0] == d || ends[1] == c || ends[1] == d) return;
                const ClosestPair closest = closest_between({end_of(s, 0), end_of(s, 1)}, {end_of(t, 0), end_of(t, 1)});
                if (!(distance(closest.on_first, closest.on_second) >= limit)) found = true;
            });
        }
    });
    return found;
}

}  // namespace

bool gaps_take_more_than(double enough, const ValidPlc& plc, Workers& workers) {
    const LocalFeatureSize size(plc);
    return has_gap_within(width_that_takes(enough, plc), plc, size, workers) && vertices_for_gaps(plc, enough, workers) > enough;
}

double vertices_for_gaps(const ValidPlc& plc, double enough, Workers& workers) {
    constexpr std::size_t kAtFirst = 8;
    const LocalFeatureSize size(plc);
    std::vector<double> at_vertex(plc.vertices.size());
    workers.for_ranges(at_vertex.size(), kVerticesAPiece, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t v = begin; v < end; ++v) at_vertex[v] = size(plc.vertices[v]);
    });
    double sum = 0;
    // Of some at once, and of twice as many then: there may be a lot less to look at than all.
    const auto add = [&](std::size_t count, const auto& vertices_of) {
        std::vector<double> vertices;
        for (std::size_t first = 0, at_once = kAtFirst; first < count && sum <= enough; first += vertices.size(), at_once *= 2) {
            vertices.assign(std::min(at_once, count - first), 0);
            workers.for_each(vertices.size(), [&](std::size_t i) { vertices[i] = vertices_of(first + i); });
            for (const double v : vertices) sum += v;
        }
    };
    std::vector<std::array<VertexId, 3>> triangles;
    for (const ValidFacet& f : plc.facets) triangles.insert(triangles.end(), f.triangles.begin(), f.triangles.end());
    add(triangles.size(), [&](std::size_t i) {
        const auto& t = triangles[i];
        const std::array<Vec3, 3> corners{plc.vertices[t[0].index()], plc.vertices[t[1].index()], plc.vertices[t[2].index()]};
        double vertices = 0;
        sample_gap(size, corners, {at_vertex[t[0].index()], at_vertex[t[1].index()], at_vertex[t[2].index()]},
                   [&](double area, double width) { vertices += vertices_beside_facet(area, width); }, kThorough, kSlender);
        return vertices;
    });
    add(plc.segments.size(), [&](std::size_t i) {
        const auto& ends = plc.segments[i].ends;
        const Vec3 &a = plc.vertices[ends[0].index()], &b = plc.vertices[ends[1].index()];
        const double whole = distance(a, b);
        double vertices = 0;
        sample_gap(size, std::array{a, b}, std::array{at_vertex[ends[0].index()], at_vertex[ends[1].index()]}, [&](double length, double width) {
            if (whole > kSlender * width) vertices += vertices_beside_segment(length, width);
        });
        return vertices;
    });
    return sum;
}

}  // namespace wellmesh
