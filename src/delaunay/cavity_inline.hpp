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
        // First the determinants of all neighbours that are new, which don't wait for each other, then what follows from them.
        std::array<SphereCorners, 4> spheres;
        std::array<TetId, 4> tested;
        std::array<double, 4> values;
        std::size_t tests = 0;
        for (const TetFace outside : neighbours) {
            const TetId n = outside.tet();
            if (!may_enter<kZoned>(n)) return false;  // another worker may be writing to what is not ours
            const std::uint32_t mark = marks[n.index()];
            if (mark == taken || mark == kept) continue;
            const TetStore::Corners& c = tets_.corners(n);
            if (c[3] == kInfiniteVertex) continue;
            tested[tests] = n;
            spheres[tests++] = {&vertices[c[0].index()].point, &vertices[c[1].index()].point, &vertices[c[2].index()].point, &vertices[c[3].index()].point};
        }
        filter_.insphere_values_padded({spheres.data(), tests}, p, values.data());
        std::size_t test = 0;
        for (unsigned f = 0; f < 4; ++f) {
            const TetFace outside = neighbours[f];
            const TetId n = outside.tet();
            std::uint32_t& mark = marks[n.index()];
            if (mark == taken) continue;
            if (mark != kept) {
                bool conflict = false;
                if (tets_.corner(n, 3) == kInfiniteVertex) {
                    if (!may_enter<kZoned>(tets_.across(n, 3).tet())) return false;
                    conflict = ghost_in_conflict(n, p);
                } else {
                    // A neighbour across two faces was new twice.
                    while (tested[test] != n) ++test;
                    conflict = filter_.insphere_perturbed_of_value(values[test], spheres[test], p) == Sign::positive;
                    ++test;
                }
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
