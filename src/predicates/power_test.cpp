// SPDX-License-Identifier: Apache-2.0
// Predicates of weighted points. Both sphere formulas are negative in conflict; the predicates are positive there.
#include "predicates/ladder.hpp"

namespace wellmesh {
namespace {

using W = WeightedPoint;

}  // namespace

Decision decide_power_test(const W& a, const W& b, const W& c, const W& d, const W& e) { return climb<PowerFormula>({&a, &b, &c, &d}, e); }
Decision decide_diametral_power_test(const W& a, const W& b, const W& p) { return negated(climb<WeightedDiametralFormula>({&b, &p}, a)); }
Decision decide_equatorial_power_test(const W& a, const W& b, const W& c, const W& p) {
    return negated(climb<WeightedEquatorialFormula>({&b, &c, &p}, a));
}

Sign power_test(const W& a, const W& b, const W& c, const W& d, const W& e) { return decide_power_test(a, b, c, d, e).sign; }
Sign diametral_power_test(const W& a, const W& b, const W& p) { return decide_diametral_power_test(a, b, p).sign; }
Sign equatorial_power_test(const W& a, const W& b, const W& c, const W& p) { return decide_equatorial_power_test(a, b, c, p).sign; }

Decision decide_power_test(const PredicateFilter& filter, const W& a, const W& b, const W& c, const W& d, const W& e) {
    const double value = PredicateFilter::power_value(a, b, c, d, e);
    if (value > filter.power_bound()) return {Sign::positive, Rung::static_filter};
    if (value < -filter.power_bound()) return {Sign::negative, Rung::static_filter};
    return decide_power_test(a, b, c, d, e);
}

std::optional<Sign> power_rung(Rung rung, const W& a, const W& b, const W& c, const W& d, const W& e) {
    return single_rung<PowerFormula>(rung, {&a, &b, &c, &d}, e);
}
std::optional<Sign> diametral_power_rung(Rung rung, const W& a, const W& b, const W& p) {
    return negated(single_rung<WeightedDiametralFormula>(rung, {&b, &p}, a));
}
std::optional<Sign> equatorial_power_rung(Rung rung, const W& a, const W& b, const W& c, const W& p) {
    return negated(single_rung<WeightedEquatorialFormula>(rung, {&b, &c, &p}, a));
}

}  // namespace wellmesh
