// SPDX-License-Identifier: Apache-2.0
// Sliver exudation: weights of vertices that drive slivers out of a Delaunay mesh, which becomes *weighted* Delaunay [Cheng00].
//
// No vertex moves, comes or goes, and the boundary stays. Worst sliver first, a weight of one of its vertices or of a vertex across one of
// its faces is raised to where the sliver is gone and all that is made is better than the worst that is destroyed. So the sorted angles of
// the mesh rise with every change, and the work ends. Differences to the paper: it gives each vertex one weight, in any order, the
// one that is best for its star; here only slivers are looked at, vertices are visited as often as that helps, but weights never fall.
#pragma once

#include <cstdint>

#include "core/run_guard.hpp"
#include "exudation/star_growth.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh {

/// Weights are at most the square of this part of the distance to the nearest vertex. Below a half no vertex is hidden by another one
/// [Cheng00]; the paper's omega_0.
inline constexpr double kMaxWeightRatio = 0.45;

struct ExudationReport {
    std::uint64_t slivers_before = 0, slivers_after = 0;
    std::uint64_t changes = 0;             ///< of weights, several for some vertices
    std::uint64_t weighted_vertices = 0;
    RunGuard::Verdict verdict = RunGuard::Verdict::go_on;  ///< what ended the work early, if anything did
};

/// @param mesh  Delaunay (or weighted Delaunay, with its weights), conforming and Gabriel as its certificate would prove it.
/// @param goal_deg  tetrahedra with a smaller dihedral angle are slivers. @param bounds  that new tetrahedra keep.
/// @post the same vertices, subfaces, subsegments and regions; weakly weighted Delaunay and weighted Gabriel: no vertex in conflict with a
///       sphere that it is not orthogonal to.
/// Deterministic: slivers in order of their angles, ties by tetrahedron.
ExudationReport exude(TetMesh& mesh, double goal_deg, const ExudationBounds& bounds, RunGuard& guard);

}  // namespace wellmesh
