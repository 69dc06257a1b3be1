// SPDX-License-Identifier: Apache-2.0
#include "predicates/ladder.hpp"

namespace wellmesh {

Decision decide_orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { return climb<Orient3dFormula>({&b, &c, &d}, a); }

Sign orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { return decide_orient3d(a, b, c, d).sign; }

Decision decide_orient3d(const PredicateFilter& filter, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const double value = PredicateFilter::orient3d_value(a, b, c, d);
    if (value > filter.orient3d_bound()) return {Sign::positive, Rung::static_filter};
    if (value < -filter.orient3d_bound()) return {Sign::negative, Rung::static_filter};
    return decide_orient3d(a, b, c, d);
}

std::optional<Sign> orient3d_rung(Rung rung, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return single_rung<Orient3dFormula>(rung, {&b, &c, &d}, a);
}

}  // namespace wellmesh
