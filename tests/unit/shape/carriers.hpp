// SPDX-License-Identifier: Apache-2.0
// Do vertices stand where their carriers are?
#pragma once

#include <limits>
#include <string>

#include <fmt/format.h>

#include "support/staged_mesh.hpp"

namespace wellmesh::testing {

/// Empty, or the first vertex that is off its carrier: input vertices bit for bit, the others within `ulps` of the largest coordinate.
inline std::string off_carrier(const StagedMesh& staged, double ulps) {
    const ConformingMesh& mesh = staged.mesh;
    const double slack = ulps * std::numeric_limits<double>::epsilon() * staged.largest_coordinate();
    for (std::size_t i = 0; i < staged.plc.vertices.size(); ++i)
        if (!mesh.triangulation().is_inserted(VertexId{i})) return fmt::format("input vertex {} is gone", i);
    for (std::size_t i = 0; i < mesh.vertex_slots(); ++i) {
        const VertexId v{i};
        if (!mesh.triangulation().is_inserted(v)) continue;
        const VertexInfo& info = mesh.info(v);
        const Vec3& p = mesh.point(v);
        bool on = true;
        if (info.carrier == CarrierKind::input_vertex) {
            on = p == staged.plc.vertices[info.carrier_id];
        } else if (info.carrier == CarrierKind::facet) {
            const ValidFacet& f = staged.plc.facets[info.carrier_id];
            on = std::abs(dot(p - f.origin, f.normal)) <= slack;
        } else if (info.carrier == CarrierKind::segment) {
            const auto& ends = staged.plc.segments[info.carrier_id].ends;
            const Vec3 &a = staged.plc.vertices[ends[0].index()], &b = staged.plc.vertices[ends[1].index()];
            on = norm(cross(p - a, b - a)) / distance(a, b) <= slack && dot(p - a, b - a) > 0 && dot(p - b, a - b) > 0;
        }
        if (!on) return fmt::format("vertex {} at ({}, {}, {}) is off its carrier {} {}", i, p.x, p.y, p.z, static_cast<int>(info.carrier), info.carrier_id);
    }
    return {};
}

}  // namespace wellmesh::testing
