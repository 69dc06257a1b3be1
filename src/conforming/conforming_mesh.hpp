// SPDX-License-Identifier: Apache-2.0
// A Delaunay triangulation that knows which of its vertices, edges, faces and tetrahedra represent which cells of the input.
//
// Labels decide, not geometry: Steiner points on slanted segments and facets are rounded, so they lie only nearly on them, and the
// flat tetrahedra this makes against the hull can't be told from real ones by measuring. Every vertex stores its carrier, every
// tetrahedron its cell, and the few tetrahedra at the boundary a record of the facet of each face and the segment of each edge.
// New tetrahedra inherit from the destroyed one behind each face of the cavity.
//
// When a point is inserted on a facet, the subfaces inside the cavity, and those on its boundary whose equatorial sphere contains
// the point (a rounded point may miss their outer neighbours), are replaced by the star of the point: the flat tetrahedron that
// then stands on such a face belongs to the cell on the other side. So the surface always passes through the point itself.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "conforming/edge_lookup.hpp"
#include "core/checkpoint.hpp"
#include "core/ids.hpp"
#include "core/shared_array.hpp"
#include "core/undo_log.hpp"
#include "delaunay/triangulation.hpp"
#include "validation/valid_plc.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh {

/// Why a vertex was inserted.
enum class InsertionReason : std::uint8_t {
    input,
    recovery,          ///< a segment or facet was missing
    lattice,           ///< seeded before refinement
    encroachment,      ///< a vertex encroached a subsegment or subface
    size,
    radius_edge,
    sliver,
    boundary_by_size,  ///< a subsegment or subface that the circumcentre of a tetrahedron bad for this reason would encroach
    boundary_by_radius_edge,
    boundary_by_sliver
};

struct VertexInfo {
    CarrierKind carrier = CarrierKind::region;
    InsertionReason reason = InsertionReason::input;
    bool copied = false;           ///< the copy of a vertex on another feature (AcuteGeometry)
    std::uint8_t generation = 0;   ///< how many copies between facets that share but a vertex are among its ancestors
    std::uint32_t carrier_id = 0;  ///< vertex, SegmentId, FacetId or CellId value, by kind
    VertexId parent{};             ///< the vertex responsible for the insertion [LiTeng01, section 5]
    VertexId ball{};               ///< the acute input vertex on whose ball's sphere it was put
    double insertion_length = 0;   ///< e_v: shortest edge at the vertex just after its insertion
};

struct Subsegment {
    VertexId a{}, b{};
    SegmentId segment{};
};

struct Subface {
    std::array<VertexId, 3> corners{};
    FacetId facet{};
    TetId near{};  ///< a tetrahedron that had it, if any is known: looked at first
};

/// Where a point is about to go.
struct Placement {
    CarrierKind carrier = CarrierKind::region;
    std::uint32_t carrier_id = 0;
    VertexId a{}, b{};  ///< carrier segment: the ends of the subsegment that is split (it need not be a mesh edge)
    static Placement on_segment(const Subsegment& s) { return {CarrierKind::segment, s.segment.value(), s.a, s.b}; }
    static Placement on_facet(FacetId f) { return {CarrierKind::facet, f.value(), {}, {}}; }
    static Placement in_cell(CellId c) { return {CarrierKind::region, c.value(), {}, {}}; }
};

/// Labels of the faces and edges of one tetrahedron at the boundary; invalid ids where there is none.
struct TetLabels {
    std::array<FacetId, 4> facets{};
    std::array<SegmentId, 6> segments{};
};

/// A point that is to be a vertex from the start, on its carrier up to rounding.
struct CarriedPoint {
    Vec3 point{};
    CarrierKind carrier = CarrierKind::region;  ///< no input vertex: those are there anyway
    std::uint32_t carrier_id = 0;               ///< as in VertexInfo
};

class ConformingMesh {
public:
    /// Triangulates the input's vertices, mesh vertex i is vertex i of the PLC, and after them `more`. Nothing is labelled yet.
    /// @pre no two points are the same. @throws MeshError{bad_input} if all vertices are coplanar.
    explicit ConformingMesh(const ValidPlc& plc, std::span<const CarriedPoint> more = {}, const Checkpoint& checkpoint = {});

    [[nodiscard]] const ValidPlc& plc() const { return *plc_; }
    [[nodiscard]] Triangulation& triangulation() { return tri_; }
    [[nodiscard]] const Triangulation& triangulation() const { return tri_; }
    [[nodiscard]] const TetStore& tets() const { return tri_.tets(); }
    [[nodiscard]] const Vec3& point(VertexId v) const { return tri_.point(v); }
    [[nodiscard]] const VertexInfo& info(VertexId v) const { return info_[v.index()]; }
    void set_carrier_id(VertexId v, std::uint32_t id) {
        keep(v);
        info_[v.index()].carrier_id = id;
    }
    [[nodiscard]] std::size_t vertex_slots() const { return info_.size(); }
    [[nodiscard]] std::size_t vertex_count() const { return vertex_count_; }

    [[nodiscard]] CellId cell(TetId t) const { return cell_[t.index()]; }
    [[nodiscard]] bool in_domain(TetId t) const { return filled_[cell_[t.index()].index()] != 0; }
    [[nodiscard]] bool is_filled(CellId c) const { return filled_[c.index()] != 0; }
    [[nodiscard]] bool has_labels(TetId t) const { return record_[t.index()] != 0; }
    /// @pre has_labels(t)
    [[nodiscard]] const TetLabels& labels(TetId t) const { return records_[record_[t.index()]]; }
    [[nodiscard]] FacetId facet_at(TetFace tf) const { return has_labels(tf.tet()) ? labels(tf.tet()).facets[tf.face()] : FacetId{}; }
    [[nodiscard]] SegmentId segment_at(TetId t, unsigned edge) const { return has_labels(t) ? labels(t).segments[edge] : SegmentId{}; }
    /// Facets whose closure contains the point of this placement: one for a facet, several for a segment.
    [[nodiscard]] std::span<const FacetId> facets_of(const Placement& where);
    [[nodiscard]] bool is_on_facet(VertexId v, FacetId f) const;
    /// Steiner vertices on the facet and on its segments, ascending; or on the segment, in order of insertion.
    [[nodiscard]] std::vector<VertexId> steiner_vertices_of(FacetId f) const;
    [[nodiscard]] std::vector<VertexId> steiner_vertices_of(SegmentId s) const;
    /// The segment's ends and the Steiner vertices between them, in order.
    [[nodiscard]] std::vector<VertexId> chain_of(SegmentId s) const;

    /// Does a point placed on a facet really lie in one of its subfaces? (Rounding, or an encroached neighbourhood, may put it outside.)
    /// @pre cavity is the last one found.
    [[nodiscard]] bool holds_carrier(const Cavity& cavity, const Placement& where) const;

    /// Would this insertion destroy subfaces or subsegments that don't contain the point? @pre cavity is the last one found.
    [[nodiscard]] bool would_break(const Cavity& cavity, const Placement& where);

    /// Finds out what an insertion would do, for changes_sides(). @pre cavity is the last one found.
    void plan_insertion(const Cavity& cavity, const Placement& where) { plan(cavity, where); }
    /// Will the tetrahedron on this face of the planned cavity's boundary be a flat one that belongs to the cell across the face?
    [[nodiscard]] bool changes_sides(std::size_t boundary_face) const { return captured_[boundary_face].swapped; }

    // --- labels, for recovery
    void label_edge(VertexId a, VertexId b, SegmentId s);  ///< on all tetrahedra around the edge; an invalid s takes the label away. Does nothing if there is no such edge
    void label_face(TetFace tf, FacetId f);                ///< on both sides; an invalid f takes the label away
    /// Labels these faces as f's, and no others. Where that changes anything the cells on both sides become unknown.
    void relabel_facet(FacetId f, const std::vector<TetFace>& faces);
    void set_cell(TetId t, CellId c) {
        keep(t);
        cell_[t.index()] = c;
    }

    // --- cells that a broken surface let leak: tetrahedra that were made next to it, or that its repair may have moved to the other side
    /// The cell of tetrahedra of which nothing is known; not in the domain.
    [[nodiscard]] CellId unknown_cell() const { return CellId{filled_.size() - 1}; }
    void forget_cell(TetId t);
    /// Tetrahedra whose cells were forgotten since the last call, some of which may be gone.
    [[nodiscard]] std::vector<TetId> take_forgotten() { return std::exchange(forgotten_, {}); }

    /// Inserts cavity.point and notes its insertion length. Labels and cells follow; constraints that the point destroys without lying on them are noted as broken.
    VertexId insert(const Cavity& cavity, const Placement& where, const VertexInfo& info);
    /// Adds vertices inside cells, all that encroach upon nothing, on all workers. All get numbers, in their order; @pre there is no savepoint
    /// those that did not go in are not inserted, insert_known() may still do it. Ids of tetrahedra depend on the number of workers. Insertion lengths are not noted.
    /// @param points  in biased_spatial_order(), none of them a vertex's  @param waits  by point: it gets a number, no more; empty: none does
    /// @param is_welcome  may there be a vertex in this cell? From any thread.
    /// @param may_go_on  asked now and then, from any thread
    /// @param encroaching  gets the vertices that would encroach upon a subface or subsegment  @return the others that are not in
    std::vector<VertexId> insert_inside(Workers& workers, std::span<const Vec3> points, std::span<const char> waits, InsertionReason reason,
                                        const std::function<bool(const Vec3&, CellId)>& is_welcome, const std::function<bool()>& may_go_on,
                                        std::vector<VertexId>& encroaching);
    /// Inserts those of such vertices that it can, in their order. @return as above
    std::vector<VertexId> insert_inside(Workers& workers, std::span<const VertexId> vertices, const std::function<bool(const Vec3&, CellId)>& is_welcome,
                                        const std::function<bool()>& may_go_on, std::vector<VertexId>& encroaching);
    /// Gives numbers to n points that are to be vertices; they are not inserted yet, and nothing until set_new_vertex() was called for each. @return the first
    VertexId add_vertices(std::size_t n);
    /// From any thread. @param ball  as in VertexInfo
    void set_new_vertex(VertexId v, const CarriedPoint& p, InsertionReason reason, VertexId ball = {});
    /// Inserts such vertices, wherever they are, on all workers. All labels and cells are lost, and ids of tetrahedra are new: relabel() comes next.
    /// @param order  neighbours in space near each other, in rounds of growing size (delaunay/spatial_order.hpp)  @pre there is no savepoint
    void insert_at_once(Workers& workers, std::span<const std::uint32_t> order);
    /// Labels these edges and faces, as all that there are. Segments and facets of which one is not there are broken then.
    void relabel(Workers& workers, std::span<const Subsegment> segments, std::span<const Subface> faces);
    /// Gives tetrahedra the cell of a vertex of theirs that is inside one; those that have none are forgotten. @pre all segments and facets are whole, for what
    /// they do not cross is all in one cell; and there is no savepoint
    void find_cells_by_vertices(Workers& workers);
    /// Known tetrahedra take the place of those that are there. @param fresh  vertices that have a number, and whose whole stars are known  @param goes_on  as of
    /// Triangulation::find_region  @return false, with nothing changed: that refuses, or what is there has labels, or several cells within one rim.
    /// @pre there is no savepoint
    bool put_known_tets(Workers& workers, const KnownTets& known, std::span<const VertexId> fresh, const std::function<bool()>& goes_on);
    /// Inserts such a vertex. @param where  in a cell
    void insert_known(VertexId v, const Cavity& cavity, const Placement& where);
    /// Ids of tetrahedra that depend on the mesh alone; all ids from before are void. @pre nothing is broken or forgotten, and there is no savepoint
    void renumber_tets(Workers& workers);
    /// Leaves only as many records of labels as there are labels, in the order of their tetrahedra: work in zones and bulk insertion leave many times
    /// that, anyhow. @pre there is no savepoint
    void pack_records(Workers& workers);
    /// Gives back everything but corners and neighbours of tetrahedra, of which alone may be asked from now on.
    void release_all_but_tets();
    /// Puts a removed vertex back, or elsewhere on its carrier: like insert, keeping id and info.
    void reinsert(VertexId v, const Cavity& cavity, const Placement& where);
    /// Takes v out. Cells and labels of the filling are found by flooding from the boundary of the hole. @return false, with nothing
    /// changed, if the mesh without v can't represent every facet and segment that passes through the hole.
    bool remove(const Hole& hole);

    /// Cells and labels of some tetrahedra, by their corners: the triangulation is a function of its points, so removing a vertex that was
    /// just inserted, or inserting one again where it was, brings the very same tetrahedra back.
    struct Snapshot {
        struct Entry {
            TetStore::Corners corners{};
            CellId cell{};
            bool labelled = false;
            TetLabels labels{};
        };
        std::vector<Entry> entries;
    };
    void save(const std::vector<TetId>& tets, Snapshot& snapshot) const;
    [[nodiscard]] std::size_t savepoints() const { return frames_.size(); }  ///< (savepoint.hpp)
    /// Undoes insert or reinsert of v; `before` was saved from the cavity's tetrahedra. @param where as it was given then.
    void undo_insertion(VertexId v, const Placement& where, const Snapshot& before);
    /// The same of a vertex that was not there before insert(), which was the last one to make any.
    void undo_new_insertion(VertexId v, const Placement& where, const Snapshot& before);
    /// Undoes remove; `before` was saved from the star of v, which stands at its old point again.
    /// @param filling  live tetrahedra, some of them in the hole; empty: it is searched for
    void undo_removal(VertexId v, const Placement& where, const Snapshot& before, std::span<const TetId> filling = {});

    // --- zones, for several workers at once (delaunay/zones.hpp)
    /// What each zone may have more of; as it stands for moves, which change numbers by little.
    struct ZoneRoom {
        std::size_t tets = 2048;
        std::size_t vertices = 0;
        std::size_t records = 2048;  ///< of labels
    };
    /// Views of zones, in which vertices move or are inserted. Until they are joined the whole must not be touched.
    [[nodiscard]] std::vector<ConformingMesh> split(Workers& workers, const Zones& zones, const ZoneRoom& room, ZoneViews& parts);
    /// Takes over what the views changed, in their order.
    void join(std::vector<ConformingMesh>& views);
    /// Ids of vertices that views left over are not used any more: whoever is inserted from here on has a larger one than all that are there.
    void forget_spare_vertices() { spare_vertices_.clear(); }
    /// Of a view: is there room to take out one vertex of a star of at most `most_tets` and put it elsewhere? If not, it has left its zone.
    [[nodiscard]] bool has_room_to_move(std::size_t most_tets) {
        const bool has_records = !tri_.is_view() || free_records_.size() >= 2 * most_tets;
        if (!has_records) tri_.leave_zone();
        return tri_.has_room(2 * most_tets) && has_records;
    }

    /// Of a view: is there room for a vertex, and does it break nothing? If not, it has left its zone. The whole mesh takes any. @pre cavity is the last one
    /// found; the next change is its insertion. The stars of a carrier segment's ends are in the zone.
    [[nodiscard]] bool may_insert(const Cavity& cavity, const Placement& where);

    /// Facets and segments that lost a piece since the last call.
    [[nodiscard]] std::vector<FacetId> take_broken_facets();
    [[nodiscard]] std::vector<SegmentId> take_broken_segments();
    /// Facets with a hole or more, one entry a hole; has_only_holes(): and all segments are whole.
    [[nodiscard]] const std::vector<FacetId>& broken_facets() const { return broken_facets_; }
    [[nodiscard]] bool has_only_holes() const { return !broken_facets_.empty() && broken_segments_.empty(); }
    [[nodiscard]] std::size_t steiner_vertices_ever(FacetId f) const { return on_facet_[f.index()].size(); }
    /// Does the cavity reach into what holes have left without a cell?
    [[nodiscard]] bool reaches_hole(const Cavity& cavity) const {
        return !forgotten_.empty() && std::any_of(cavity.tets.begin(), cavity.tets.end(), [&](TetId t) { return cell_[t.index()] == unknown_cell(); });
    }
    [[nodiscard]] bool has_broken() const { return !broken_facets_.empty() || !broken_segments_.empty(); }

    /// The subsegment or subface in the last state of the mesh, if it is one.
    [[nodiscard]] TetId find_subsegment(const Subsegment& s);  ///< a tetrahedron with the labelled edge, or invalid
    [[nodiscard]] TetFace find_subface(const Subface& s);      ///< one side of the labelled face, or invalid

private:
    struct CapturedFace {
        std::array<VertexId, 3> corners{};
        CellId cell{};
        FacetId facet{};
        std::array<SegmentId, 3> segments{};  // edge opposite corner k
        bool swapped = false;                 // a flat tetrahedron will stand here: it belongs to the other side
    };
    struct InteriorFace {
        std::array<VertexId, 3> corners{};
        FacetId facet{};
        std::uint32_t boundary = kNotOnBoundary;  // index of the cavity's boundary face that it is
        bool used = false;
        static constexpr std::uint32_t kNotOnBoundary = 0xffffffffU;
    };
    struct LoopEdge {
        VertexId a{}, b{};
        FacetId facet{};
    };

    /// Of the labels in one hole; vertices are numbered as the hole's link (remove_labelled.cpp).
    struct HoleLabels {
        struct Loop {
            FacetId facet{};
            std::size_t faces = 0, fans = 0;
        };
        struct LoopFace {
            std::size_t loop = 0;
            std::array<std::uint32_t, 2> corners{};  // besides the vertex that goes
        };
        struct Edge {
            std::uint64_t key = 0;
            SegmentId segment{};
        };
        std::vector<std::uint32_t> link_edges;       // star tetrahedra by their edges on the link
        std::vector<std::uint32_t> star_part, part;  // of the star's and of the filling's tetrahedra
        std::vector<CellId> cell_of_part;
        std::vector<Loop> loops;
        std::vector<LoopFace> loop_faces;
        std::vector<std::uint64_t> on_loops;         // for each vertex a bit for each loop
        std::vector<std::uint32_t> ends;             // of the subsegments at the vertex that goes
        std::vector<Edge> segments;                  // labelled edges of the link, and the one that heals
        std::vector<char> on_segment;                // is the vertex an end of one of these?
        std::vector<std::array<FacetId, 4>> facets;  // of the filling
        std::vector<std::size_t> stack, count;
    };

    // savepoints
    struct TetState {
        TetStore::Corners corners{};
        std::array<TetFace, 4> across{};
        CellId cell{};
        std::uint32_t record = 0;
    };
    struct VertexState {
        Vec3 point{};
        TetId some_tet{};
        VertexInfo info{};
    };
    /// All of a state but tetrahedra, vertices and records of labels.
    struct Frame {
        Triangulation::Frame triangulation;
        std::size_t vertex_count = 0, records = 0;
        std::vector<std::uint32_t> free_records;
        std::vector<std::size_t> on_facet, on_segment;  // how many: only more are put there
        std::vector<char> facet_labelled;
        std::vector<TetId> forgotten;
        std::vector<FacetId> broken_facets;
        std::vector<SegmentId> broken_segments;
        std::vector<VertexId> spare_vertices;
    };
    void open_savepoint();
    void roll_back();
    void close_savepoint();
    /// To be called before the tetrahedron, its labels left aside, or the vertex changes.
    void keep(TetId t) {
        if (old_tets_.wants(t.index())) [[unlikely]]
            old_tets_.keep(t.index(), {tets().corners(t), tri_.tets().across_all(t), cell_[t.index()], record_[t.index()]});
    }
    void keep(VertexId v) {
        if (old_vertices_.wants(v.index())) [[unlikely]]
            old_vertices_.keep(v.index(), {point(v), tri_.tet_of(v), info_[v.index()]});
    }
    void keep_record(std::uint32_t r) {
        if (old_records_.wants(r)) [[unlikely]]
            old_records_.keep(r, records_[r]);
    }
    void keep_surroundings(std::span<const TetId> going, std::span<const BoundaryFace> boundary);
    void keep_taken(std::size_t recycled);
    void insert_vertex(VertexId v, const Cavity& cavity);
    void remove_vertex(const Hole& hole);

    void capture(const Cavity& cavity, std::vector<CapturedFace>& captured) const;
    [[nodiscard]] bool is_encroached_at(TetId t, const Vec3& p) const;
    void collect_interior(const Cavity& cavity, const Placement& where);
    void replace_subfaces(const Cavity& cavity, const Placement& where, FacetId facet);
    void commit(VertexId v, const Cavity& cavity, const Placement& where);
    void commit_inside(VertexId v, const Cavity& cavity);
    void restore(const Snapshot& snapshot);
    void plan(const Cavity& cavity, const Placement& where);
    bool note_destroyed(const Placement& where);
    [[nodiscard]] bool breaks_something(const Placement& where) const;
    [[nodiscard]] std::vector<TetFace> labelled_faces(FacetId f);
    TetLabels& labels_for_writing(TetId t);
    void drop_labels(TetId t);
    std::size_t reserve_for_tets();
    /// Makes room for what is known of each tetrahedron.
    void fit_arrays();
    void fit_arrays(Workers& workers);
    template <class Turned>
    void pack_records(Workers& workers, Turned&& turned);
    void note_carrier(VertexId v);
    class InsideObserver;

    ConformingMesh() = default;  // a view to be

    const ValidPlc* plc_ = nullptr;
    Triangulation tri_;
    SharedArray<VertexInfo> info_;
    std::size_t vertex_count_ = 0;
    SharedArray<CellId> cell_;
    SharedArray<std::uint32_t> record_;  // index into records_; 0: no labels
    SharedArray<TetLabels> records_;
    std::vector<std::uint32_t> free_records_;
    std::vector<char> filled_;  // of each cell; the last entry is the unknown cell's
    std::vector<std::vector<VertexId>> on_facet_;    // Steiner vertices ever inserted on each facet,
    std::vector<std::vector<VertexId>> on_segment_;  // and on each segment
    std::vector<char> facet_labelled_;
    std::vector<TetId> forgotten_;
    std::vector<FacetId> broken_facets_;
    std::vector<SegmentId> broken_segments_;
    std::vector<VertexId> spare_vertices_;  // of a view: for it to insert; of the whole: left over by views. The last one is taken first
    std::vector<VertexId> added_;           // of a view: inserted
    bool planned_ = false;                  // the next insertion

    // what has changed since the savepoints
    UndoLog<TetState> old_tets_;
    UndoLog<VertexState> old_vertices_;
    UndoLog<TetLabels> old_records_;
    std::vector<Frame> frames_;  // of the savepoints
    bool has_views_ = false;     // which keep what they change until they are joined

    // scratch of one insertion or removal
    std::vector<CapturedFace> captured_;
    std::vector<InteriorFace> interior_;
    std::vector<Subsegment> interior_segments_;  // deleted by the insertion
    EdgeLookup segment_edges_;                   // of these and of the cavity's boundary
    EdgeLookup subface_edges_;                   // of the subfaces of one facet in interior_
    std::vector<LoopEdge> loop_;
    EdgeLookup loop_edges_;  // numbers in loop_
    EdgeLookup rim_;         // the edges of captured faces; none where there is no loop
    std::vector<std::size_t> mine_, taken_;
    std::vector<FacetId> carrier_facets_;
    HoleLabels hole_labels_;
    Hole undo_hole_;
    Cavity undo_cavity_;

    friend class HoleLabeller;
    friend class Savepoint;
};

/// Box of the input's vertices.
void bounding_box(const std::vector<Vec3>& points, Vec3& lo, Vec3& hi);

}  // namespace wellmesh
