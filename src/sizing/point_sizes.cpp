// SPDX-License-Identifier: Apache-2.0
#include "sizing/point_sizes.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/infinity.hpp"
#include "wellmesh/error.hpp"

namespace wellmesh {
PointSizes::PointSizes(const ValidPlc& plc, const SizeGoals& goals, const std::vector<double>& vertex_sizes) : goals_(goals) {
    if (goals.per_local_feature_size) lfs_ = std::make_unique<const LocalFeatureSize>(plc);
    std::vector<Vec3> points;
    std::vector<double> sizes;
    for (std::size_t v = 0; v < vertex_sizes.size(); ++v)
        if (vertex_sizes[v] < kInfinity) {
            points.push_back(plc.vertices[v]);
            sizes.push_back(vertex_sizes[v]);
        }
    // All of them, as TetGen's files state them: then sizes between them are meant as well. A single vertex's is its own.
    if (goals.vertex_sizes && !plc.vertex_sizes.empty() && points.size() == plc.vertices.size()) {
        between_vertices_ = std::make_unique<const BackgroundMesh>(triangulate_sizes(points, sizes));
        nodal_.push_back(std::make_unique<const NodalSizes>(*between_vertices_));
    }
    if (goals.background) {
        nodal_.push_back(std::make_unique<const NodalSizes>(*goals.background));
        probes_ = goals.background->mesh.vertices;
    }
    probes_.insert(probes_.end(), plc.vertices.begin(), plc.vertices.end());
}

double PointSizes::operator()(const Vec3& p) const {
    double size = kInfinity;
    if (goals_.at) {
        size = goals_.at(p);
        const double least = goals_.min_edge_length.value_or(0);
        // With a smallest size anything below it is as good, 0 at the very point that a field is about included.
        if (!(size > 0 || (size >= 0 && least > 0)))
            throw MeshError(ErrorCode::bad_options, Stage::refine,
                            fmt::format("the size callback says {} at ({}, {}, {}); it must be above 0, or infinite for none", size, p.x, p.y, p.z), {{EntityKind::vertex, 0, p}});
    }
    if (lfs_) size = std::min(size, *goals_.per_local_feature_size * (*lfs_)(p));
    for (const auto& sizes : nodal_) size = std::min(size, (*sizes)(p));
    return size;
}

}  // namespace wellmesh
