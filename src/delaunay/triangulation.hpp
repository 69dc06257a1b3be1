// SPDX-License-Identifier: Apache-2.0
// Incremental Delaunay triangulation in three dimensions with removal of vertices and cavities that are found but not committed.
//
// Insertion is Bowyer's and Watson's: delete the tetrahedra whose circumsphere contains the point, join the point to the boundary
// of the hole [Bowyer81, Watson81]. Bulk insertion goes in BRIO order along a Hilbert curve [Amenta03]; points are located by a
// visibility walk, which cannot cycle in a Delaunay triangulation [Devillers02]. The convex hull is closed by ghost tetrahedra on
// one vertex at infinity. Cospherical ties are broken symbolically in lexicographic order of coordinates [Devillers03], so the
// triangulation is a function of the point set alone, cavities are star-shaped, no tetrahedron is flat, and any vertex can be removed.
//
// Not thread-safe, not even for reading but for locate(): searches use scratch marks. Bulk insertion shares its work out itself, to views that touch nothing in common.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/checkpoint.hpp"
#include "core/ids.hpp"
#include "core/shared_array.hpp"
#include "core/workers.hpp"
#include "delaunay/local_numbers.hpp"
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
    /// Vertices of the link; infinity is number 0, whether it is one or not. These numbers stand for vertices below.
    std::vector<VertexId> link;
    using LinkFace = std::array<std::uint32_t, 3>;
    std::vector<BoundaryFace> boundary;  ///< face i is of star tetrahedron i
    std::vector<LinkFace> link_faces;    ///< its corners, listed as the star tetrahedron's face
    std::vector<std::array<std::uint32_t, 4>> filling;
    /// For each filling tetrahedron and face: index of the neighbour in `filling`, times 4, plus its face; or, with the top bit
    /// set, index into `boundary`.
    std::vector<std::array<std::uint32_t, 4>> filling_opposite;
    static constexpr std::uint32_t kBoundaryBit = 0x80000000U;

    struct Face {
        LinkFace corners;     // listed so that the wanted apex lies on the positive side
        std::uint32_t owner;  // what is behind: boundary index with top bit, or 4 * filling + face
        std::uint64_t key;    // of the unordered triple
        std::uint32_t next;   // in its bucket
        std::uint32_t place;  // in `open`, or none
    };
    /// Of the search; of no use afterwards.
    struct Scratch {
        std::vector<Face> faces;             // all that have been open
        std::vector<std::uint32_t> open;     // numbers of those that are
        std::vector<std::uint32_t> buckets;  // the last face in each
        PointColumns points;                 // of the link
        std::vector<std::uint32_t> rivals;
    } scratch;
};

class Zones;
struct ZoneViews;
class KnownTets;
struct KnownRegion;

/// Takes part in bulk insertion.
class BulkObserver {
public:
    virtual ~BulkObserver() = default;
    /// There are this many slots for tetrahedra from now on.
    virtual void make_room(std::size_t slots) = 0;
    /// From now until join() the observers for_zone(0), ... for_zone(zones - 1) are asked instead, from several threads at once, each about vertices and
    /// tetrahedra that no other one touches meanwhile.
    virtual void split(std::size_t zones) = 0;
    virtual BulkObserver& for_zone(std::size_t zone) = 0;
    virtual void join() = 0;
    /// Is a vertex at p welcome, which this tetrahedron holds, or beyond this ghost's face? Asked before its cavity is known.
    virtual bool welcomes(const Vec3& p, TetId holder) = 0;
    enum class Answer : std::uint8_t { yes, never, not_now };
    /// Called just before the point of the cavity becomes vertex v; it does not if the answer isn't yes.
    virtual Answer prepare(VertexId v, const Cavity& cavity) = 0;
    /// ... and just after. Tetrahedron i stands on face i of the cavity's boundary.
    virtual void made(VertexId v, const std::vector<TetId>& tets) = 0;
    /// Asked now and then; once it has said no to one thread it says so to all.
    virtual bool may_go_on() = 0;
};

class Triangulation {
public:
    Triangulation() = default;
    /// @param lo, hi  box of all points that will ever be inserted: the static filter is valid there only.
    Triangulation(const Vec3& lo, const Vec3& hi) : filter_(Vec3{hi.x - lo.x, hi.y - lo.y, hi.z - lo.z}), low_(lo), high_(hi) {}
    /// Is p in the box of all points that may be inserted? Others may be searched for, more slowly.
    [[nodiscard]] bool in_box(const Vec3& p) const {
        return low_.x <= p.x && p.x <= high_.x && low_.y <= p.y && p.y <= high_.y && low_.z <= p.z && p.z <= high_.z;
    }

    /// That box.
    [[nodiscard]] const Vec3& low() const { return low_; }
    [[nodiscard]] const Vec3& high() const { return high_; }

    /// Starts from four vertices that are not coplanar (ids), already added by add_point.
    void start(VertexId a, VertexId b, VertexId c, VertexId d);

    /// Inserts all of `points` (duplicates are skipped) in a spatially sorted random order; vertex i is points[i].
    /// @return false if all points are coplanar; then nothing was triangulated. Duplicates: see `duplicate_count`.
    bool insert_all(std::span<const Vec3> points, const Checkpoint& checkpoint = {});
    /// The same, but vertex i is points[order[i]]: with biased_spatial_order(points) neighbours in space are neighbours in memory. The ids of tetrahedra depend
    /// on the number of workers; visit_in_canonical_order() and renumber() do not.
    bool insert_all_in_order(std::span<const Vec3> points, std::span<const std::uint32_t> order, Workers& workers);

    // --- vertices
    VertexId add_point(const Vec3& p);  ///< stores coordinates, no more
    /// Numbers for n more, the first of which is returned; set_new_point() stores their coordinates, on any thread.
    VertexId add_points(std::size_t n);
    void set_new_point(VertexId v, const Vec3& p) { vertices_[v.index()] = {p}; }
    [[nodiscard]] const Vec3& point(VertexId v) const { return vertices_[v.index()].point; }
    [[nodiscard]] std::size_t vertex_count() const { return vertices_.size(); }  ///< stored, inserted or not
    [[nodiscard]] bool is_inserted(VertexId v) const { return vertices_[v.index()].tet.valid(); }
    /// Some tetrahedron of the star of v.
    [[nodiscard]] TetId tet_of(VertexId v) const { return vertices_[v.index()].tet; }
    [[nodiscard]] std::size_t duplicate_count() const { return duplicates_.size(); }

    // --- queries
    [[nodiscard]] const TetStore& tets() const { return tets_; }
    [[nodiscard]] const PredicateFilter& predicates() const { return filter_; }
    /// The tetrahedron that contains p, or a ghost whose hull face p lies strictly beyond.
    [[nodiscard]] TetId locate(const Vec3& p, TetId hint) const;
    [[nodiscard]] bool in_conflict(TetId t, const Vec3& p) const;
    /// All tetrahedra in conflict with p. @param near  where to start walking.
    /// @return false, with cavity.duplicate set, if there is a vertex at p; or if the search left the zone.
    bool find_conflict_cavity(const Vec3& p, TetId near, Cavity& cavity);
    /// The same from a tetrahedron that is in conflict with p, for as long as `accept` says yes to the boundary's faces, one by one as they
    /// are found. @return false if it said no: the cavity is incomplete then. @pre p is no vertex's point
    template <class Accept>
    bool grow_conflict_cavity(const Vec3& p, TetId seed, Cavity& cavity, const Accept& accept) {
        if (is_view()) return grow_cavity<true>(p, seed, cavity, accept);
        return grow_cavity<false>(p, seed, cavity, accept);
    }
    /// After a cavity was found and before any change: is t in that cavity?
    [[nodiscard]] bool in_last_cavity(TetId t) const { return mark_[t.index()] == epoch_ + 1; }
    /// Tetrahedra of the star of v, ghosts included. @return false: it is not all in the zone, and incomplete
    bool find_star(VertexId v, std::vector<TetId>& star);
    /// Some tetrahedron that has the edge, or an invalid id.
    [[nodiscard]] TetId find_edge(VertexId a, VertexId b);
    /// The face abc seen from one side, or an invalid one.
    [[nodiscard]] TetFace find_face(VertexId a, VertexId b, VertexId c);

    // --- changes
    /// Joins v, whose point must be cavity.point, to the boundary. New tetrahedron i (ids in new_tets()) stands on boundary face i,
    /// with v as corner 3, or as corner 2 of a ghost.
    void insert_vertex(VertexId v, const Cavity& cavity);
    [[nodiscard]] const std::vector<TetId>& new_tets() const { return new_tets_; }

    // --- known tetrahedra instead of those that are there (replace_region.cpp)
    /// What lies within the rim. @param goes_on  asked now and then
    /// @return false: the rim is not all there, or encloses a vertex that none of the known ones has, or `goes_on` said no; nothing has changed in any case
    bool find_region(Workers& workers, const KnownTets& known, KnownRegion& region, const std::function<bool()>& goes_on);
    /// Known tetrahedron n becomes region.tet(n). @param region  as find_region() left it, and nothing has changed since
    void replace_region(Workers& workers, const KnownTets& known, KnownRegion& region);

    // --- several workers at once (insert_in_zones.cpp)
    /// Inserts stored points, all but duplicates and those that `observer` refuses, on all workers. The tetrahedra are those of insertion one by one, their
    /// ids are not. @param order  vertices, neighbours in space near each other
    /// @return what was refused, or not begun when the observer said stop  @pre four vertices are inserted
    std::vector<std::uint32_t> insert_on(Workers& workers, std::span<const std::uint32_t> order, BulkObserver* observer = nullptr);
    // --- zones (zones.hpp)
    /// Makes a view of each zone, with `spare` tetrahedra to grow by. Until each is joined the whole must not be touched, and views only insert and remove vertices
    /// that are stored already, and set the points of those that were put aside for them.
    void split(Workers& workers, const Zones& zones, std::size_t spare, ZoneViews& out);
    void join(const Triangulation& view);
    [[nodiscard]] bool is_view() const { return zone_of_tet_ != nullptr; }
    /// Of a view: has anything failed since forget_leaving() because it would have left the zone, or found no room? On the whole mesh nothing does.
    [[nodiscard]] bool left_zone() const { return left_zone_; }
    void forget_leaving() { left_zone_ = false; }
    /// May a tetrahedron be looked at, that may be gone or another by now? Views only look at what is in their zones.
    [[nodiscard]] bool may_look_at(TetId t) const { return !is_view() || is_mine(t); }
    /// For what a view can't do for other reasons.
    void leave_zone() { left_zone_ = is_view(); }
    /// Can there be so many tetrahedra more? Only views are limited.
    [[nodiscard]] bool has_room(std::size_t more) const {
        if (is_view() && tets_.room() < more) left_zone_ = true;
        return !is_view() || tets_.room() >= more;
    }

    struct Renumbering {
        std::vector<TetId> old_of;        ///< for each new id the old one
        std::vector<std::uint8_t> turns;  ///< by the old id: how its corners were turned
        /// Where corner k of new tetrahedron t was.
        [[nodiscard]] unsigned old_corner(TetId t, unsigned k) const { return static_cast<unsigned>(turns[old_of[t.index()].index()]) >> (2 * k) & 3U; }
    };
    /// Numbers the tetrahedra in canonical order, without gaps, their corners in canonical order, too. Ids from before are void.
    Renumbering renumber(Workers& workers);
    /// Gives back memory that searches and changes need: the next one takes it again.
    void release_scratch() { mark_.release(); }
    void release_all_but_tets() {
        release_scratch();
        vertices_.release();
    }
    /// The same memory for another use: a number for each tetrahedron.
    [[nodiscard]] SharedArray<std::uint32_t> take_scratch() { return std::exchange(mark_, {}); }

    /// Triangulates the hole that v would leave. @return false if v can't go (fewer than four affinely independent points would stay) or its star has more than
    /// `most_tets`.
    bool find_hole(VertexId v, Hole& hole, std::size_t most_tets = std::numeric_limits<std::size_t>::max());
    /// Replaces the star by the filling (ids in new_tets(), in the order of hole.filling). The point stays stored, not inserted.
    void remove_vertex(const Hole& hole);
    void set_point(VertexId v, const Vec3& p) { vertices_[v.index()].point = p; }  ///< @pre v is not inserted

    // --- an earlier state put back, by whoever has kept what has changed since
    /// All of a state but its tetrahedra and vertices.
    struct Frame {
        std::size_t slots = 0, vertices = 0;
        std::vector<TetId> free;
        TetId last_located{};
    };
    [[nodiscard]] Frame frame() const { return {tets_.slots(), vertices_.size(), tets_.free_slots(), last_located_}; }
    /// What is beyond the frame goes. Marks and numbers of searches go on: they only need to be new.
    void cut_back(const Frame& frame) {
        tets_.cut_back(frame.slots, frame.free);
        vertices_.resize_as_is(frame.vertices);
        last_located_ = frame.last_located;
    }
    void put_back(TetId t, const TetStore::Corners& corners, const std::array<TetFace, 4>& across) { tets_.set(t, corners, across); }
    /// @param some_tet  of its star, as tet_of() said
    void put_back(VertexId v, const Vec3& p, TetId some_tet) {
        vertices_[v.index()].point = p;
        vertices_[v.index()].tet = some_tet;
    }

    void reserve(std::size_t vertices);

private:
    /// Half a cache line, so that a conflict test, the join to a cavity and the star's entry touch one line a vertex.
    struct alignas(32) Vertex {
        Vec3 point;
        TetId tet{};
        std::uint32_t local = 0;  ///< its number in one operation (local_numbers.hpp)
    };
    static_assert(sizeof(Vertex) == 32);

    void prefetch_neighbours(TetId t) const {
        for (unsigned f = 0; f < 4; ++f) {
            const TetId n = tets_.across(t, f).tet();
            tets_.prefetch(n);
            __builtin_prefetch(mark_.data() + n.index());
        }
    }
    void ensure_marks();
    void next_epoch();
    bool search_conflict_cavity(const Vec3& p, TetId near, Cavity& cavity);
    template <bool kZoned>
    bool grow_in_waves(const Vec3& p, TetId seed, Cavity& cavity);
    void decide_wave(const Vec3& p, std::size_t candidates);
    template <bool kZoned, class Accept>
    bool grow_cavity(const Vec3& p, TetId seed, Cavity& cavity, const Accept& accept);
    template <bool kZoned>
    [[nodiscard]] TetId walk(const Vec3& p, TetId from) const;
    [[nodiscard]] bool ghost_in_conflict(TetId t, const Vec3& p) const;
    bool start_from(std::span<const std::uint32_t> order);
    void prefer_first_duplicates(std::size_t from);
    void find_homes(Workers& workers);
    std::vector<std::uint32_t> insert_one_by_one(std::span<const std::uint32_t> order, BulkObserver* observer);

    // of views: what may be touched
    [[nodiscard]] bool is_mine(TetId t) const { return zone_of_tet_[t.index()] == zone_; }
    /// May this be touched? If not, that is noted.
    template <bool kZoned>
    [[nodiscard]] bool may_enter(TetId t) const {
        if constexpr (kZoned) {
            if (is_mine(t)) return true;
            left_zone_ = true;
            return false;
        } else {
            return true;
        }
    }
    template <bool kZoned>
    bool collect_star(VertexId v, std::vector<TetId>& star);
    template <bool kZoned>
    TetId search_edge(VertexId a, VertexId b);
    Triangulation view_of_zone(std::uint8_t zone, std::uint8_t* zone_of_tet, std::vector<TetId> slots);
    void insert_in_zone(std::span<const std::uint32_t> order, TetId seed, BulkObserver* observer, std::vector<std::uint32_t>& left, std::vector<std::uint32_t>& refused);
    std::vector<std::uint32_t> insert_in_zones(Workers& workers, std::span<const std::uint32_t> order, unsigned turn, BulkObserver* observer, std::vector<std::uint32_t>& refused);
    /// Numbers for the vertices of one cavity or hole: forgets all but infinity, which is 0; there is room for `most` more.
    void clear_local_numbers(std::size_t most);
    /// 1, 2, 3, ... in order of first mention.
    std::uint32_t local_number(VertexId v) {
        if (v == kInfiniteVertex) return 0;
        // Whether a vertex is new can't be foreseen: no branch. There is room for one number too many.
        std::uint32_t& word = vertices_[v.index()].local;
        const std::uint32_t known = std::min(word & ~kUnstamped, local_count_);
        const bool is_new = known == local_count_ || local_[known] != v;
        const std::uint32_t number = is_new ? local_count_ : known;
        word = kUnstamped | number;
        local_[number] = v;
        local_count_ += is_new ? 1 : 0;
        return number;
    }
    template <class Numbers>
    void read_faces(const Cavity& cavity, Numbers numbers);
    void renew_stamps(std::size_t insertions);
    void read_faces_only(const Cavity& cavity);
    void set_new_tets(VertexId v);
    void join_by_sorting();

    TetStore tets_;
    PredicateFilter filter_;
    Vec3 low_{}, high_{};
    SharedArray<Vertex> vertices_;
    struct Duplicate {
        VertexId vertex{}, inserted{};  // at the same place
    };
    std::vector<Duplicate> duplicates_;

    // scratch
    SharedArray<std::uint32_t> mark_;  // per tet: epoch_ visited and not in conflict, epoch_ + 1 in conflict
    std::uint32_t epoch_ = 0;
    static constexpr std::uint32_t kLastEpoch = std::numeric_limits<std::int32_t>::max() - 4;  // differences of epochs have a sign
    struct Wave {  // grow_in_waves()
        std::vector<TetId> taken, candidates;
        std::vector<RecordNumbers> corners;
        std::vector<double> values;
        std::vector<BoundaryFace> boundary;
        // of those that the filter doesn't decide
        std::vector<std::uint32_t> unsure;
        std::vector<RecordNumbers> unsure_corners;
        std::vector<double> signs;
    } wave_;
    std::vector<TetId> new_tets_;
    std::vector<TetId> star_stack_;
    struct NewFace {
        std::array<VertexId, 3> corners;
        std::array<std::uint32_t, 3> edges;  // in edge_table_, as the neighbours list them
        TetFace outside;
    };
    std::vector<NewFace> faces_;
    std::vector<TetFace> outside_;
    std::vector<VertexId> local_;
    std::uint32_t local_count_ = 0;
    std::uint32_t stamp_ = 0;  // of the last numbers: no vertex's word has a greater one
    std::vector<TetFace> edge_table_;
    mutable TetId last_located_{};
    std::uint8_t* zone_of_tet_ = nullptr;
    std::uint8_t zone_ = 0;
    mutable bool left_zone_ = false;

    friend class HoleFiller;
};

}  // namespace wellmesh

#include "delaunay/cavity_inline.hpp"
