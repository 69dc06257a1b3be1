// SPDX-License-Identifier: Apache-2.0
#include "quality/shape_statistics.hpp"

#include <algorithm>
#include <cstddef>

namespace wellmesh {

void ShapeAccumulator::add(const TetShape& shape) {
    ShapeStatistics& s = extremes_;
    if (s.tets++ == 0) {
        s.min_sigma = shape.sigma;
        s.min_dihedral_angle_deg = shape.min_dihedral_deg;
        s.min_volume = s.max_volume = shape.volume;
    }
    s.max_radius_edge_ratio = std::max(s.max_radius_edge_ratio, shape.radius_edge);
    s.max_aspect_ratio = std::max(s.max_aspect_ratio, shape.aspect);
    s.min_sigma = std::min(s.min_sigma, shape.sigma);
    s.min_dihedral_angle_deg = std::min(s.min_dihedral_angle_deg, shape.min_dihedral_deg);
    s.max_dihedral_angle_deg = std::max(s.max_dihedral_angle_deg, shape.max_dihedral_deg);
    s.min_volume = std::min(s.min_volume, shape.volume);
    s.max_volume = std::max(s.max_volume, shape.volume);
    const double bin = shape.min_dihedral_deg / 5;  // the negated comparison keeps NaN in bin 0
    ++s.min_dihedral_histogram[!(bin >= 1) ? 0 : std::min<std::size_t>(s.min_dihedral_histogram.size() - 1, static_cast<std::size_t>(bin))];
}

ShapeStatistics ShapeAccumulator::result() const { return extremes_; }

}  // namespace wellmesh
