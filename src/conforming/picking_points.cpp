// SPDX-License-Identifier: Apache-2.0
// Additive recurrence with the generalised golden ratios [Roberts18], rejected to the ball; shifted by a key so that equal shapes
// don't get equal points.
#include "conforming/boundary_refiner.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh {
namespace {

double fraction(double x) { return x - static_cast<double>(static_cast<std::int64_t>(x)); }

}  // namespace

PickingPoints::PickingPoints(unsigned dimension, std::uint64_t key)
    : dimension_(dimension), start_{unit_double(mix64(key, 1)), unit_double(mix64(key, 2)), unit_double(mix64(key, 3))} {}

Vec3 PickingPoints::next() {
    // 1 / phi_d^i with phi_d the root of x^(d+1) = x + 1: 1.618.., 1.3247.., 1.2207..
    static constexpr double kStep[3][3] = {{0.6180339887498949, 0, 0}, {0.7548776662466927, 0.5698402909980532, 0},
                                           {0.8191725133961645, 0.6710436067037893, 0.5497004779019703}};
    const double* step = kStep[dimension_ - 1];
    while (true) {
        ++index_;
        Vec3 p{2 * fraction(start_[0] + index_ * step[0]) - 1, 0, 0};
        if (dimension_ > 1) p.y = 2 * fraction(start_[1] + index_ * step[1]) - 1;
        if (dimension_ > 2) p.z = 2 * fraction(start_[2] + index_ * step[2]) - 1;
        if (squared_norm(p) <= 1) return p;
    }
}

Vec3 picking_point(unsigned dimension, std::uint64_t key, unsigned k) {
    PickingPoints points(dimension, key);
    Vec3 p{};
    for (unsigned i = 0; i < k; ++i) p = points.next();
    return p;
}

}  // namespace wellmesh
