// SPDX-License-Identifier: Apache-2.0
// The search for a whole cavity, wave by wave: all neighbours of the tetrahedra that the last wave took are tested together. What a test says, and whether a
// neighbour was met before, can't be foreseen, so nothing branches on either: lists are written one place too far, and their length tells. The order of
// tetrahedra and faces is that of grow_cavity(), which goes face by face and can stop half-way.
#include <cmath>

#include "core/infinity.hpp"
#include "delaunay/triangulation.hpp"
#include "predicates/precise_inspheres.hpp"

namespace wellmesh {

/// @return false if the cavity or a tetrahedron around it isn't all of this zone
template <bool kZoned>
bool Triangulation::grow_in_waves(const Vec3& p, TetId seed, Cavity& cavity) {
    next_epoch();
    const std::uint32_t kept = epoch_, in_conflict = epoch_ + 1;
    std::uint32_t* const marks = mark_.data();
    const PointRecords points{&vertices_.data()->point};
    Wave& w = wave_;
    const auto make_room = [](auto& list, std::size_t n) {
        if (list.size() < n) list.resize(2 * n);
    };
    make_room(w.taken, 2);
    marks[seed.index()] = in_conflict;
    w.taken[0] = seed;
    std::size_t taken = 1;
    for (std::size_t begin = 0; begin < taken;) {
        const std::size_t end = taken, most = 4 * (end - begin) + 4;
        make_room(w.candidates, most);
        make_room(w.corners, most);
        make_room(w.values, most);
        make_room(w.taken, taken + most);
        TetId* const candidates = w.candidates.data();
        std::size_t count = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const std::array<TetFace, 4>& around = tets_.across_all(w.taken[i]);
            if constexpr (kZoned) {  // another worker may be writing to what is not ours
                if (!(is_mine(around[0].tet()) && is_mine(around[1].tet()) && is_mine(around[2].tet()) && is_mine(around[3].tet()))) return false;
            }
            for (const TetFace outside : around) {
                const TetId n = outside.tet();
                // -1 or less if it is new, 0 if it was kept or is a candidate, 1 if it was taken.
                const auto seen = static_cast<std::int32_t>(marks[n.index()] - kept);
                candidates[count] = n;
                count += static_cast<std::uint32_t>(seen) >> 31;
                marks[n.index()] = kept + static_cast<std::uint32_t>(seen & ~(seen >> 31));
                tets_.prefetch(n);
            }
        }
        begin = end;
        if (count == 0) break;
        for (std::size_t k = 0; k < count; ++k) {
            const TetStore::Corners& c = tets_.corners(candidates[k]);
            // A flat tetrahedron stands for a ghost: its determinant says nothing, as that of a tie.
            w.corners[k] = {c[0].value(), c[1].value(), c[2].value(), (c[3] == kInfiniteVertex ? c[0] : c[3]).value()};
        }
        double* const values = w.values.data();
        filter_.insphere_values_of(points, {w.corners.data(), count}, p, values);
        TetId* const list = w.taken.data();
        std::uint32_t undecided = 0;
        const auto deal = [&](std::size_t into, double limit) {
            for (std::size_t k = 0; k < count; ++k) {
                const TetId t = candidates[k];
                const std::uint32_t conflict = values[k] > limit ? 1 : 0;
                undecided |= conflict ^ (values[k] < -limit ? 0 : 1);
                list[into] = t;
                into += conflict;
                marks[t.index()] = kept + conflict;
            }
            return into;
        };
        taken = deal(end, filter_.insphere_bound());
        if (undecided != 0) [[unlikely]] {
            if constexpr (kZoned) {
                for (std::size_t k = 0; k < count; ++k)
                    if (tets_.is_ghost(candidates[k]) && !is_mine(tets_.across(candidates[k], 3).tet())) return false;
            }
            decide_wave(p, count);
            taken = deal(end, 0);
        }
    }

    make_room(w.boundary, 4 * taken + 1);
    BoundaryFace* const boundary = w.boundary.data();
    std::size_t faces = 0;
    for (std::size_t i = 0; i < taken; ++i) {
        const TetId t = w.taken[i];
        const std::array<TetFace, 4>& around = tets_.across_all(t);
        for (unsigned f = 0; f < 4; ++f) {
            boundary[faces] = {TetFace{t, f}, around[f]};
            faces += marks[around[f].tet().index()] != in_conflict ? 1U : 0U;
        }
    }
    cavity.point = p;
    cavity.duplicate = VertexId{};
    cavity.tets.assign(w.taken.begin(), w.taken.begin() + static_cast<std::ptrdiff_t>(taken));
    cavity.boundary.assign(boundary, boundary + faces);
    return true;
}

template bool Triangulation::grow_in_waves<false>(const Vec3& p, TetId seed, Cavity& cavity);
template bool Triangulation::grow_in_waves<true>(const Vec3& p, TetId seed, Cavity& cavity);

/// Gives values that decide to the candidates that have none. On a facet of the hull that is no side of a box whole waves are flat.
void Triangulation::decide_wave(const Vec3& p, std::size_t candidates) {
    Wave& w = wave_;
    const auto is_decided = [&](std::size_t k) { return std::fabs(w.values[k]) > filter_.insphere_bound(); };
    w.unsure.clear();
    w.unsure_corners.clear();
    if (has_insphere_lanes() && filter_.insphere_bound() < kInfinity) {
        for (std::size_t k = 0; k < candidates; ++k) {
            if (is_decided(k) || w.values[k] == 0 || tets_.is_ghost(w.candidates[k])) continue;  // a tie is a tie mostly
            w.unsure.push_back(static_cast<std::uint32_t>(k));
            w.unsure_corners.push_back(w.corners[k]);
        }
    }
    if (!w.unsure.empty()) {
        w.signs.resize(w.unsure.size() + 3);
        insphere_signs_of_records({&vertices_.data()->point}, w.unsure_corners, p, w.signs.data());
        for (std::size_t i = 0; i < w.unsure.size(); ++i)
            if (w.signs[i] != 0) w.values[w.unsure[i]] = w.signs[i] * kInfinity;
    }
    for (std::size_t k = 0; k < candidates; ++k)
        if (!is_decided(k)) w.values[k] = in_conflict(w.candidates[k], p) ? 1 : -1;
}

}  // namespace wellmesh
