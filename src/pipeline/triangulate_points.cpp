// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include "core/huge_pages.hpp"
#include "core/workers.hpp"
#include "delaunay/canonical_order.hpp"
#include "delaunay/spatial_order.hpp"
#include "delaunay/triangulation.hpp"
#include "predicates/exact_range.hpp"
#include "wellmesh/delaunay.hpp"
#include "wellmesh/error.hpp"

namespace wellmesh {

DelaunayResult triangulate_points(std::span<const Vec3> points, unsigned threads) {
    DelaunayResult result;
    if (points.size() < 4) throw MeshError(ErrorCode::bad_input, Stage::delaunay, fmt::format("{} points: at least four are needed", points.size()));
    Vec3 lo = points[0], hi = points[0];
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3& p = points[i];
        if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)))
            throw MeshError(ErrorCode::bad_input, Stage::delaunay, fmt::format("point {} is not finite", i + 1), {{EntityKind::vertex, i + 1, p}});
        if (!in_exact_range(p))
            throw MeshError(ErrorCode::coordinate_range, Stage::delaunay,
                            fmt::format("point {} ({}, {}, {}) is outside the range {} to {} in which the predicates are exact", i + 1, p.x, p.y, p.z, kMinMagnitude, kMaxMagnitude),
                            {{EntityKind::vertex, i + 1, p}});
        lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
        hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
    }
    Triangulation mesh(lo, hi);
    Workers workers(threads);
    const std::vector<std::uint32_t> order = biased_spatial_order(points, workers);
    if (!mesh.insert_all_in_order(points, order, workers)) throw MeshError(ErrorCode::bad_input, Stage::delaunay, "all points lie in one plane: there is no tetrahedron");
    result.duplicates = mesh.duplicate_count();
    visit_in_canonical_order<false>(
        mesh.tets(), mesh.vertex_count(), workers,
        [&](std::size_t n) {
            reserve_on_huge_pages(result.mesh.tets, n, workers);
            result.mesh.tets.resize(n);
        },
        [&](std::size_t place, TetId, const TetStore::Corners& c) {
            result.mesh.tets[place] = {order[c[0].index()], order[c[1].index()], order[c[2].index()], order[c[3].index()]};
        },
        mesh.take_scratch());
    mesh = Triangulation();  // before there is more to hold
    reserve_on_huge_pages(result.mesh.tet_regions, result.mesh.tets.size(), workers);
    result.mesh.tet_regions.assign(result.mesh.tets.size(), 1);
    reserve_on_huge_pages(result.mesh.vertices, points.size(), workers);
    result.mesh.vertices.assign(points.begin(), points.end());
    return result;
}

}  // namespace wellmesh
