// SPDX-License-Identifier: Apache-2.0
// Which strategy does what, and when (docs/strategies.md). Each is a few lines here and a class where its work is: Refiner for those that insert
// by the paper's cascade, LocalImprover for section 6, ShapeImprover for those that move vertices.
#pragma once

#include <cstdint>
#include <string>

#include "conforming/boundary_refiner.hpp"
#include "conforming/conforming_mesh.hpp"
#include "core/run_guard.hpp"
#include "core/workers.hpp"
#include "refinement/refine.hpp"
#include "wellmesh/options.hpp"

namespace wellmesh {

/// Strategies that insert may make the almost-good mesh so many times larger, and by so many vertices more on small ones. The paper's
/// theorem promises a constant factor, which in practice is 1.0 to 1.3 where slivers can be removed at all; beyond 2 they multiply.
inline constexpr double kGrowthLimit = 2;
inline constexpr std::uint64_t kGrowthAllowance = 300;

/// chew: half a unit about the circumcentre, which is half of the circumradius of a tetrahedron of one unit [Chew97].
inline constexpr double kChewDelta = 0.5;

/// How refinement picks its points, before it starts. Not for certified mode, which has its own rule.
void prepare_refinement(Refiner& refiner, BoundaryRefiner& boundary, const MeshOptions& options);

/// Is there anything for remove_slivers to do?
[[nodiscard]] bool asks_for_shape(const MeshOptions& options);
/// Do only refinement's own insertions happen after the almost-good mesh? Then the paper's claims can be asked of them.
[[nodiscard]] bool only_refines(SliverStrategy strategy);

struct SliverOutcome {
    RunGuard::Verdict verdict = RunGuard::Verdict::go_on;
    std::uint64_t moved_vertices = 0;
    std::string note{};  ///< why it ended before the goal, if by a bound of its own
};

/// Removes slivers from the almost-good mesh that refinement left. Whatever comes of it, the mesh stays Delaunay, conforming and Gabriel.
SliverOutcome remove_slivers(ConformingMesh& mesh, BoundaryRefiner& boundary, Refiner& refiner, RunGuard& guard, Workers& workers, const MeshOptions& options);

}  // namespace wellmesh
