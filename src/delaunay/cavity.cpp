// SPDX-License-Identifier: Apache-2.0
// The conflict test and the search for the cavity of a point, without changing anything.
#include <algorithm>
#include <utility>

#include "core/infinity.hpp"
#include "delaunay/triangulation.hpp"

namespace wellmesh {

void Triangulation::ensure_marks() {
    if (mark_.size() >= tets_.slots()) return;
    mark_.reserve(tets_.capacity());  // lest they be copied again and again while the tetrahedra fill what was reserved for them
    mark_.resize(std::min(tets_.capacity(), tets_.slots() + tets_.slots() / 8 + 64), 0);
}

void Triangulation::next_epoch() {
    ensure_marks();
    if (epoch_ > kLastEpoch) {
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
    if (!in_box(p)) {  // the filter's bounds do not hold: do without it
        const PredicateFilter kept = std::exchange(filter_, PredicateFilter(Vec3{kInfinity, kInfinity, kInfinity}));
        const bool found = search_conflict_cavity(p, near, cavity);
        filter_ = kept;
        return found;
    }
    return search_conflict_cavity(p, near, cavity);
}

bool Triangulation::search_conflict_cavity(const Vec3& p, TetId near, Cavity& cavity) {
    const TetId seed = locate(p, near);
    cavity.duplicate = VertexId{};
    if (!seed.valid()) return false;  // of a view: the way left the zone
    for (const VertexId v : tets_.corners(seed))
        if (v != kInfiniteVertex && point(v) == p) {
            cavity.point = p;
            cavity.tets.clear();
            cavity.boundary.clear();
            cavity.duplicate = v;
            return false;
        }
    if (!is_view()) return grow_in_waves<false>(p, seed, cavity);
    if (grow_in_waves<true>(p, seed, cavity)) return true;
    left_zone_ = true;
    return false;
}

}  // namespace wellmesh
