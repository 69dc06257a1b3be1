// SPDX-License-Identifier: Apache-2.0
// Shape measures of several tetrahedra at once, squared, so that neither roots nor arctangents are needed to tell which are worth a closer look.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "wellmesh/vec3.hpp"

namespace wellmesh {

inline constexpr std::size_t kShapeLanes = 16;
using ShapeLane = std::array<double, kShapeLanes>;

/// Corners a, b, c, d of each tetrahedron, by coordinates.
struct CornerLanes {
    alignas(64) std::array<std::array<ShapeLane, 3>, 4> at;
};

/// Of positive tetrahedra; of others only the volumes mean something.
struct SquaredShapes {
    alignas(64) ShapeLane six_volumes;                  ///< signed; bit by bit those of six_volumes()
    alignas(64) ShapeLane shortest_edge, radius_edge, sigma;  ///< squares of TetShape's
    alignas(64) ShapeLane longest_edge;                       ///< squared
    alignas(64) ShapeLane scaled_radius;                ///< square of circumradius times twelve volumes
    alignas(64) std::array<ShapeLane, 4> areas;         ///< squares of twice the faces' areas
    /// c |c| for the largest and the smallest cosine c of a dihedral angle: of the smallest and the largest angle.
    alignas(64) ShapeLane largest_cosine, smallest_cosine;
};

/// What is asked of lanes is asked so much more strictly that they can be believed: far more than the 1e-12 below, and what the shortest edge of a needle is off by.
inline constexpr double kLaneSlack = 1e-9;

/// Within 1e-12 of what shape_of() says, relative to it, or absolute for the cosines, of tetrahedra for which this holds: nothing over- or underflows.
inline bool may_trust(const SquaredShapes& s, std::size_t lane) {
    return s.scaled_radius[lane] < 1e280 && s.shortest_edge[lane] > 1e-60 && s.six_volumes[lane] * s.six_volumes[lane] > 1e-200;
}
void square_shapes(const CornerLanes& corners, SquaredShapes& shapes) noexcept;
/// All that this processor can do it with, the one that needs nothing first: bit by bit the same. For tests.
using SquareShapes = void (*)(const CornerLanes&, SquaredShapes&) noexcept;
[[nodiscard]] std::vector<SquareShapes> ways_to_square_shapes();

/// Tetrahedra of a loop, which are measured as soon as there is one for each lane.
template <class Tet>
class ShapeBatch {
public:
    /// Calls use(tetrahedron, shapes, lane) for each of them, by and by.
    template <class Use>
    void add(const Tet& tet, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, Use&& use) {
        std::size_t k = 0;
        for (const Vec3* const p : {&a, &b, &c, &d}) {
            corners_.at[k][0][count_] = p->x, corners_.at[k][1][count_] = p->y, corners_.at[k][2][count_] = p->z;
            ++k;
        }
        tets_[count_] = tet;
        if (++count_ == kShapeLanes) finish(use);
    }
    /// For those that still wait. What is in the other lanes doesn't matter.
    template <class Use>
    void finish(Use&& use) {
        if (count_ == 0) return;
        square_shapes(corners_, shapes_);
        for (std::size_t lane = 0, count = std::exchange(count_, 0); lane < count; ++lane) use(tets_[lane], shapes_, lane);
    }

private:
    CornerLanes corners_{};
    SquaredShapes shapes_{};
    std::array<Tet, kShapeLanes> tets_{};
    std::size_t count_ = 0;
};

}  // namespace wellmesh
