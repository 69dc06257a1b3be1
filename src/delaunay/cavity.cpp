// SPDX-License-Identifier: Apache-2.0
// The conflict test and the search for the cavity of a point, without changing anything.
#include <limits>

#include "delaunay/triangulation.hpp"

namespace wellmesh {

void Triangulation::ensure_marks() {
    if (mark_.size() < tets_.slots()) mark_.resize(tets_.slots() + tets_.slots() / 2 + 64, 0);
}

void Triangulation::next_epoch() {
    ensure_marks();
    if (epoch_ > std::numeric_limits<std::uint32_t>::max() - 4) {
        std::fill(mark_.begin(), mark_.end(), 0U);
        epoch_ = 0;
    }
    epoch_ += 2;
}

bool Triangulation::ghost_in_conflict(TetId t, const Vec3& p) const {
    const auto& c = tets_.corners(t);
    const Sign side = filter_.orient3d(point(c[0]), point(c[1]), point(c[2]), p);
    if (side != Sign::zero) return side == Sign::positive;
    // p lies in the hull plane: the circumsphere of the tetrahedron behind cuts the plane in the hull face's circumcircle.
    return in_conflict(tets_.across(t, 3).tet(), p);
}

bool Triangulation::in_conflict(TetId t, const Vec3& p) const {
    const auto& c = tets_.corners(t);
    if (c[3] == kInfiniteVertex) return ghost_in_conflict(t, p);
    return filter_.insphere_perturbed_padded(point(c[0]), point(c[1]), point(c[2]), point(c[3]), p) == Sign::positive;
}

bool Triangulation::find_conflict_cavity(const Vec3& p, TetId near, Cavity& cavity) {
    cavity.point = p;
    cavity.tets.clear();
    cavity.boundary.clear();
    cavity.duplicate = VertexId{};
    const TetId seed = locate(p, near);
    for (const VertexId v : tets_.corners(seed))
        if (v != kInfiniteVertex && point(v) == p) {
            cavity.duplicate = v;
            return false;
        }
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
            std::uint32_t& mark = marks[n.index()];
            if (mark == taken) continue;
            if (mark != kept) {
                const TetStore::Corners& c = tets_.corners(n);
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
        }
    }
    return true;
}

}  // namespace wellmesh
