// SPDX-License-Identifier: Apache-2.0
#include "pipeline/list_exemptions.hpp"

#include <algorithm>

#include "quality/tet_shape.hpp"

namespace wellmesh {

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

}  // namespace wellmesh
