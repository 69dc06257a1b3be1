// SPDX-License-Identifier: Apache-2.0
// The static filter's arithmetic: the formulas over doubles. Included by predicates.hpp only.
#pragma once

#include "predicates/formulas.hpp"
#include "predicates/predicates.hpp"

namespace wellmesh {

inline Triple<double> rounded_difference(const Vec3& p, const Vec3& origin) { return {p.x - origin.x, p.y - origin.y, p.z - origin.z}; }

inline double PredicateFilter::orient3d_value(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return Orient3dFormula::value<double>({rounded_difference(b, a), rounded_difference(c, a), rounded_difference(d, a)});
}

inline double PredicateFilter::insphere_value(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) {
    return InsphereFormula::value<double>({rounded_difference(a, e), rounded_difference(b, e), rounded_difference(c, e), rounded_difference(d, e)});
}

inline double PredicateFilter::power_value(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& d,
                                           const WeightedPoint& e) {
    const auto difference = [&](const WeightedPoint& p) {
        return Quadruple<double>{p.point.x - e.point.x, p.point.y - e.point.y, p.point.z - e.point.z, p.weight - e.weight};
    };
    return PowerFormula::value<double>({difference(a), difference(b), difference(c), difference(d)});
}

}  // namespace wellmesh
