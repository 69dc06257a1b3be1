// SPDX-License-Identifier: Apache-2.0
// Better angles for a mesh that is there already, whichever tool made it.
#pragma once

#include "wellmesh/options.hpp"
#include "wellmesh/plc.hpp"
#include "wellmesh/result.hpp"
#include "wellmesh/run_control.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh {

/// Raises the smallest dihedral angle of `mesh`, a tetrahedral mesh of the domain `plc`, and certifies the result: Delaunay, conforming and
/// Gabriel as generate() promises it, whether or not the given mesh was.
///
/// The mesh's vertices are kept, not its tetrahedra: every vertex is matched with the input vertex, segment or facet that it lies on, all are
/// triangulated again, and where segments or facets are missing or encroached, or the radius-edge ratio is too large, vertices are added.
/// Then vertices move, and come and go where that fails, until the angle is reached. `statistics.given` counts what had to be done. A mesh
/// that meets the goals keeps all its vertices where they are (those on the boundary to within 8 ulp).
///
/// Regions, facets and segments of the result are the input's; the references of `mesh` only help where several facets or segments are within
/// the tolerance of a vertex. Orientation and order of its tetrahedra do not matter, nor does it if some are inverted; vertices of none are
/// dropped, vertices at one place become one, input vertices that it lacks are added.
///
/// @param options  as for generate(); without size goals sizes stay about as they are. Practical mode only; `invariants` are of generate()'s
///                 insertions and can't be asked for; `seeding` does nothing.
/// @throws MeshError  what generate() throws; bad_input if `mesh` is not one of this domain: boundary vertices farther off every facet than the
///                    tolerance (1e-9 of the diagonal, or what rounding does if that is more), another volume, vertices outside. Offenders say
///                    where; vertices of the mesh are numbered from 1.
/// Deterministic; no globals, no output; safe to call from several threads at once.
[[nodiscard]] MeshResult improve(const TetMesh& mesh, const Plc& plc, const MeshOptions& options = {}, const RunControl& control = {});

}  // namespace wellmesh
