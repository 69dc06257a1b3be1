// SPDX-License-Identifier: Apache-2.0
// What size a tetrahedron may have.
#pragma once

#include <limits>
#include <vector>

#include "validation/valid_plc.hpp"
#include "wellmesh/options.hpp"

namespace wellmesh {

/// Circumradius bound for a target edge length h: with R <= this * h everywhere the mean edge length of a cube, seeded or not, is h within
/// 10 % (measured from 1k to 200k tetrahedra; tests/unit/refinement/sizing_test.cpp).
inline constexpr double kCircumradiusPerEdgeLength = 0.70;

/// Moving vertices may let circumradii exceed the bound by this factor (docs/decisions/0010).
inline constexpr double kSizeTolerance = 1.2;

/// Bounds of one cell; infinite where nothing is asked.
struct CellSize {
    double max_squared_circumradius = std::numeric_limits<double>::infinity();
    double max_volume = std::numeric_limits<double>::infinity();
};

inline std::vector<CellSize> cell_sizes(const ValidPlc& plc, const SizeGoals& goals) {
    std::vector<CellSize> out(plc.cells.size());
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (goals.edge_length) out[i].max_squared_circumradius = kCircumradiusPerEdgeLength * kCircumradiusPerEdgeLength * *goals.edge_length * *goals.edge_length;
        if (goals.max_volume) out[i].max_volume = *goals.max_volume;
        if (plc.cells[i].max_volume > 0) out[i].max_volume = std::min(out[i].max_volume, plc.cells[i].max_volume);
    }
    return out;
}

}  // namespace wellmesh
