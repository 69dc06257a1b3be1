// SPDX-License-Identifier: Apache-2.0
// The tetrahedra of a triangulation of the sphere S^3 as arrays: geometry lives elsewhere (triangulation.hpp).
//
// Anatomy of a tetrahedron (docs/conventions.md): corners 0..3 with orient3d(c0, c1, c2, c3) positive; face f is the triangle
// opposite corner f, listed by kFaceCorners[f] so that its three corners followed by corner f are positive too.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/ids.hpp"
#include "core/shared_array.hpp"
#include "core/workers.hpp"

namespace wellmesh {

/// The vertex at infinity; a tetrahedron that has it (always as corner 3) is a ghost: its face 3 lies on the convex hull.
inline constexpr VertexId kInfiniteVertex{std::uint32_t{0xfffffffeU}};

inline constexpr std::array<std::array<std::uint8_t, 3>, 4> kFaceCorners{{{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}}};
/// The corners but one, ascending.
inline constexpr std::array<std::array<std::uint8_t, 3>, 4> kOtherCorners{{{1, 2, 3}, {0, 2, 3}, {0, 1, 3}, {0, 1, 2}}};
/// Edge e joins these two corners; edge 5 - e is the one opposite.
inline constexpr std::array<std::array<std::uint8_t, 2>, 6> kEdgeCorners{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};
/// kEdgeOf[i][j]: the edge between corners i and j.
inline constexpr std::array<std::array<std::uint8_t, 4>, 4> kEdgeOf{{{7, 0, 1, 2}, {0, 7, 3, 4}, {1, 3, 7, 5}, {2, 4, 5, 7}}};

/// Face `face()` of tetrahedron `tet()`, packed into 32 bits: at most 2^30 tetrahedra.
class TetFace {
public:
    constexpr TetFace() = default;
    constexpr TetFace(TetId t, unsigned f) : packed_(4 * t.value() + f) {}
    [[nodiscard]] constexpr TetId tet() const { return TetId{packed_ >> 2}; }
    [[nodiscard]] constexpr unsigned face() const { return packed_ & 3U; }
    [[nodiscard]] constexpr bool valid() const { return packed_ != kNone; }
    friend constexpr auto operator<=>(TetFace, TetFace) = default;

private:
    static constexpr std::uint32_t kNone = 0xffffffffU;
    std::uint32_t packed_ = kNone;
};

/// One record of 32 bytes a tetrahedron, aligned so that a visit touches one cache line. Ids of deleted tetrahedra are reused last-freed first, so equal operation sequences give equal ids.
/// Invariant (check_adjacency): opposite(opposite(tf)) == tf and both sides name the same three vertices.
class TetStore {
public:
    using Corners = std::array<VertexId, 4>;

    [[nodiscard]] std::size_t slots() const { return tet_.size(); }  ///< live and free
    [[nodiscard]] std::size_t live() const { return tet_.size() - free_.size(); }
    [[nodiscard]] const Corners& corners(TetId t) const { return tet_[t.index()].corner; }
    [[nodiscard]] VertexId corner(TetId t, unsigned i) const { return tet_[t.index()].corner[i]; }
    [[nodiscard]] bool is_live(TetId t) const { return tet_[t.index()].corner[0].valid(); }
    [[nodiscard]] bool is_ghost(TetId t) const { return tet_[t.index()].corner[3] == kInfiniteVertex; }
    [[nodiscard]] bool is_finite(TetId t) const { return is_live(t) && !is_ghost(t); }
    [[nodiscard]] TetFace across(TetFace tf) const { return tet_[tf.tet().index()].opposite[tf.face()]; }
    [[nodiscard]] TetFace across(TetId t, unsigned f) const { return tet_[t.index()].opposite[f]; }
    [[nodiscard]] const std::array<TetFace, 4>& across_all(TetId t) const { return tet_[t.index()].opposite; }
    /// Slot of v in t; 4 if v is no corner of t.
    [[nodiscard]] unsigned find_corner(TetId t, VertexId v) const {
        const Corners& c = tet_[t.index()].corner;
        return c[0] == v ? 0U : c[1] == v ? 1U : c[2] == v ? 2U : c[3] == v ? 3U : 4U;
    }
    [[nodiscard]] std::array<VertexId, 3> face_corners(TetFace tf) const {
        const Corners& c = tet_[tf.tet().index()].corner;
        const auto& f = kFaceCorners[tf.face()];
        return {c[f[0]], c[f[1]], c[f[2]]};
    }

    /// @throws MeshError{mesh_too_large} beyond 2^30 tetrahedra.
    TetId allocate();
    void release(TetId t);
    void set_corners(TetId t, const Corners& corners) { tet_[t.index()].corner = corners; }
    void connect(TetFace a, TetFace b) {
        tet_[a.tet().index()].opposite[a.face()] = b;
        tet_[b.tet().index()].opposite[b.face()] = a;
    }
    void set(TetId t, const Corners& corners, const std::array<TetFace, 4>& opposite) { tet_[t.index()] = {corners, opposite}; }
    /// One side of connect().
    void set_across(TetFace a, TetFace b) { tet_[a.tet().index()].opposite[a.face()] = b; }
    /// Asks for the record ahead of its use; never faults.
    void prefetch(TetId t) const { __builtin_prefetch(tet_.data() + t.index()); }
    void reserve(std::size_t tets) { tet_.reserve(tets); }
    void clear();
    [[nodiscard]] std::size_t capacity() const { return tet_.capacity(); }
    /// Slots that hold none, the next one to be taken last.
    [[nodiscard]] const std::vector<TetId>& free_slots() const { return free_; }
    /// As many slots as there were once, these of them free: for an undo, after which they hold what they did then.
    void cut_back(std::size_t slots, const std::vector<TetId>& free) {
        tet_.resize_as_is(slots);
        free_ = free;
    }
    /// Tetrahedron t[i] becomes number i; what is not listed is forgotten, and no slot is free. Adjacencies name the new numbers already.
    /// @param scratch  one for each slot
    void reorder(std::span<const TetId> t, std::span<TetId> scratch, Workers& workers);

    // --- views, for several workers at once (Triangulation::insert_in_zones)
    /// Slots for a view. Whoever takes them for many lets each worker write its own list.
    struct Slots {
        std::vector<TetId> recycled;
        std::size_t first = 0, count = 0;  ///< new ones
        /// In an order that depends on the slots alone.
        [[nodiscard]] std::vector<TetId> list() &&;
    };
    /// The same tetrahedra, with `slots` free ones of its own: take_slots() made them. Valid until this store grows.
    [[nodiscard]] TetStore view(std::vector<TetId> slots);
    /// Slots that are on no free list any more, new ones at the end if there are not as many free: these hold anything. @throws as allocate()
    [[nodiscard]] Slots take_slots(std::size_t count);
    /// By the worker that is to hold them, before it empties them.
    void touch(const Slots& slots) { tet_.touch(slots.first, slots.count); }
    void empty(TetId t) { tet_[t.index()].corner[0] = VertexId{}; }
    /// How many tetrahedra a view can still hold.
    [[nodiscard]] std::size_t room() const { return free_.size(); }
    /// Takes over what a view has left.
    void take_back(const TetStore& view) { free_.insert(free_.end(), view.free_.begin(), view.free_.end()); }

private:
    static constexpr std::size_t kMaxTets = (std::size_t{1} << 30) - 1;  // TetFace packs 4 t + f into 32 bits, all ones is "none"
    struct alignas(32) Tet {
        Corners corner{};
        std::array<TetFace, 4> opposite{};
    };
    static_assert(sizeof(Tet) == 32);
    void reorder_in_place(std::span<const TetId> t, std::span<TetId> place);

    SharedArray<Tet> tet_;
    std::vector<TetId> free_;
};

}  // namespace wellmesh
