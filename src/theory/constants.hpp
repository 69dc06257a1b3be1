// SPDX-License-Identifier: Apache-2.0
// The constants of [LiTeng01] and every inequality that its sections 4 and 5 ask of them.
#pragma once

#include <string>
#include <vector>

namespace wellmesh {

struct TheoryConstants {
    double delta = 0;   ///< radius of a picking region relative to the circumradius
    double b = 0;       ///< a created sliver is small below b times the circumradius of what was split
    double rho0 = 0;    ///< bound on circumradius / shortest edge
    double sigma0 = 0;  ///< bound on volume / shortest edge^3, below which a tetrahedron of bounded radius-edge ratio is a sliver
    [[nodiscard]] double alpha() const { return (1 + delta) / (1 - delta); }
};

/// All that is wrong with the constants, one sentence each: the inequality with its numbers, where the paper has it, and the range that would do.
/// NaN and infinities are wrong.
[[nodiscard]] std::vector<std::string> check(const TheoryConstants& constants);

/// Largest sigma0 that makes sense: V / L^3 of the regular tetrahedron, sqrt(2) / 12. Above it no tetrahedron of equal edges would pass.
inline constexpr double kLargestSigma = 0.11785113019775793;

/// D1 (segments), D2 (facets), D3 (inside) of Theorem 5.1: its closed form, which is the least solution of the inequalities (5.1)-(5.8).
/// Infinite where they have none.
struct DensityBounds {
    double d1 = 0, d2 = 0, d3 = 0;
    [[nodiscard]] double largest() const;
};
[[nodiscard]] DensityBounds density_bounds(const TheoryConstants& constants);
/// Do these satisfy (5.1)-(5.8), to a relative 1e-12? Names of those that fail.
[[nodiscard]] std::vector<std::string> unsatisfied(const DensityBounds& d, const TheoryConstants& constants);

/// The factor C of Lemma 5.1, e_v >= C e_parent. @pre 1 <= number <= 7
[[nodiscard]] double insertion_factor(unsigned number, const TheoryConstants& constants);

/// log10 of the sigma0 for which Theorem 4.1 proves that a point without new small slivers exists, from the volume, area and length
/// conditions with the corrections of docs/theory.md and the length variation bound of [Cheng00].
[[nodiscard]] double log10_existence_sigma(const TheoryConstants& constants);

}  // namespace wellmesh
