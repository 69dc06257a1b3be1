// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include "delaunay/spatial_order.hpp"
#include "delaunay/triangulation.hpp"
#include "predicates/exact_range.hpp"
#include "wellmesh/delaunay.hpp"
#include "wellmesh/error.hpp"

namespace wellmesh {

DelaunayResult triangulate_points(std::span<const Vec3> points) {
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
    const std::vector<std::uint32_t> order = biased_spatial_order(points);
    if (!mesh.insert_all_in_order(points, order)) throw MeshError(ErrorCode::bad_input, Stage::delaunay, "all points lie in one plane: there is no tetrahedron");
    result.duplicates = mesh.duplicate_count();
    const TetStore& tets = mesh.tets();
    std::size_t count = 0;
    for (std::size_t i = 0; i < tets.slots(); ++i) count += tets.is_finite(TetId{i});
    result.mesh.tets.reserve(count);
    for (std::size_t i = 0; i < tets.slots(); ++i) {
        const TetId t{i};
        if (!tets.is_finite(t)) continue;
        const auto& c = tets.corners(t);
        result.mesh.tets.push_back({order[c[0].index()], order[c[1].index()], order[c[2].index()], order[c[3].index()]});
    }
    result.mesh.tet_regions.assign(count, 1);
    result.mesh.vertices.assign(points.begin(), points.end());
    return result;
}

}  // namespace wellmesh
