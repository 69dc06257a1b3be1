// SPDX-License-Identifier: Apache-2.0
// How far rounding may have moved the vertices of an input off the planes and lines that they were meant for.
#pragma once

#include <limits>
#include <optional>

namespace wellmesh {

/// All distances in input units. The error of a coordinate scales with the largest coordinate, not with its own size: a rotated or
/// shifted vertex near the origin still carries the rounding of the numbers that it was computed from.
struct Rounding {
    /// 16 ulp of the largest coordinate. A rotation costs at most about 6 ulp a coordinate (ten operations, most of them on partial
    /// results smaller than the sum), sqrt(3) of that in space; the rest pays for a plane fitted by least squares instead of minimax.
    static constexpr double kUlps = 16;
    /// A facet that the source states is accepted up to 1024 ulp: solid modellers compute vertices by long chains of doubles (models
    /// with 40 ulp are common), and an error is worse than a facet that is tilted by 2e-13 of the model and says so.
    static constexpr double kStatedUlps = 1024;

    double largest_coordinate = 0;
    double relative = 0;                   ///< Plc::relative_rounding
    std::optional<double> override_with{}; ///< MeshOptions::coplanar_tolerance

    [[nodiscard]] double ulps(double n) const { return n * std::numeric_limits<double>::epsilon() * largest_coordinate; }
    /// Rounding of the source before the coordinates became doubles: sqrt(3) in space, 2 for least squares.
    [[nodiscard]] double source() const { return 3.5 * relative * largest_coordinate; }
    /// Distance from one plane within which neighbouring facets are merged.
    [[nodiscard]] double merging() const { return override_with.value_or(ulps(kUlps) + source()); }
    /// Distance from its plane within which a stated facet is accepted.
    [[nodiscard]] double accepting() const { return override_with.value_or(ulps(kStatedUlps) + source()); }
    /// Distance within which a vertex of a facet lies on an edge of the same facet.
    [[nodiscard]] double on_edge() const { return ulps(kUlps) + source(); }
    /// Distance that doubles cannot tell from contact: the rounding of one computed vertex, without any slack.
    [[nodiscard]] double contact() const { return ulps(4); }
    /// Distance that may be nothing but rounding, of the source or of a computed vertex: both of two vertices that were one may be off.
    [[nodiscard]] double closing() const { return contact() + 2 * override_with.value_or(source()); }
};

}  // namespace wellmesh
