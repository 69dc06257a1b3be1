// SPDX-License-Identifier: Apache-2.0
#include "validation/triangulate_facet.hpp"

#include <algorithm>

#include "validation/planar_triangulation.hpp"

namespace wellmesh {
namespace {

using Edge = std::array<std::uint32_t, 2>;

void insert_constraints(PlanarTriangulation& planar, std::span<const Edge> edges, double on_edge, FacetTriangulation& out) {
    std::vector<Edge> pending(edges.rbegin(), edges.rend());
    while (!pending.empty()) {
        const Edge e = pending.back();
        pending.pop_back();
        if (e[0] == e[1] || !planar.is_present(e[0]) || !planar.is_present(e[1])) continue;
        const auto obstacle = planar.insert_constraint(e[0], e[1], on_edge);
        if (obstacle.vertex) {
            out.splits.push_back({e, *obstacle.vertex});
            pending.push_back({*obstacle.vertex, e[1]});
            pending.push_back({e[0], *obstacle.vertex});
        } else if (obstacle.crossing) {
            out.crossings.push_back({e, *obstacle.crossing});
        } else {
            out.constraints.push_back({std::min(e[0], e[1]), std::max(e[0], e[1])});
        }
    }
    std::sort(out.constraints.begin(), out.constraints.end());
    out.constraints.erase(std::unique(out.constraints.begin(), out.constraints.end()), out.constraints.end());
}

void flood(const PlanarTriangulation& planar, std::uint32_t start, std::vector<char>& outside) {
    std::vector<std::uint32_t> stack{start};
    while (!stack.empty()) {
        const std::uint32_t t = stack.back();
        stack.pop_back();
        if (outside[t]) continue;
        outside[t] = 1;
        const auto& tri = planar.triangles()[t];
        for (unsigned i = 0; i < 3; ++i)
            if (!tri.fixed[i] && tri.neighbour[i] != PlanarTriangulation::kNone) stack.push_back(tri.neighbour[i]);
    }
}

}  // namespace

FacetTriangulation triangulate_facet(std::span<const Vec3> points, const PlaneProjection& projection, std::span<const Edge> edges,
                                     std::span<const Vec3> holes, double on_edge) {
    FacetTriangulation out;
    std::vector<Point2> flat;
    flat.reserve(points.size());
    for (const Vec3& p : points) flat.push_back(projection(p));
    PlanarTriangulation planar(flat);
    out.coincident = planar.coincident();
    if (planar.is_flat()) return out;
    insert_constraints(planar, edges, on_edge, out);
    planar.restore_delaunay();

    std::vector<char> outside(planar.triangles().size(), 0);
    for (std::uint32_t t = 0; t < planar.triangles().size(); ++t)
        for (unsigned i = 0; i < 3; ++i)
            if (planar.triangles()[t].neighbour[i] == PlanarTriangulation::kNone && !planar.triangles()[t].fixed[i]) flood(planar, t, outside);
    const std::vector<char> beyond = outside;
    for (std::size_t h = 0; h < holes.size(); ++h) {
        const std::uint32_t t = planar.locate(projection(holes[h]));
        if (t == PlanarTriangulation::kNone || beyond[t])
            out.idle_holes.push_back(h);
        else
            flood(planar, t, outside);
    }
    for (std::uint32_t t = 0; t < planar.triangles().size(); ++t)
        if (!outside[t]) out.triangles.push_back(planar.triangles()[t].v);
    return out;
}

}  // namespace wellmesh
