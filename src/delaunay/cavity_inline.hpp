// SPDX-License-Identifier: Apache-2.0
// The search for a cavity, in a header so that callers' tests of its faces are compiled into it. Included by triangulation.hpp.
#pragma once

namespace wellmesh {

template <bool kZoned, class Accept>
bool Triangulation::grow_cavity(const Vec3& p, TetId seed, Cavity& cavity, const Accept& accept) {
    cavity.point = p;
    cavity.tets.clear();
    cavity.boundary.clear();
    cavity.duplicate = VertexId{};
    next_epoch();
    const std::uint32_t kept = epoch_, taken = epoch_ + 1;
    // Nothing is allocated here but by push_back: these stay put, and the compiler need not fetch them again after every call.
    std::uint32_t* const marks = mark_.data();
    const Vertex* const vertices = vertices_.data();
    marks[seed.index()] = taken;
    cavity.tets.push_back(seed);
    prefetch_neighbours(seed);
    for (std::size_t i = 0; i < cavity.tets.size(); ++i) {
        const TetId t = cavity.tets[i];
        const std::array<TetFace, 4> neighbours = tets_.across_all(t);
        for (unsigned f = 0; f < 4; ++f) {
            const TetFace outside = neighbours[f];
            const TetId n = outside.tet();
            if constexpr (kZoned) {  // another worker may be writing to what is not ours
                if (!is_mine(n)) return false;
            }
            std::uint32_t& mark = marks[n.index()];
            if (mark == taken) continue;
            if (mark != kept) {
                const TetStore::Corners& c = tets_.corners(n);
                if constexpr (kZoned) {
                    if (c[3] == kInfiniteVertex && !is_mine(tets_.across(n, 3).tet())) return false;
                }
                const bool conflict = c[3] == kInfiniteVertex
                                          ? ghost_in_conflict(n, p)
                                          : filter_.insphere_perturbed_padded(vertices[c[0].index()].point, vertices[c[1].index()].point,
                                                                              vertices[c[2].index()].point, vertices[c[3].index()].point, p) == Sign::positive;
                mark = conflict ? taken : kept;
                if (conflict) {
                    cavity.tets.push_back(n);
                    prefetch_neighbours(n);
                    continue;
                }
            }
            cavity.boundary.push_back({TetFace{t, f}, outside});
            if (!accept(cavity.boundary.back())) return false;
        }
    }
    return true;
}

}  // namespace wellmesh
