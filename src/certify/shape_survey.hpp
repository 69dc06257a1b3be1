// SPDX-License-Identifier: Apache-2.0
// One pass over the shapes of all tetrahedra: statistics, regions, and which exceed a bound.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "certify/suspect_mesh.hpp"
#include "certify/upper_edges.hpp"
#include "quality/tet_shape.hpp"
#include "wellmesh/certificate.hpp"

namespace wellmesh::certifying {

/// One bound: which value, which way, of which tetrahedra.
struct ShapeBound {
    enum class Where : std::uint8_t { everywhere, interior, boundary };
    std::optional<double> limit;
    bool upper = true;
    double TetShape::* value = nullptr;
    const char* words = "";
    Where where = Where::everywhere;

    [[nodiscard]] bool applies(bool boundary) const { return limit && (where == Where::everywhere || boundary == (where == Where::boundary)); }
    [[nodiscard]] bool kept(const TetShape& shape) const { return upper ? shape.*value <= *limit : shape.*value >= *limit; }
};

/// Positive tetrahedra only, but for the regions; nothing about edges.
struct ShapeSurvey {
    ShapeStatistics all, interior, boundary, unexempt, unexempt_interior, unexempt_boundary;
    std::vector<RegionVolume> regions;      ///< numbers and volumes of all tetrahedra, ascending
    std::vector<TetClass> classes;         ///< of all tetrahedra
    std::vector<ClaimBuilder> exceedances;  ///< of each bound, by tetrahedra that are not exempt
};

/// Extremes are within a rounding of the extreme; which tetrahedra keep a bound is decided by shape_of().
/// @param on_constraint  one flag a vertex: tetrahedra with such a corner are at the boundary. @param exempt  ascending.
[[nodiscard]] ShapeSurvey survey_shapes(const SuspectMesh& mesh, const std::vector<std::uint8_t>& on_constraint,
                                        const std::vector<ShapeBound>& bounds, const std::vector<std::uint64_t>& exempt);

}  // namespace wellmesh::certifying
