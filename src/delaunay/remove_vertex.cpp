// SPDX-License-Identifier: Apache-2.0
// Vertex removal. The hole that a star leaves is filled by gift wrapping: the tetrahedron on a face is the one whose perturbed
// circumsphere is empty of the other link vertices, O(faces x vertices) with about 26 x 15 tests in a refined mesh. The static filter
// nominates it and sees nearly all others lose to it; a tournament decides among those that are left. Because the perturbation makes
// the triangulation unique and free of flat tetrahedra, every face finds its partner and the filling fits the boundary [Devillers03].
#include <algorithm>
#include <bit>

#include "core/check.hpp"
#include "delaunay/collinear.hpp"
#include "delaunay/triangulation.hpp"

namespace wellmesh {

/// Fills one hole; lives for one call of find_hole, on the hole's scratch.
class HoleFiller {
public:
    HoleFiller(Triangulation& mesh, Hole& hole)
        : mesh_(mesh), hole_(hole), faces_(hole.scratch.faces), open_(hole.scratch.open), buckets_(hole.scratch.buckets) {}

    bool fill() {
        collect_boundary();
        while (!open_.empty()) {
            const Face face = faces_[open_.back()];
            close(open_.back());
            if (!wrap(face)) return false;
            if (hole_.filling.size() > 8 * hole_.boundary.size() + 64) return false;  // can't happen: guards against a broken tie rule
        }
        return true;
    }

private:
    using Corners = Hole::LinkFace;
    using Face = Hole::Face;
    static constexpr std::uint32_t kNone = 0xffffffffU;

    static std::uint64_t key_of(const Corners& c) {
        const std::uint32_t low = std::min(c[0], c[1]), high = std::max(c[0], c[1]);
        const std::uint64_t least = std::min(low, c[2]), middle = std::max(low, std::min(high, c[2])), most = std::max(high, c[2]);
        return (least << 42) | (middle << 21) | most;
    }
    [[nodiscard]] const Vec3& at(std::uint32_t number) const { return mesh_.point(hole_.link[number]); }
    [[nodiscard]] std::uint32_t link_size() const { return static_cast<std::uint32_t>(hole_.link.size()); }

    void collect_boundary() {
        mesh_.clear_local_numbers(3 * hole_.star.size());
        hole_.boundary.clear();
        hole_.link_faces.clear();
        hole_.filling.clear();
        hole_.filling_opposite.clear();
        faces_.clear();
        open_.clear();
        shift_ = 64U - static_cast<unsigned>(std::bit_width(4 * hole_.star.size()));
        buckets_.assign(std::size_t{1} << (64 - shift_), kNone);
        has_infinity_ = false;
        for (const TetId t : hole_.star) {
            const TetFace inside{t, mesh_.tets_.find_corner(t, hole_.vertex)};
            Corners c{};
            const auto corners = mesh_.tets_.face_corners(inside);
            for (std::size_t k = 0; k < 3; ++k) {
                c[k] = mesh_.local_number(corners[k]);
                has_infinity_ |= c[k] == 0;
            }
            const auto index = static_cast<std::uint32_t>(hole_.boundary.size());
            open(c, key_of(c), index | Hole::kBoundaryBit);
            hole_.boundary.push_back({inside, mesh_.tets_.across(inside)});
            hole_.link_faces.push_back(c);
        }
        hole_.link.assign(mesh_.local_.begin(), mesh_.local_.begin() + mesh_.local_count_);
        hole_.scratch.points.reset(hole_.link.size());
        for (std::uint32_t i = 1; i < link_size(); ++i) hole_.scratch.points.set(i, at(i));
    }

    std::uint32_t& bucket_of(std::uint64_t key) { return buckets_[(key * 0x9e3779b97f4a7c15U) >> shift_]; }
    void open(const Corners& corners, std::uint64_t key, std::uint32_t owner) {
        const auto face = static_cast<std::uint32_t>(faces_.size());
        std::uint32_t& bucket = bucket_of(key);
        faces_.push_back({corners, owner, key, bucket, static_cast<std::uint32_t>(open_.size())});
        bucket = face;
        open_.push_back(face);
    }
    /// It stays in its bucket: hardly any is looked for there again.
    void close(std::uint32_t face) {
        const std::uint32_t place = faces_[face].place, last = open_.back();
        open_[place] = last;
        faces_[last].place = place;
        faces_[face].place = kNone;
        open_.pop_back();
    }
    [[nodiscard]] std::uint32_t find_open(std::uint64_t key) {
        std::uint32_t face = bucket_of(key);
        while (face != kNone && (faces_[face].key != key || faces_[face].place == kNone)) face = faces_[face].next;
        return face;
    }

    /// Is d in conflict with the ghost on hull face (a, b, c), positive side outside?
    [[nodiscard]] bool beats_ghost(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const {
        const Sign side = mesh_.filter_.orient3d(at(a), at(b), at(c), at(d));
        if (side != Sign::zero) return side == Sign::positive;
        // Coplanar: any point below the plane makes a tetrahedron whose circumsphere cuts the plane in the circle of abc.
        for (std::uint32_t z = 1; z < link_size(); ++z) {
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
        for (std::uint32_t z = 1; z < link_size(); ++z) {
            const Sign side = mesh_.filter_.orient3d(at(a), at(b), w, at(z));
            if (side != Sign::zero) return mesh_.filter_.orient3d(at(a), at(b), at(d), at(z)) == side;
        }
        return false;
    }

    /// The corner opposite to the face of what is behind it.
    [[nodiscard]] const Vec3& point_behind(const Face& face) const {
        if ((face.owner & Hole::kBoundaryBit) == 0) return at(hole_.filling[face.owner / 4][face.owner % 4]);
        const TetFace outside = hole_.boundary[face.owner & ~Hole::kBoundaryBit].outside;
        return mesh_.point(mesh_.tets_.corner(outside.tet(), outside.face()));
    }

    /// (c0, c1, inf, d) positive means that hull face (c1, c0, d) has its positive side outside.
    [[nodiscard]] std::uint32_t best_apex_at_infinity(const Corners& c, const Vec3& behind) const {
        std::uint32_t best = kNone;
        for (std::uint32_t d = 1; d < link_size(); ++d) {
            if (d == c[0] || d == c[1] || collinear(at(c[0]), at(c[1]), at(d)) || folds_back(c[0], c[1], behind, d)) continue;
            if (best == kNone || beats_ghost(c[1], c[0], best, d)) best = d;
        }
        return best;
    }

    [[nodiscard]] std::uint32_t best_apex(const Corners& corners) {
        std::uint32_t best = mesh_.filter_.nominate_apex(hole_.scratch.points, corners, hole_.scratch.rivals);
        const Vec3 &a = at(corners[0]), &b = at(corners[1]), &c = at(corners[2]);
        for (const std::uint32_t d : hole_.scratch.rivals) {
            if (mesh_.filter_.orient3d(a, b, c, at(d)) != Sign::positive) continue;
            if (best == kNone || mesh_.filter_.insphere_perturbed_padded(a, b, c, at(best), at(d)) == Sign::positive) best = d;
        }
        if (best == kNone && has_infinity_) return 0;
        return best;
    }

    bool wrap(const Face& face) {
        Corners c = face.corners;
        const bool at_infinity = c[0] == 0 || c[1] == 0 || c[2] == 0;
        if (at_infinity)
            while (c[2] != 0) c = {c[1], c[2], c[0]};
        const std::uint32_t apex = at_infinity ? best_apex_at_infinity(c, point_behind(face)) : best_apex(c);
        if (apex == kNone) return false;
        const auto index = static_cast<std::uint32_t>(hole_.filling.size());
        // Corner order as in Triangulation::insert_vertex: infinity last.
        const std::array<std::uint32_t, 4> corners = at_infinity ? std::array{c[1], c[0], apex, 0U} : std::array{c[0], c[1], c[2], apex};
        hole_.filling.push_back(corners);
        hole_.filling_opposite.push_back({});
        const unsigned base = at_infinity ? 2 : 3;  // corner opposite to the face that was wrapped
        for (unsigned f = 0; f < 4; ++f) {
            if (f == base) {
                pair(index, f, face.owner);
                continue;
            }
            // From the far side the face is listed the other way round.
            const Corners mine{corners[kFaceCorners[f][0]], corners[kFaceCorners[f][2]], corners[kFaceCorners[f][1]]};
            const std::uint64_t key = key_of(mine);
            if (const std::uint32_t other = find_open(key); other == kNone) {
                open(mine, key, 4 * index + f);
            } else {
                pair(index, f, faces_[other].owner);
                close(other);
            }
        }
        return true;
    }

    void pair(std::uint32_t index, unsigned f, std::uint32_t owner) {
        hole_.filling_opposite[index][f] = owner;
        if ((owner & Hole::kBoundaryBit) == 0) hole_.filling_opposite[owner / 4][owner % 4] = 4 * index + f;
    }

    Triangulation& mesh_;
    Hole& hole_;
    std::vector<Face>& faces_;
    std::vector<std::uint32_t>& open_;
    std::vector<std::uint32_t>& buckets_;
    unsigned shift_ = 0;  // from a key's hash to its bucket
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
        const auto& c = hole.filling[i];
        tets_.set_corners(t, {hole.link[c[0]], hole.link[c[1]], hole.link[c[2]], hole.link[c[3]]});
    }
    for (std::size_t i = hole.filling.size(); i < hole.star.size(); ++i) tets_.release(hole.star[i]);
    for (std::size_t i = 0; i < hole.filling.size(); ++i) {
        for (unsigned f = 0; f < 4; ++f) {
            const std::uint32_t other = hole.filling_opposite[i][f];
            const TetFace mine{new_tets_[i], f};
            if ((other & Hole::kBoundaryBit) != 0) tets_.connect(mine, outside_[other & ~Hole::kBoundaryBit]);
            else if (other / 4 > i || (other / 4 == i)) tets_.connect(mine, TetFace{new_tets_[other / 4], other % 4});
        }
        for (const VertexId v : tets_.corners(new_tets_[i]))
            if (v != kInfiniteVertex) vertices_[v.index()].tet = new_tets_[i];
    }
    // A ghost is a poor place to start walking from: prefer finite tetrahedra.
    for (std::size_t i = 0; i < hole.filling.size(); ++i)
        if (hole.filling[i][3] != 0)
            for (const VertexId v : tets_.corners(new_tets_[i])) vertices_[v.index()].tet = new_tets_[i];
    vertices_[hole.vertex.index()].tet = TetId{};
    last_located_ = new_tets_[0];
}

}  // namespace wellmesh
