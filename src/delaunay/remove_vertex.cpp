// SPDX-License-Identifier: Apache-2.0
// Vertex removal. The hole that a star leaves is filled by gift wrapping: the tetrahedron on a face is the one whose perturbed
// circumsphere is empty of the other link vertices, found by a tournament, O(faces x vertices) with about 26 x 15 tests in a
// refined mesh. Because the perturbation makes the triangulation unique and free of flat tetrahedra, every face finds its partner
// and the filling fits the boundary [Devillers03].
#include <algorithm>

#include "core/check.hpp"
#include "delaunay/collinear.hpp"
#include "delaunay/triangulation.hpp"

namespace wellmesh {

/// Fills one hole; lives for one call of find_hole, on the hole's scratch.
class HoleFiller {
public:
    HoleFiller(Triangulation& mesh, Hole& hole) : mesh_(mesh), hole_(hole), open_(hole.scratch.open), candidates_(hole.scratch.candidates), open_at_(hole.scratch.open_at) {
        open_.clear();
        open_at_.clear();
    }

    bool fill() {
        collect_boundary();
        candidates_.clear();
        for (std::uint32_t d = 1; d < mesh_.local_count_; ++d) candidates_.push_back(d);
        while (!open_.empty()) {
            const Open face = open_.back();
            open_.pop_back();
            count(face.corners, -1);
            if (!wrap(face)) return false;
            if (hole_.filling.size() > 8 * hole_.boundary.size() + 64) return false;  // can't happen: guards against a broken tie rule
        }
        return true;
    }

private:
    using Slots = Hole::Slots;
    using Open = Hole::OpenFace;

    static std::uint64_t key_of(Slots s) {
        std::sort(s.begin(), s.end());
        return (std::uint64_t{s[0]} << 42) | (std::uint64_t{s[1]} << 21) | s[2];
    }
    [[nodiscard]] VertexId vertex(std::uint32_t slot) const { return mesh_.local_[slot]; }
    [[nodiscard]] const Vec3& at(std::uint32_t slot) const { return mesh_.point(vertex(slot)); }

    void collect_boundary() {
        mesh_.clear_local_numbers(3 * hole_.star.size());
        hole_.boundary.clear();
        hole_.filling.clear();
        hole_.filling_opposite.clear();
        has_infinity_ = false;
        for (const TetId t : hole_.star) {
            const unsigned f = mesh_.tets_.find_corner(t, hole_.vertex);
            const TetFace inside{t, f};
            Slots s{};
            const auto corners = mesh_.tets_.face_corners(inside);
            for (std::size_t k = 0; k < 3; ++k) {
                s[k] = mesh_.local_number(corners[k]);
                has_infinity_ |= s[k] == 0;
            }
            const TetFace outside = mesh_.tets_.across(inside);
            open_.push_back({s, key_of(s), static_cast<std::uint32_t>(hole_.boundary.size()) | Hole::kBoundaryBit,
                             mesh_.tets_.corner(outside.tet(), outside.face())});
            count(s, 1);
            hole_.boundary.push_back({inside, outside});
        }
    }

    /// Keeps count of the open faces at each vertex. One without has no tetrahedron to come: it is a candidate no more.
    void count(const Slots& corners, std::int32_t by) {
        for (const std::uint32_t s : corners) {
            if (s >= open_at_.size()) open_at_.resize(s + 1, 0);
            open_at_[s] += by;
        }
    }

    /// Is d in conflict with the ghost on hull face (a, b, c), positive side outside?
    [[nodiscard]] bool beats_ghost(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const {
        const Sign side = mesh_.filter_.orient3d(at(a), at(b), at(c), at(d));
        if (side != Sign::zero) return side == Sign::positive;
        // Coplanar: any point below the plane makes a tetrahedron whose circumsphere cuts the plane in the circle of abc.
        for (std::uint32_t z = 1; z < mesh_.local_count_; ++z) {
            const Sign below = mesh_.filter_.orient3d(at(a), at(b), at(c), at(z));
            if (below == Sign::zero) continue;
            const bool inside = below == Sign::positive
                                    ? mesh_.filter_.insphere_perturbed(at(a), at(b), at(c), at(z), at(d)) == Sign::positive
                                    : mesh_.filter_.insphere_perturbed(at(b), at(a), at(c), at(z), at(d)) == Sign::positive;
            return inside;
        }
        return false;  // all link vertices in one plane: the caller gives up later, when a face finds no apex
    }

    /// Is d in the plane of hull face (a, b, w), on w's side of the line ab? All other points turn about ab by 0 to 180 degrees from there;
    /// a point at 0 must not meet one at 180 in the tournament: they are coplanar.
    [[nodiscard]] bool folds_back(std::uint32_t a, std::uint32_t b, const Vec3& w, std::uint32_t d) const {
        if (mesh_.filter_.orient3d(at(a), at(b), w, at(d)) != Sign::zero) return false;
        for (std::uint32_t z = 1; z < mesh_.local_count_; ++z) {
            const Sign side = mesh_.filter_.orient3d(at(a), at(b), w, at(z));
            if (side != Sign::zero) return mesh_.filter_.orient3d(at(a), at(b), at(d), at(z)) == side;
        }
        return false;
    }

    std::uint32_t best_apex(Slots& s, VertexId behind) {
        constexpr std::uint32_t kNobody = 0xffffffffU;
        std::uint32_t best = kNobody;
        if (s[0] == 0 || s[1] == 0 || s[2] == 0) {
            // (s0, s1, inf, d) positive means that hull face (s1, s0, d) has its positive side outside.
            while (s[2] != 0) s = {s[1], s[2], s[0]};
            for (std::uint32_t d = 1; d < mesh_.local_count_; ++d) {
                if (d == s[0] || d == s[1] || collinear(at(s[0]), at(s[1]), at(d)) || folds_back(s[0], s[1], mesh_.point(behind), d)) continue;
                if (best == kNobody || beats_ghost(s[1], s[0], best, d)) best = d;
            }
            return best;
        }
        const Vec3 &a = at(s[0]), &b = at(s[1]), &c = at(s[2]);
        for (const std::uint32_t d : candidates_) {
            if (d == s[0] || d == s[1] || d == s[2]) continue;
            if (mesh_.filter_.orient3d(a, b, c, at(d)) != Sign::positive) continue;
            if (best == kNobody || mesh_.filter_.insphere_perturbed_padded(a, b, c, at(best), at(d)) == Sign::positive) best = d;
        }
        if (best == kNobody && has_infinity_) return 0;
        return best;
    }

    bool wrap(Open face) {
        Slots s = face.corners;
        const std::uint32_t apex = best_apex(s, face.behind);
        if (apex == 0xffffffffU) return false;
        const auto index = static_cast<std::uint32_t>(hole_.filling.size());
        // Corner order as in Triangulation::insert_vertex: infinity last.
        std::array<std::uint32_t, 4> corners{};
        if (s[2] == 0) corners = {s[1], s[0], apex, 0};
        else corners = {s[0], s[1], s[2], apex};
        hole_.filling.push_back({vertex(corners[0]), vertex(corners[1]), vertex(corners[2]), vertex(corners[3])});
        hole_.filling_opposite.push_back({});
        const unsigned base = s[2] == 0 ? 2 : 3;  // corner opposite to the face that was wrapped
        for (unsigned f = 0; f < 4; ++f) {
            if (f == base) {
                pair(index, f, face.owner);
                continue;
            }
            // From the far side the face is listed the other way round.
            const Slots mine{corners[kFaceCorners[f][0]], corners[kFaceCorners[f][2]], corners[kFaceCorners[f][1]]};
            const std::uint64_t key = key_of(mine);
            auto it = std::find_if(open_.begin(), open_.end(), [&](const Open& o) { return o.key == key; });
            if (it == open_.end()) {
                open_.push_back({mine, key, 4 * index + f, vertex(corners[f])});
                count(mine, 1);
            } else {
                pair(index, f, it->owner);
                count(mine, -1);
                *it = open_.back();
                open_.pop_back();
            }
        }
        std::erase_if(candidates_, [&](std::uint32_t d) { return open_at_[d] == 0; });
        return true;
    }

    void pair(std::uint32_t index, unsigned f, std::uint32_t owner) {
        hole_.filling_opposite[index][f] = owner;
        if ((owner & Hole::kBoundaryBit) == 0) hole_.filling_opposite[owner / 4][owner % 4] = 4 * index + f;
    }

    Triangulation& mesh_;
    Hole& hole_;
    std::vector<Open>& open_;
    std::vector<std::uint32_t>& candidates_;  // finite vertices that a tetrahedron may still get
    std::vector<std::int32_t>& open_at_;      // open faces at each vertex
    bool has_infinity_ = false;
};

bool Triangulation::find_hole(VertexId v, Hole& hole, std::size_t most_tets) {
    hole.vertex = v;
    if (!find_star(v, hole.star) || hole.star.size() > most_tets) return false;
    if (is_view())
        for (const TetId t : hole.star) {
            // Whether a ghost is in conflict may be asked of the tetrahedron behind it: as when v is put back.
            const TetId n = tets_.across(t, tets_.find_corner(t, v)).tet();
            if (!may_enter<true>(n) || (tets_.is_ghost(n) && !may_enter<true>(tets_.across(n, 3).tet()))) return false;
        }
    return HoleFiller(*this, hole).fill();
}

void Triangulation::remove_vertex(const Hole& hole) {
    new_tets_.clear();
    outside_.clear();
    for (const BoundaryFace& b : hole.boundary) outside_.push_back(b.outside);
    for (std::size_t i = 0; i < hole.filling.size(); ++i) {
        const TetId t = i < hole.star.size() ? hole.star[i] : tets_.allocate();
        new_tets_.push_back(t);
        tets_.set_corners(t, hole.filling[i]);
    }
    for (std::size_t i = hole.filling.size(); i < hole.star.size(); ++i) tets_.release(hole.star[i]);
    for (std::size_t i = 0; i < hole.filling.size(); ++i) {
        for (unsigned f = 0; f < 4; ++f) {
            const std::uint32_t other = hole.filling_opposite[i][f];
            const TetFace mine{new_tets_[i], f};
            if ((other & Hole::kBoundaryBit) != 0) tets_.connect(mine, outside_[other & ~Hole::kBoundaryBit]);
            else if (other / 4 > i || (other / 4 == i)) tets_.connect(mine, TetFace{new_tets_[other / 4], other % 4});
        }
        for (const VertexId v : hole.filling[i])
            if (v != kInfiniteVertex) vertices_[v.index()].tet = new_tets_[i];
    }
    // A ghost is a poor place to start walking from: prefer finite tetrahedra.
    for (std::size_t i = 0; i < hole.filling.size(); ++i)
        if (hole.filling[i][3] != kInfiniteVertex)
            for (const VertexId v : hole.filling[i]) vertices_[v.index()].tet = new_tets_[i];
    vertices_[hole.vertex.index()].tet = TetId{};
    last_located_ = new_tets_[0];
}

}  // namespace wellmesh
