// SPDX-License-Identifier: Apache-2.0
// A sound mesh made from its definition, and counts of what is wrong with one, by trying everything.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "wellmesh/plc.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh::testing {

/// The box [0,4] x [0,2] x [0,2] with a facet at x = 2 between its regions 1 and 2 (volume 8 each), and its mesh: the Delaunay
/// triangulation of a jittered grid (all quadruples of points with an empty circumsphere). Jitter keeps the points on the box's
/// faces and edges exactly, so the mesh conforms; spacing is 1, so nothing is encroached.
struct BoxMesh {
    Plc plc;
    TetMesh mesh;
};
const BoxMesh& two_region_box();

/// Calls f(p) for every vertex, mesh and PLC alike.
template <class F>
BoxMesh mapped(BoxMesh box, F&& f) {
    for (Vec3& p : box.mesh.vertices) p = f(p);
    for (Vec3& p : box.plc.vertices) p = f(p);
    return box;
}

/// Number of violations by the claim's name. By maps, sets and double loops.
std::map<std::string, std::uint64_t> count_by_brute_force(const TetMesh& mesh, double flat_angle = 1e-6);

}  // namespace wellmesh::testing
