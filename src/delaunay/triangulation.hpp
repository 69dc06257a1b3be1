// SPDX-License-Identifier: Apache-2.0
// Incremental Delaunay triangulation in three dimensions with removal of vertices and cavities that are found but not committed.
//
// Insertion is Bowyer's and Watson's: delete the tetrahedra whose circumsphere contains the point, join the point to the boundary
// of the hole [Bowyer81, Watson81]. Bulk insertion goes in BRIO order along a Hilbert curve [Amenta03]; points are located by a
// visibility walk, which cannot cycle in a Delaunay triangulation [Devillers02]. The convex hull is closed by ghost tetrahedra on
// one vertex at infinity. Cospherical ties are broken symbolically in lexicographic order of coordinates [Devillers03], so the
// triangulation is a function of the point set alone, cavities are star-shaped, no tetrahedron is flat, and any vertex can be removed.
//
// Not thread-safe, not even for reading: searches use scratch marks.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/ids.hpp"
#include "delaunay/tet_store.hpp"
#include "predicates/predicates.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh {

/// A face of the boundary of a cavity or hole: its inside tetrahedron is to be deleted, its outside one stays.
struct BoundaryFace {
    TetFace inside, outside;
};

/// The tetrahedra that a point would delete. Valid until the triangulation changes.
struct Cavity {
    Vec3 point{};
    std::vector<TetId> tets;
    std::vector<BoundaryFace> boundary;
    VertexId duplicate{};  ///< the vertex at `point`, if there is one; the cavity is empty then
};

/// The star of a vertex and the tetrahedra that would fill it once the vertex is gone. Valid until the triangulation changes.
struct Hole {
    VertexId vertex{};
    std::vector<TetId> star;
    std::vector<BoundaryFace> boundary;
    std::vector<TetStore::Corners> filling;
    /// For each filling tetrahedron and face: index of the neighbour in `filling`, times 4, plus its face; or, with the top bit
    /// set, index into `boundary`.
    std::vector<std::array<std::uint32_t, 4>> filling_opposite;
    static constexpr std::uint32_t kBoundaryBit = 0x80000000U;
};

/// Numbers 0, 1, 2, ... for the few vertices of one cavity, in order of first mention; 0 is the vertex at infinity. A small hash table
/// that stays in the first-level cache, unlike an array over all vertices; emptied by a new stamp.
class LocalNumbers {
public:
    void clear() {
        vertices_.clear();
        vertices_.push_back(kInfiniteVertex);
        if (++stamp_ == 0) {
            table_.assign(table_.size(), Entry{});
            stamp_ = 1;
        }
    }
    std::uint32_t operator()(VertexId v) {
        if (v == kInfiniteVertex) return 0;
        if (2 * vertices_.size() > table_.size()) grow();
        for (std::size_t i = (v.value() * 0x9e3779b1U) & (table_.size() - 1);; i = (i + 1) & (table_.size() - 1)) {
            Entry& e = table_[i];
            if (e.stamp != stamp_) {
                e = {v, stamp_, static_cast<std::uint32_t>(vertices_.size())};
                vertices_.push_back(v);
                return e.number;
            }
            if (e.vertex == v) return e.number;
        }
    }
    [[nodiscard]] std::size_t size() const { return vertices_.size(); }
    [[nodiscard]] VertexId vertex(std::uint32_t number) const { return vertices_[number]; }

private:
    struct Entry {
        VertexId vertex{};
        std::uint32_t stamp = 0, number = 0;
    };
    void grow() {
        const std::vector<VertexId> known(vertices_.begin() + 1, vertices_.end());
        table_.assign(2 * table_.size(), Entry{});
        clear();
        for (const VertexId v : known) (*this)(v);
    }
    std::vector<Entry> table_ = std::vector<Entry>(256);
    std::vector<VertexId> vertices_;
    std::uint32_t stamp_ = 0;
};

class Triangulation {
public:
    Triangulation() = default;
    /// @param lo, hi  box of all points that will ever be inserted: the static filter is valid there only.
    Triangulation(const Vec3& lo, const Vec3& hi) : filter_(Vec3{hi.x - lo.x, hi.y - lo.y, hi.z - lo.z}), lo_(lo), hi_(hi) {}

    /// Starts from four vertices that are not coplanar (ids into points()), already added by add_point.
    void start(VertexId a, VertexId b, VertexId c, VertexId d);

    /// Inserts all of `points` (duplicates are skipped) in a spatially sorted random order; vertex i is points[i].
    /// @return false if all points are coplanar; then nothing was triangulated. Duplicates: see `duplicate_count`.
    bool insert_all(std::span<const Vec3> points);
    /// The same for points that are in biased_spatial_order() already: neighbours in space are neighbours in memory then.
    bool insert_all_in_order(std::span<const Vec3> points);

    // --- vertices
    VertexId add_point(const Vec3& p);  ///< stores coordinates, no more
    [[nodiscard]] const Vec3& point(VertexId v) const { return points_[v.index()]; }
    [[nodiscard]] const std::vector<Vec3>& points() const { return points_; }
    [[nodiscard]] bool is_inserted(VertexId v) const { return vertex_tet_[v.index()].valid(); }
    /// Some tetrahedron of the star of v.
    [[nodiscard]] TetId tet_of(VertexId v) const { return vertex_tet_[v.index()]; }
    [[nodiscard]] std::size_t duplicate_count() const { return duplicates_; }

    // --- queries
    [[nodiscard]] const TetStore& tets() const { return tets_; }
    [[nodiscard]] const PredicateFilter& predicates() const { return filter_; }
    /// The tetrahedron that contains p, or a ghost whose hull face p lies strictly beyond.
    [[nodiscard]] TetId locate(const Vec3& p, TetId hint) const;
    [[nodiscard]] bool in_conflict(TetId t, const Vec3& p) const;
    /// All tetrahedra in conflict with p. @param near  where to start walking.
    /// @return false, with cavity.duplicate set, if there is a vertex at p.
    bool find_conflict_cavity(const Vec3& p, TetId near, Cavity& cavity);
    /// After find_conflict_cavity and before any change: is t in that cavity?
    [[nodiscard]] bool in_last_cavity(TetId t) const { return mark_[t.index()] == epoch_ + 1; }
    /// Tetrahedra of the star of v, ghosts included.
    void find_star(VertexId v, std::vector<TetId>& star);
    /// Some tetrahedron that has the edge, or an invalid id.
    [[nodiscard]] TetId find_edge(VertexId a, VertexId b);
    /// The face abc seen from one side, or an invalid one.
    [[nodiscard]] TetFace find_face(VertexId a, VertexId b, VertexId c);

    // --- changes
    /// Joins v, whose point must be cavity.point, to the boundary. New tetrahedron i (ids in new_tets()) stands on boundary face i,
    /// with v as corner 3, or as corner 2 of a ghost.
    void insert_vertex(VertexId v, const Cavity& cavity);
    [[nodiscard]] const std::vector<TetId>& new_tets() const { return new_tets_; }

    /// Triangulates the hole that v would leave. @return false if v can't go (fewer than four affinely independent points would stay).
    bool find_hole(VertexId v, Hole& hole);
    /// Replaces the star by the filling (ids in new_tets(), in the order of hole.filling). The point stays stored, not inserted.
    void remove_vertex(const Hole& hole);
    void set_point(VertexId v, const Vec3& p) { points_[v.index()] = p; }  ///< @pre v is not inserted

    void reserve(std::size_t vertices);

private:
    TetId create_tet(std::size_t recycled, const std::vector<TetId>& pool);
    void ensure_marks();
    void next_epoch();
    [[nodiscard]] bool ghost_in_conflict(TetId t, const Vec3& p) const;
    bool insert_order(std::span<const std::uint32_t> order);

    TetStore tets_;
    PredicateFilter filter_;
    Vec3 lo_{}, hi_{};
    std::vector<Vec3> points_;
    std::vector<TetId> vertex_tet_;
    std::size_t duplicates_ = 0;

    // scratch
    std::vector<std::uint32_t> mark_;  // per tet: epoch_ visited and not in conflict, epoch_ + 1 in conflict
    std::uint32_t epoch_ = 0;
    std::vector<TetId> new_tets_;
    std::vector<TetId> star_stack_;
    std::vector<TetFace> outside_;
    LocalNumbers local_;
    std::vector<TetFace> edge_table_;
    mutable TetId last_located_{};

    friend class HoleFiller;
};

/// Permutation of 0..n-1: rounds of doubling size, each sorted along a Hilbert curve; deterministic.
[[nodiscard]] std::vector<std::uint32_t> biased_spatial_order(std::span<const Vec3> points);

}  // namespace wellmesh
