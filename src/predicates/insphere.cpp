// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstddef>

#include "core/vec3_math.hpp"
#include "predicates/ladder.hpp"

namespace wellmesh {
namespace {

/// The sign of the perturbed insphere where the unperturbed one is zero.
///
/// Let o(p, q, r, s) = det(q - p, r - p, s - p) and let l_i be the lift of point i. Insphere is linear in the lifts:
///   I = l_a o(e,b,c,d) + l_b o(a,e,c,d) + l_c o(a,b,e,d) + l_d o(a,b,c,e) - l_e o(a,b,c,d),
/// a corner's coefficient being the tetrahedron with e in its place (compare InsphereFormula: o(e,b,c,d) = [bcd],
/// o(a,e,c,d) = -[acd], ...), and e's sign being plain: lifting e takes it out of the sphere of a positive tetrahedron.
/// Adding eps_i to l_i makes I a polynomial in the eps, whose sign is that of the non-zero coefficient of the largest eps:
/// walk from the lexicographically largest point down. When a, b, c, d is not flat the walk ends at e at the latest.
/// It ends at the second step even: were the coefficients of two corners, a and b say, both zero, e would lie in the planes
/// ecd + b and ecd + a, hence on line cd, and, being on the sphere, would be c or d.
Sign break_tie(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) {
    std::array<const Vec3*, 5> rest{&a, &b, &c, &d, &e};
    for (std::size_t n = rest.size(); n > 0; --n) {  // mostly leaves in the first round: no need to sort
        std::size_t at = 0;
        for (std::size_t i = 1; i < n; ++i)
            if (lexicographically_less(*rest[at], *rest[i])) at = i;
        const Vec3* largest = rest[at];
        rest[at] = rest[n - 1];
        Sign sign = Sign::zero;
        if (largest == &a) sign = orient3d(e, b, c, d);
        else if (largest == &b) sign = orient3d(a, e, c, d);
        else if (largest == &c) sign = orient3d(a, b, e, d);
        else if (largest == &d) sign = orient3d(a, b, c, e);
        else sign = -orient3d(a, b, c, d);
        if (sign != Sign::zero) return sign;
    }
    return Sign::zero;  // a, b, c, d and e are coplanar
}

}  // namespace

Decision decide_insphere(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) {
    return climb<InsphereFormula>({&a, &b, &c, &d}, e);
}

Sign insphere(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) { return decide_insphere(a, b, c, d, e).sign; }

Sign insphere_perturbed(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) {
    const Sign sign = insphere(a, b, c, d, e);
    return sign != Sign::zero ? sign : break_tie(a, b, c, d, e);
}

Decision decide_insphere(const PredicateFilter& filter, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) {
    const double value = PredicateFilter::insphere_value(a, b, c, d, e);
    if (value > filter.insphere_bound()) return {Sign::positive, Rung::static_filter};
    if (value < -filter.insphere_bound()) return {Sign::negative, Rung::static_filter};
    return decide_insphere(a, b, c, d, e);
}

Decision decide_insphere_perturbed(const PredicateFilter& filter, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) {
    const Decision decision = decide_insphere(filter, a, b, c, d, e);
    if (decision.sign != Sign::zero) return decision;
    return {break_tie(a, b, c, d, e), Rung::perturbation};
}

std::optional<Sign> insphere_rung(Rung rung, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) {
    return single_rung<InsphereFormula>(rung, {&a, &b, &c, &d}, e);
}

}  // namespace wellmesh
