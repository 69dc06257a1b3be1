// SPDX-License-Identifier: Apache-2.0
#include "pipeline/list_exemptions.hpp"

#include <algorithm>
#include <utility>

#include "quality/tet_shape.hpp"

namespace wellmesh {
namespace {

std::array<std::uint32_t, 4> sorted(std::array<std::uint32_t, 4> corners) {
    std::sort(corners.begin(), corners.end());
    return corners;
}

}  // namespace

std::vector<Exemption> list_exemptions(const ConformingMesh& mesh, const std::vector<TetId>& order, Refiner& refiner, const MeshOptions& options,
                                       std::uint32_t first_number) {
    std::vector<Exemption> out;
    const ValidPlc& plc = mesh.plc();
    if (plc.acute_features.empty()) return out;
    const QualityGoals& goals = options.quality;
    const double angle = std::max(goals.min_dihedral_angle_deg, goals.min_dihedral_boundary_deg.value_or(0));
    for (std::size_t i = 0; i < order.size(); ++i) {
        const auto& c = mesh.tets().corners(order[i]);
        const TetShape shape = shape_of(mesh.point(c[0]), mesh.point(c[1]), mesh.point(c[2]), mesh.point(c[3]));
        if (shape.radius_edge <= goals.max_radius_edge_ratio && shape.min_dihedral_deg >= angle) continue;
        const auto by = refiner.forced_by(order[i]);
        if (!by) continue;
        const bool segment = by->kind == EntityKind::segment;
        const Vec3 where = segment ? plc.vertices[plc.segments[by->id].ends[0].index()] : plc.vertices[by->id];
        out.push_back({i, {by->kind, segment ? by->id + 1U : plc.source_vertex[by->id] + first_number, where}, by->angle_deg});
    }
    return out;
}

ExemptionKeeper::ExemptionKeeper(const TetMesh& mesh, std::vector<Exemption> exemptions) {
    for (Exemption& e : exemptions) by_corners_.emplace(sorted(mesh.tets[e.tet]), std::move(e));
}

std::vector<Exemption> ExemptionKeeper::of(const TetMesh& mesh) const {
    std::vector<Exemption> out;
    if (by_corners_.empty()) return out;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const auto at = by_corners_.find(sorted(mesh.tets[t]));
        if (at == by_corners_.end()) continue;
        out.push_back(at->second);
        out.back().tet = t;
    }
    return out;
}

}  // namespace wellmesh
