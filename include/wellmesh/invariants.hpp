// SPDX-License-Identifier: Apache-2.0
// What the paper claims of a run, and what the run did (docs/theory.md).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "wellmesh/vec3.hpp"

namespace wellmesh {

/// One claim over all events that it speaks of. `holds` is always `value relation bound`, up to the rounding of each value.
struct InvariantClaim {
    std::string name;       ///< stable key, e.g. "lemma_5_1_case_7"
    std::string statement;  ///< one line for people, the inequality included
    bool at_least = true;   ///< value >= bound; else value <= bound
    double bound = 0;       ///< infinite (or 0 for at_least) where the constants in use give none
    double worst = 0;       ///< the value nearest to the bound, or furthest beyond it; NaN without events
    std::uint64_t events = 0, violations = 0;
    std::string witness;    ///< the first violation, or the worst event: what, where, with numbers
    Vec3 where{};           ///< of the witness
};

struct InvariantReport {
    double delta = 0, b = 0, rho0 = 0, sigma0 = 0;  ///< in use; b is infinite and sigma0 is 0 where the dihedral angle judges slivers
    double d1 = 0, d2 = 0, d3 = 0;                  ///< of Theorem 5.1; infinite where its inequalities have no solution
    double log10_existence_sigma0 = 0;              ///< the existence theorem's own sigma0, as a power of ten
    double original_edge = 0;                       ///< l_org: shortest edge of the mesh that conforms and meets its size
    double shortest_edge = 0;                       ///< of the final mesh
    std::uint64_t original_vertices = 0, almost_good_vertices = 0, final_vertices = 0;
    std::vector<InvariantClaim> claims;

    [[nodiscard]] std::uint64_t violations() const {
        std::uint64_t n = 0;
        for (const InvariantClaim& c : claims) n += c.violations;
        return n;
    }
    [[nodiscard]] const InvariantClaim* find(const std::string& name) const {
        for (const InvariantClaim& c : claims)
            if (c.name == name) return &c;
        return nullptr;
    }
};

}  // namespace wellmesh
