// SPDX-License-Identifier: Apache-2.0
#include "delaunay/check_delaunay.hpp"

#include <algorithm>

namespace wellmesh {

std::string check_adjacency(const Triangulation& mesh) {
    const TetStore& tets = mesh.tets();
    for (std::size_t i = 0; i < tets.slots(); ++i) {
        const TetId t{i};
        if (!tets.is_live(t)) continue;
        const std::string name = "tetrahedron " + std::to_string(i);
        if (!tets.is_ghost(t)) {
            const auto& c = tets.corners(t);
            if (orient3d(mesh.point(c[0]), mesh.point(c[1]), mesh.point(c[2]), mesh.point(c[3])) != Sign::positive) return name + " is not positive";
        }
        for (unsigned f = 0; f < 4; ++f) {
            const TetFace mine{t, f}, other = tets.across(mine);
            if (!other.valid() || !tets.is_live(other.tet())) return name + " has a dead neighbour";
            if (tets.across(other) != mine) return name + ": neighbour does not look back";
            auto a = tets.face_corners(mine), b = tets.face_corners(other);
            std::sort(a.begin(), a.end());
            std::sort(b.begin(), b.end());
            if (a != b) return name + ": neighbour names another face";
        }
        for (const VertexId v : tets.corners(t)) {
            if (v == kInfiniteVertex) continue;
            const TetId home = mesh.tet_of(v);
            if (!home.valid() || !tets.is_live(home) || tets.find_corner(home, v) == 4) return "vertex " + std::to_string(v.value()) + " has a wrong tetrahedron";
        }
    }
    return {};
}

std::string check_delaunay(const Triangulation& mesh) {
    const TetStore& tets = mesh.tets();
    for (std::size_t i = 0; i < tets.slots(); ++i) {
        const TetId t{i};
        if (!tets.is_live(t)) continue;
        for (unsigned f = 0; f < 4; ++f) {
            const TetFace other = tets.across(t, f);
            const VertexId apex = tets.corner(other.tet(), other.face());
            if (apex == kInfiniteVertex) continue;
            if (mesh.in_conflict(t, mesh.point(apex))) return "vertex " + std::to_string(apex.value()) + " is in conflict with tetrahedron " + std::to_string(i);
        }
    }
    return {};
}

}  // namespace wellmesh
