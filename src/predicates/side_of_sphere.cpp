// SPDX-License-Identifier: Apache-2.0
// Both formulas are negative inside; the predicates are positive inside.
#include "predicates/ladder.hpp"

namespace wellmesh {

Decision decide_side_of_diametral_sphere(const Vec3& a, const Vec3& b, const Vec3& p) {
    return negated(climb<DiametralFormula>({&a, &b}, p));
}
Decision decide_side_of_equatorial_sphere(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
    return negated(climb<EquatorialFormula>({&b, &c, &p}, a));
}

Sign side_of_diametral_sphere(const Vec3& a, const Vec3& b, const Vec3& p) { return decide_side_of_diametral_sphere(a, b, p).sign; }
Sign side_of_equatorial_sphere(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
    return decide_side_of_equatorial_sphere(a, b, c, p).sign;
}

std::optional<Sign> diametral_rung(Rung rung, const Vec3& a, const Vec3& b, const Vec3& p) {
    return negated(single_rung<DiametralFormula>(rung, {&a, &b}, p));
}
std::optional<Sign> equatorial_rung(Rung rung, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
    return negated(single_rung<EquatorialFormula>(rung, {&b, &c, &p}, a));
}

}  // namespace wellmesh
