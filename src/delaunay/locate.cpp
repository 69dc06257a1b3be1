// SPDX-License-Identifier: Apache-2.0
// Point location by visibility walk, and look-ups of edges and faces through stars.
#include "core/check.hpp"
#include "core/rng.hpp"
#include "delaunay/triangulation.hpp"

namespace wellmesh {

TetId Triangulation::locate(const Vec3& p, TetId hint) const {
    if (is_view()) return may_enter<true>(hint) ? walk<true>(p, hint) : TetId{};
    TetId t = hint;
    if (!t.valid() || t.index() >= tets_.slots() || !tets_.is_live(t)) t = last_located_;
    if (!t.valid() || t.index() >= tets_.slots() || !tets_.is_live(t)) {
        for (std::size_t i = 0; i < tets_.slots(); ++i)
            if (tets_.is_live(TetId{i})) {
                t = TetId{i};
                break;
            }
    }
    return walk<false>(p, t);
}

/// @return an invalid id if the way leaves the zone.
template <bool kZoned>
TetId Triangulation::walk(const Vec3& p, TetId t) const {
    if (tets_.is_ghost(t)) {
        t = tets_.across(t, 3).tet();
        if (!may_enter<kZoned>(t)) return {};
    }
    // A visibility walk ends in a Delaunay triangulation whatever face is taken first [Devillers02]; the one it came through is skipped.
    TetId from{};
    unsigned start = 0;
    for (std::size_t steps = 0;; ++steps) {
        WELLMESH_CHECK(Stage::delaunay, steps <= tets_.slots() + 4);
        const TetStore::Corners& c = tets_.corners(t);
        TetId next{};
        for (unsigned k = 0; k < 4; ++k) {
            const unsigned f = (start + k) & 3U;
            const TetId neighbour = tets_.across(t, f).tet();
            if (neighbour == from) continue;
            const auto& fc = kFaceCorners[f];
            if (filter_.orient3d(point(c[fc[0]]), point(c[fc[1]]), point(c[fc[2]]), p) == Sign::negative) {
                next = neighbour;
                break;
            }
        }
        if (!next.valid()) break;
        if (!may_enter<kZoned>(next)) return {};
        from = t;
        t = next;
        start = static_cast<unsigned>(steps) & 3U;
        if (tets_.is_ghost(t)) break;
    }
    return t;
}

template TetId Triangulation::walk<false>(const Vec3& p, TetId t) const;
template TetId Triangulation::walk<true>(const Vec3& p, TetId t) const;

template <bool kZoned>
bool Triangulation::collect_star(VertexId v, std::vector<TetId>& star) {
    star.clear();
    const TetId seed = vertices_[v.index()].tet;
    if (!may_enter<kZoned>(seed)) return false;
    next_epoch();
    std::uint32_t* const marks = mark_.data();
    const std::uint32_t met = epoch_;
    // Whether a neighbour has been met can't be foreseen: no branch. There is room for three that have.
    constexpr std::size_t kRoom = 4;
    std::size_t count = 1;
    star.resize(8 * kRoom);
    star[0] = seed;
    marks[seed.index()] = met;
    for (std::size_t i = 0; i < count; ++i) {
        if (star.size() < count + kRoom) star.resize(2 * star.size());
        const TetId t = star[i];
        for (const unsigned f : kOtherCorners[tets_.find_corner(t, v)]) {
            const TetId n = tets_.across(t, f).tet();
            if (!may_enter<kZoned>(n)) {
                star.resize(count);
                return false;
            }
            tets_.prefetch(n);
            star[count] = n;
            count += marks[n.index()] != met ? 1U : 0U;
            marks[n.index()] = met;
        }
    }
    star.resize(count);
    return true;
}

bool Triangulation::find_star(VertexId v, std::vector<TetId>& star) { return is_view() ? collect_star<true>(v, star) : collect_star<false>(v, star); }

/// Walks the star of a; stops at the first tetrahedron that has b too.
template <bool kZoned>
TetId Triangulation::search_edge(VertexId a, VertexId b) {
    std::vector<TetId>& stack = star_stack_;
    stack.clear();
    stack.push_back(vertices_[a.index()].tet);
    if (!may_enter<kZoned>(stack[0])) return {};
    next_epoch();
    mark_[stack[0].index()] = epoch_;
    for (std::size_t i = 0; i < stack.size(); ++i) {
        const TetId t = stack[i];
        if (tets_.find_corner(t, b) < 4) return t;
        const unsigned at = tets_.find_corner(t, a);
        for (unsigned f = 0; f < 4; ++f) {
            if (f == at) continue;
            const TetId n = tets_.across(t, f).tet();
            if (!may_enter<kZoned>(n)) return {};
            if (mark_[n.index()] == epoch_) continue;
            mark_[n.index()] = epoch_;
            stack.push_back(n);
        }
    }
    return {};
}

TetId Triangulation::find_edge(VertexId a, VertexId b) { return is_view() ? search_edge<true>(a, b) : search_edge<false>(a, b); }

TetFace Triangulation::find_face(VertexId a, VertexId b, VertexId c) {
    const TetId first = find_edge(a, b);
    if (!first.valid()) return {};
    TetId t = first;
    // Turn about the edge ab: leave each tetrahedron through the face opposite to the corner that was kept last.
    const auto& corners = tets_.corners(t);
    unsigned other[2], n = 0;
    for (unsigned i = 0; i < 4; ++i)
        if (corners[i] != a && corners[i] != b) other[n++] = i;
    VertexId ahead = corners[other[0]], behind = corners[other[1]];
    do {
        if (ahead == c) return TetFace{t, tets_.find_corner(t, behind)};
        if (behind == c) return TetFace{t, tets_.find_corner(t, ahead)};
        const TetFace next = tets_.across(t, tets_.find_corner(t, behind));
        if (is_view() && !may_enter<true>(next.tet())) return {};
        behind = ahead;
        ahead = tets_.corner(next.tet(), next.face());
        t = next.tet();
    } while (t != first);
    return {};
}

}  // namespace wellmesh
