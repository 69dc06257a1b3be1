// SPDX-License-Identifier: Apache-2.0
#include "pipeline/exudation_bounds.hpp"

#include <algorithm>

namespace wellmesh {

ExudationBounds exudation_bounds(const MeshOptions& options, const ValidPlc& plc, const SizeField& sizes) {
    ExudationBounds bounds;
    bounds.max_radius_edge_ratio = options.quality.max_radius_edge_ratio;
    const double slack = kSizeTolerance * kSizeTolerance;
    for (std::size_t c = 0; c < plc.cells.size(); ++c) {
        ExudationBounds::Size& size = bounds.size_of_region[plc.cells[c].region];
        size.max_squared_circumradius = std::min(size.max_squared_circumradius, slack * sizes.of_cell(CellId{c}).max_squared_circumradius);
        size.max_volume = std::min(size.max_volume, sizes.of_cell(CellId{c}).max_volume);
    }
    if (sizes.varies()) bounds.max_squared_circumradius_at = [&sizes, slack](const Vec3& p) { return slack * sizes.at(p, CellId{0}).max_squared_circumradius; };
    return bounds;
}

}  // namespace wellmesh
