// SPDX-License-Identifier: Apache-2.0
// Tetrahedra known by their corners: taking a vertex out for a trial and putting it back gives them new ids.
#pragma once

#include <algorithm>
#include <functional>

#include "conforming/conforming_mesh.hpp"
#include "core/rng.hpp"

namespace wellmesh {

/// A hash that is the same in any order of the corners.
inline std::uint64_t key_of(TetStore::Corners c) {
    std::sort(c.begin(), c.end());
    return mix64(mix64(c[0].value(), c[1].value()), mix64(c[2].value(), c[3].value()));
}

/// The domain tetrahedron with these corners, or an invalid id. @param last  its id when it was last seen: mostly it still is, and the stars of all
/// its corners may be large
inline TetId find_tet(ConformingMesh& mesh, TetStore::Corners corners, TetId last = {}) {
    for (const VertexId v : corners)
        if (!mesh.triangulation().is_inserted(v)) return {};
    // The star of the first is searched: the youngest's, since the oldest may hold a great part of the mesh.
    std::sort(corners.begin(), corners.end(), std::greater<>());
    if (last.valid() && last.index() < mesh.tets().slots() && mesh.triangulation().may_look_at(last) && mesh.tets().is_finite(last) && mesh.in_domain(last)) {
        TetStore::Corners now = mesh.tets().corners(last);
        std::sort(now.begin(), now.end(), std::greater<>());
        if (now == corners) return last;
    }
    const TetFace face = mesh.triangulation().find_face(corners[0], corners[1], corners[2]);
    if (!face.valid()) return {};
    for (const TetFace side : {face, mesh.tets().across(face)})
        if (mesh.tets().corner(side.tet(), side.face()) == corners[3] && mesh.in_domain(side.tet())) return side.tet();
    return {};
}

/// Corners inside cells first, then on facets, then on segments, which have fewer ways to go; input vertices, which have none, last.
inline TetStore::Corners freest_first(const ConformingMesh& mesh, TetStore::Corners corners) {
    std::sort(corners.begin(), corners.end(), [&](VertexId a, VertexId b) {
        const auto ka = static_cast<int>(mesh.info(a).carrier), kb = static_cast<int>(mesh.info(b).carrier);
        return ka != kb ? ka > kb : a < b;
    });
    return corners;
}

}  // namespace wellmesh
