// SPDX-License-Identifier: Apache-2.0
// Takes superfluous vertices out. Splits come in cascades, which leave thin parts twice as fine as they need to be, and evenly so that no
// single vertex can go. So one goes, a neighbour on the same segment or facet closes up, and moves mend what that has made worse;
// if all of it is as good as the goal then, the chain is kept, else undone.
#pragma once

#include <cstddef>

#include "conforming/conforming_mesh.hpp"
#include "core/run_guard.hpp"
#include "shape/chains.hpp"

namespace wellmesh {

class Thinning {
public:
    Thinning(ConformingMesh& mesh, RunGuard& guard, Chains& chains) : mesh_(mesh), guard_(guard), chains_(chains) {}

    /// Is the mesh as good as thin already: are there no more than `enough` vertices, but for half a per cent?
    [[nodiscard]] bool is_pointless(std::size_t enough) const;
    /// Takes out what can go of the vertices from slot `first_new` on, then of all as long as there are too many in that sense.
    RunGuard::Verdict run(std::size_t first_new, std::size_t enough);

private:
    RunGuard::Verdict sweep(std::size_t first, std::size_t enough, std::size_t trials);

    ConformingMesh& mesh_;
    RunGuard& guard_;
    Chains& chains_;
};

}  // namespace wellmesh
