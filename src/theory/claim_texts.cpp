// SPDX-License-Identifier: Apache-2.0
#include "theory/claim_texts.hpp"

#include <limits>
#include <numbers>

namespace wellmesh {

std::array<InvariantClaim, static_cast<std::size_t>(ClaimId::count)> stated_claims(const TheoryConstants& c) {
    std::array<InvariantClaim, static_cast<std::size_t>(ClaimId::count)> claims;
    const double shrink = 1 - c.delta, infinity = std::numeric_limits<double>::infinity();
    const auto state = [&](ClaimId id, const char* name, bool at_least, double bound, const char* statement) {
        InvariantClaim& claim = claims[static_cast<std::size_t>(id)];
        claim.name = name;
        claim.statement = statement;
        claim.at_least = at_least;
        claim.bound = bound;
        claim.worst = std::numeric_limits<double>::quiet_NaN();
    };
    const auto case_of = [&](unsigned number) { return insertion_factor(number, c); };
    const DensityBounds d = density_bounds(c);
    state(ClaimId::lemma_2_1, "lemma_2_1", false, 1, "R/r of a final tetrahedron, over sqrt(3) rho^3 / sigma");
    state(ClaimId::picking_region, "picking_region", false, c.delta, "distance of the point from the element's centre, over R (2.3)");
    state(ClaimId::empty_sphere, "empty_sphere", true, shrink, "e_v / R of the element split or left (sections 4, 5)");
    state(ClaimId::lemma_2_5, "lemma_2_5", true, std::numbers::sqrt2 / 2, "R of the encroached element over R of the encroaching one");
    state(ClaimId::projection, "projection", true, 0, "the subface split holds the projection of what encroaches it (2.3): barycentric coordinate");
    state(ClaimId::order, "order", false, 0, "elements waiting that come before the one split (3.1)");
    state(ClaimId::parent, "parent", true, 1, "1 if the parent is the vertex that section 5 names");
    state(ClaimId::theorem_4_1, "theorem_4_1", true, 1, "1 if a point without new small slivers was found to remove a sliver");
    state(ClaimId::lemma_4_2, "lemma_4_2", true, shrink / 4, "e_v / l_org, removing an original sliver");
    state(ClaimId::lemma_4_3, "lemma_4_3", true, shrink * c.rho0 / 2, "e_v / L, removing a large radius-edge ratio");
    state(ClaimId::lemma_4_4, "lemma_4_4", true, shrink * c.b / 4, "e_v / L of the parent sliver, removing a sliver made by removing a sliver");
    state(ClaimId::lemma_4_5, "lemma_4_5", true, shrink * shrink * c.rho0 / 4, "e_v / L of the parent, removing a sliver made by removing a large radius-edge ratio");
    state(ClaimId::lemma_4_6_radius_edge, "lemma_4_6_radius_edge", true, shrink * shrink * c.rho0 / 8,
          "e_v / L of the encroaching tetrahedron (large radius-edge ratio), removing a sliver made by a boundary split");
    state(ClaimId::lemma_4_6_sliver, "lemma_4_6_sliver", true, shrink * c.b / 4, "e_v / L of the element split for a sliver, removing a sliver made by that boundary split");
    state(ClaimId::theorem_4_2, "theorem_4_2", true, shrink / 4, "e_v, or a final edge, over l_org");
    state(ClaimId::lemma_5_1_input, "lemma_5_1_input", true, 1, "e_v / lfs(v) of an input vertex");
    state(ClaimId::lemma_5_1_case_1, "lemma_5_1_case_1", true, case_of(1), "e_v / e_p: large radius-edge ratio");
    state(ClaimId::lemma_5_1_case_2, "lemma_5_1_case_2", true, case_of(2), "e_v / e_p: original sliver");
    state(ClaimId::lemma_5_1_case_3, "lemma_5_1_case_3", true, case_of(3), "e_v / e_p: sliver made by removing a sliver");
    state(ClaimId::lemma_5_1_case_4, "lemma_5_1_case_4", true, case_of(4), "e_v / e_p: sliver made by removing a large radius-edge ratio");
    state(ClaimId::lemma_5_1_case_5, "lemma_5_1_case_5", true, case_of(5), "e_v / e_p: sliver made by a boundary split for a sliver");
    state(ClaimId::lemma_5_1_case_6, "lemma_5_1_case_6", true, case_of(6), "e_v / e_p: sliver made by a boundary split for a large radius-edge ratio");
    state(ClaimId::lemma_5_1_case_7, "lemma_5_1_case_7", true, case_of(7), "e_v / e_p: boundary split for a rejected centre");
    state(ClaimId::encroaching_vertex, "encroaching_vertex", false, c.alpha(), "lfs(v) / e_v: boundary split for an encroaching mesh vertex (missing in the paper)");
    state(ClaimId::lemma_5_2, "lemma_5_2", false, c.alpha(), "D_v - D_p e_p / e_v");
    state(ClaimId::theorem_5_1_segments, "theorem_5_1_segments", false, d.d1, "D_v = lfs(v) / e_v on segments");
    state(ClaimId::theorem_5_1_facets, "theorem_5_1_facets", false, d.d2, "D_v on facets");
    state(ClaimId::theorem_5_1_inside, "theorem_5_1_inside", false, d.d3, "D_v inside");
    state(ClaimId::theorem_5_2, "theorem_5_2", false, d.largest() + 1, "lfs(v) / N(v), N the distance to the nearest vertex of the final mesh");
    state(ClaimId::theorem_5_3, "theorem_5_3", false, infinity, "vertices over those of the almost-good mesh (the paper gives no number)");
    return claims;
}

}  // namespace wellmesh
