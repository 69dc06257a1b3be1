// SPDX-License-Identifier: Apache-2.0
#include "validation/gap_demand.hpp"

#include <vector>

namespace wellmesh {
namespace {

/// The middle of a facet may be beside a gap though its corners are not. An eighth of its size is looked at; the facet across a smaller gap has
/// corners there.
constexpr Halvings kThorough{6, 8};

}  // namespace

double vertices_for_gaps(const ValidPlc& plc, double enough, Workers& workers) {
    constexpr std::size_t kGrain = 32, kAtFirst = 8;
    const LocalFeatureSize size(plc);
    std::vector<double> at_vertex(plc.vertices.size());
    workers.for_ranges(at_vertex.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
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
