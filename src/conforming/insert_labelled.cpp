// SPDX-License-Identifier: Apache-2.0
// Insertion of a vertex into a labelled mesh: what the new tetrahedra inherit, and how the surface is led through a point on it.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "conforming/conforming_mesh.hpp"
#include "core/check.hpp"
#include "core/edge_key.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh {
namespace {

bool same_edge(VertexId a, VertexId b, VertexId c, VertexId d) { return (a == c && b == d) || (a == d && b == c); }

/// Smallest barycentric coordinate of p in the triangle, both seen along `normal`: how deep inside it lies.
double depth_inside(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, const Vec3& normal) {
    const double area = dot(cross(b - a, c - a), normal);
    if (area == 0) return -1e300;
    return std::min({dot(cross(b - p, c - p), normal), dot(cross(c - p, a - p), normal), dot(cross(a - p, b - p), normal)}) / area;
}

}  // namespace

void ConformingMesh::capture(const Cavity& cavity, std::vector<CapturedFace>& captured) const {
    const TetStore& tets = tri_.tets();
    captured.resize(cavity.boundary.size());
    for (std::size_t i = 0; i < cavity.boundary.size(); ++i) {
        const TetFace inside = cavity.boundary[i].inside;
        CapturedFace& c = captured[i];
        c = CapturedFace{};
        c.corners = tets.face_corners(inside);
        c.cell = cell_[inside.tet().index()];
        if (!has_labels(inside.tet())) continue;
        const TetLabels& l = labels(inside.tet());
        c.facet = l.facets[inside.face()];
        const auto& slot = kFaceCorners[inside.face()];
        for (std::size_t k = 0; k < 3; ++k) c.segments[k] = l.segments[kEdgeOf[slot[(k + 1) % 3]][slot[(k + 2) % 3]]];
    }
}

/// Subfaces and subsegments that the insertion would delete, and those on the cavity's boundary that a point on their facet replaces.
void ConformingMesh::collect_interior(const Cavity& cavity, const Placement& where) {
    const TetStore& tets = tri_.tets();
    interior_.clear();
    DistinctEdges<Subsegment> segments(interior_segments_);
    for (const TetId t : cavity.tets) {
        if (!has_labels(t)) continue;
        const TetLabels& l = labels(t);
        for (unsigned f = 0; f < 4; ++f) {
            if (!l.facets[f].valid()) continue;
            const TetId other = tets.across(t, f).tet();
            if (tri_.in_last_cavity(other) && t < other) interior_.push_back({tets.face_corners(TetFace{t, f}), l.facets[f], InteriorFace::kNotOnBoundary, false});
        }
        for (unsigned e = 0; e < 6; ++e) {
            if (!l.segments[e].valid()) continue;
            const VertexId a = tets.corner(t, kEdgeCorners[e][0]), b = tets.corner(t, kEdgeCorners[e][1]);
            if (!segments.is_listed(edge_key(a, b)) && !segment_edges_.contains(edge_key(a, b))) segments.add({a, b, l.segments[e]});
        }
    }
    segments.finish();
    for (const Subsegment& s : interior_segments_) segment_edges_.add(edge_key(s.a, s.b), 0);
    segment_edges_.finish();
    const auto facets = facets_of(where);
    if (facets.empty()) return;
    for (std::size_t i = 0; i < captured_.size(); ++i) {
        const CapturedFace& c = captured_[i];
        if (!c.facet.valid() || std::find(facets.begin(), facets.end(), c.facet) == facets.end()) continue;
        if (side_of_equatorial_sphere(point(c.corners[0]), point(c.corners[1]), point(c.corners[2]), cavity.point) == Sign::positive)
            interior_.push_back({c.corners, c.facet, static_cast<std::uint32_t>(i), false});
    }
}

/// Finds the subfaces of `facet` that the point's star replaces: the ones connected, not across subsegments, to where the point lies.
void ConformingMesh::replace_subfaces(const Cavity& cavity, const Placement& where, FacetId facet) {
    std::vector<std::size_t>&mine = mine_, &stack = taken_;
    mine.clear();
    stack.clear();
    for (std::size_t i = 0; i < interior_.size(); ++i)
        if (interior_[i].facet == facet) mine.push_back(i);
    if (mine.empty()) return;
    subface_edges_.clear();
    for (const std::size_t i : mine)
        for (std::size_t k = 0; k < 3; ++k) subface_edges_.add(edge_key(interior_[i].corners[k], interior_[i].corners[(k + 1) % 3]), i);
    subface_edges_.finish();
    const auto take = [&](std::size_t i) {
        if (interior_[i].used) return;
        interior_[i].used = true;
        stack.push_back(i);
    };
    if (where.carrier == CarrierKind::segment) {
        for (const std::size_t i : mine) {
            const auto& c = interior_[i].corners;
            if (std::find(c.begin(), c.end(), where.a) != c.end() && std::find(c.begin(), c.end(), where.b) != c.end()) take(i);
        }
    } else {
        std::size_t home = mine[0];
        double deepest = -1e308;
        for (const std::size_t i : mine) {
            const auto& c = interior_[i].corners;
            const double depth = depth_inside(point(c[0]), point(c[1]), point(c[2]), cavity.point, plc_->facets[facet.index()].normal);
            if (depth > deepest) {
                deepest = depth;
                home = i;
            }
        }
        take(home);
    }
    while (!stack.empty()) {
        const auto corners = interior_[stack.back()].corners;
        stack.pop_back();
        for (std::size_t k = 0; k < 3; ++k) {
            const VertexId a = corners[(k + 1) % 3], b = corners[(k + 2) % 3];
            if (where.carrier == CarrierKind::segment && same_edge(a, b, where.a, where.b)) continue;
            if (segment_edges_.contains(edge_key(a, b))) {
                loop_.push_back({a, b, facet});
                continue;
            }
            bool shared = false;
            subface_edges_.for_each(edge_key(a, b), [&](std::size_t j) {
                if (interior_[j].corners == corners) return;
                shared = true;
                take(j);
            });
            if (!shared) loop_.push_back({a, b, facet});
        }
    }
    for (const std::size_t i : mine)
        if (interior_[i].used && interior_[i].boundary != InteriorFace::kNotOnBoundary) captured_[interior_[i].boundary].swapped = true;
}

bool ConformingMesh::holds_carrier(const Cavity& cavity, const Placement& where) const {
    if (where.carrier == CarrierKind::segment) {
        const Vec3 d = point(where.b) - point(where.a);
        const double along = dot(cavity.point - point(where.a), d);
        return along > 0 && along < squared_norm(d);
    }
    if (where.carrier != CarrierKind::facet) return true;
    const FacetId facet{where.carrier_id};
    constexpr double kEdgeTolerance = -1e-6;  // relative: a point on an edge of two subfaces lies in both
    for (const TetId t : cavity.tets) {
        if (!has_labels(t)) continue;
        for (unsigned f = 0; f < 4; ++f) {
            if (labels(t).facets[f] != facet) continue;
            const auto c = tets().face_corners(TetFace{t, f});
            if (depth_inside(point(c[0]), point(c[1]), point(c[2]), cavity.point, plc_->facets[facet.index()].normal) > kEdgeTolerance) return true;
        }
    }
    return false;
}

/// @return whether a facet is: then cells leak.
bool ConformingMesh::note_destroyed(const Placement& where) {
    const std::size_t before = broken_facets_.size();
    for (const InteriorFace& f : interior_)
        if (!f.used && f.boundary == InteriorFace::kNotOnBoundary) broken_facets_.push_back(f.facet);
    for (const Subsegment& s : interior_segments_)
        if (where.carrier != CarrierKind::segment || !same_edge(s.a, s.b, where.a, where.b)) broken_segments_.push_back(s.segment);
    // An edge of the loop that is a destroyed subsegment carries no face of the star: the surface is open there.
    for (const LoopEdge& e : loop_)
        if (!rim_.contains(edge_key(e.a, e.b))) broken_facets_.push_back(e.facet);
    return broken_facets_.size() != before;
}

/// The same, of the insertion that was planned, without noting it.
bool ConformingMesh::breaks_something(const Placement& where) const {
    const auto is_lost = [](const InteriorFace& f) { return !f.used && f.boundary == InteriorFace::kNotOnBoundary; };
    const auto is_cut = [&](const Subsegment& s) { return where.carrier != CarrierKind::segment || !same_edge(s.a, s.b, where.a, where.b); };
    const auto is_open = [&](const LoopEdge& e) { return !rim_.contains(edge_key(e.a, e.b)); };
    return std::any_of(interior_.begin(), interior_.end(), is_lost) || std::any_of(interior_segments_.begin(), interior_segments_.end(), is_cut) ||
           std::any_of(loop_.begin(), loop_.end(), is_open);
}

/// Reads everything that the insertion needs to know about the cavity, and finds how the surface will run.
void ConformingMesh::plan(const Cavity& cavity, const Placement& where) {
    capture(cavity, captured_);
    segment_edges_.clear();
    for (const CapturedFace& c : captured_)
        for (std::size_t k = 0; k < 3; ++k)
            if (c.segments[k].valid()) segment_edges_.add(edge_key(c.corners[(k + 1) % 3], c.corners[(k + 2) % 3]), 0);
    segment_edges_.finish();
    loop_.clear();
    rim_.clear();
    loop_edges_.clear();
    interior_.clear();
    interior_segments_.clear();
    if (std::none_of(cavity.tets.begin(), cavity.tets.end(), [&](TetId t) { return has_labels(t); })) return;
    collect_interior(cavity, where);
    for (const FacetId f : facets_of(where)) replace_subfaces(cavity, where, f);
    if (loop_.empty()) return;
    for (const CapturedFace& c : captured_)
        for (std::size_t k = 0; k < 3; ++k) rim_.add(edge_key(c.corners[(k + 1) % 3], c.corners[(k + 2) % 3]), 0);
    rim_.finish();
    for (std::size_t i = 0; i < loop_.size(); ++i) loop_edges_.add(edge_key(loop_[i].a, loop_[i].b), i);
    loop_edges_.finish();
}

bool ConformingMesh::would_break(const Cavity& cavity, const Placement& where) {
    plan(cavity, where);
    for (const InteriorFace& f : interior_)
        if (!f.used && f.boundary == InteriorFace::kNotOnBoundary) return true;
    for (const Subsegment& s : interior_segments_)
        if (where.carrier != CarrierKind::segment || !same_edge(s.a, s.b, where.a, where.b)) return true;
    return false;
}

/// Nearly every cavity is inside one cell: nothing is inherited but that.
void ConformingMesh::commit_inside(VertexId v, const Cavity& cavity) {
    const CellId cell = cell_[cavity.tets[0].index()];
    insert_vertex(v, cavity);
    for (const TetId t : tri_.new_tets()) cell_[t.index()] = cell;
    if (cell == unknown_cell())
        for (const TetId t : tri_.new_tets()) forget_cell(t);
}

void ConformingMesh::commit(VertexId v, const Cavity& cavity, const Placement& where) {
    const auto is_inside = [&](TetId t) { return !has_labels(t) && cell_[t.index()] == cell_[cavity.tets[0].index()]; };
    if (where.carrier == CarrierKind::region && std::all_of(cavity.tets.begin(), cavity.tets.end(), is_inside)) {
        commit_inside(v, cavity);
        return;
    }
    if (!std::exchange(planned_, false)) plan(cavity, where);
    const bool reaches = reaches_hole(cavity), leaks = note_destroyed(where) || reaches;
    const bool splits = where.carrier == CarrierKind::segment;
    for (const TetId t : cavity.tets) drop_labels(t);

    insert_vertex(v, cavity);

    const TetStore& tets = tri_.tets();
    const auto& fresh = tri_.new_tets();
    for (std::size_t i = 0; i < fresh.size(); ++i) {
        const TetId t = fresh[i];
        const CapturedFace& c = captured_[i];
        cell_[t.index()] = c.cell;
        const unsigned at = tets.find_corner(t, v);
        if (c.swapped) {
            const TetFace outside = tets.across(t, at);
            cell_[t.index()] = cell_[outside.tet().index()];
            if (has_labels(outside.tet())) labels_for_writing(outside.tet()).facets[outside.face()] = FacetId{};
        } else if (c.facet.valid()) {
            labels_for_writing(t).facets[at] = c.facet;
        }
        for (std::size_t k = 0; k < 3; ++k) {
            const VertexId a = c.corners[(k + 1) % 3], b = c.corners[(k + 2) % 3];
            if (c.segments[k].valid() && !(splits && same_edge(a, b, where.a, where.b)))
                labels_for_writing(t).segments[kEdgeOf[tets.find_corner(t, a)][tets.find_corner(t, b)]] = c.segments[k];
            loop_edges_.for_each(edge_key(a, b), [&](std::size_t e) { labels_for_writing(t).facets[tets.find_corner(t, c.corners[k])] = loop_[e].facet; });
        }
        if (splits)
            for (const VertexId end : {where.a, where.b}) {
                const unsigned other = tets.find_corner(t, end);
                if (other < 4) labels_for_writing(t).segments[kEdgeOf[at][other]] = SegmentId{where.carrier_id};
            }
    }
    for (const TetId t : fresh)
        if (leaks || cell_[t.index()] == unknown_cell()) forget_cell(t);
    if (splits) label_edge(where.a, where.b, SegmentId{});  // it may have survived on the hull, an ulp away from the new vertex
}

void ConformingMesh::note_carrier(VertexId v) {
    const VertexInfo& own = info(v);
    if (own.carrier == CarrierKind::facet) on_facet_[own.carrier_id].push_back(v);
    if (own.carrier == CarrierKind::segment) on_segment_[own.carrier_id].push_back(v);
}

VertexId ConformingMesh::insert(const Cavity& cavity, const Placement& where, const VertexInfo& vertex_info) {
    VertexId v{};
    if (tri_.is_view()) {
        v = spare_vertices_.back();
        spare_vertices_.pop_back();
        added_.push_back(v);
        keep(v);
        tri_.set_point(v, cavity.point);
    } else {
        v = tri_.add_point(cavity.point);
        info_.push_back({});
    }
    VertexInfo& own = info_[v.index()];
    own = vertex_info;
    own.carrier = where.carrier;
    own.carrier_id = where.carrier_id;
    ++vertex_count_;
    if (!tri_.is_view()) note_carrier(v);
    commit(v, cavity, where);
    // e_v: the star is at hand.
    double shortest = std::numeric_limits<double>::infinity();
    for (const TetId t : tri_.new_tets())
        for (const VertexId w : tri_.tets().corners(t))
            if (w != v && w != kInfiniteVertex) shortest = std::min(shortest, squared_distance(cavity.point, point(w)));
    own.insertion_length = std::sqrt(shortest);
    return v;
}

void ConformingMesh::reinsert(VertexId v, const Cavity& cavity, const Placement& where) {
    keep(v);
    if (point(v) != cavity.point) info_[v.index()].ball = VertexId{};
    tri_.set_point(v, cavity.point);
    ++vertex_count_;
    commit(v, cavity, where);
}

}  // namespace wellmesh
