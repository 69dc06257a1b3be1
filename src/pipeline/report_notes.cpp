// SPDX-License-Identifier: Apache-2.0
#include "pipeline/report_notes.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace wellmesh {

void note_input(MeshResult& result, const MeshOptions& options, const Plc& plc, const ValidPlc& valid) {
    std::vector<std::string>& notes = result.statistics.notes;
    std::size_t acute = 0;
    const Defect* sharpest = nullptr;
    for (const Defect& d : valid.diagnosis.defects) {
        if (d.kind != DefectKind::acute_segment_angle && d.kind != DefectKind::acute_dihedral_angle) {
            notes.push_back(d.message);
            continue;
        }
        ++acute;
        if (!sharpest || d.value < sharpest->value) sharpest = &d;
    }
    if (acute > 1) notes.push_back(fmt::format("{} input angles are below 90 degrees; the sharpest: {}", acute, sharpest->message));
    else if (acute == 1) notes.push_back(sharpest->message);
    if (options.size.vertex_sizes && std::any_of(plc.vertex_sizes.begin(), plc.vertex_sizes.end(), [](double h) { return h > 0; }))
        notes.emplace_back("the input states sizes at its vertices, which count");
}

std::string describe(const GapStatistics& gaps) {
    const auto name = [](const ElementRef& side) { return fmt::format("{} {}", to_string(side.kind), side.number); };
    const Vec3 p = gaps.side.where.value_or(Vec3{});
    return fmt::format("{} and {} are {:.4g} apart near ({}, {}, {}): filling gaps so narrow would take about {:.0e} vertices, so {} tetrahedra that join their sides stay below the goals",
                       name(gaps.side), name(gaps.other_side), gaps.width, p.x, p.y, p.z, gaps.vertices, gaps.tets);
}

void note_lower_angle(MeshResult& result) {
    const double now = result.certificate.all.min_dihedral_angle_deg;
    if (!result.statistics.given || now >= result.statistics.given->min_dihedral_angle_deg * (1 - 1e-9)) return;
    result.statistics.notes.push_back(
        fmt::format("the smallest dihedral angle has gone from {:.4g} to {:.4g} degrees: the mesh had to be triangulated or refined anew, and the goal is lower",
                    result.statistics.given->min_dihedral_angle_deg, now));
}

}  // namespace wellmesh
