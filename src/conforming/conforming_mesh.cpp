// SPDX-License-Identifier: Apache-2.0
#include "conforming/conforming_mesh.hpp"

#include <algorithm>
#include <iterator>

#include "core/check.hpp"
#include "core/vec3_math.hpp"
#include "wellmesh/error.hpp"

namespace wellmesh {

void bounding_box(const std::vector<Vec3>& points, Vec3& lo, Vec3& hi) {
    lo = hi = points.empty() ? Vec3{} : points[0];
    for (const Vec3& p : points) {
        lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
        hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
    }
}

ConformingMesh::ConformingMesh(const ValidPlc& plc, std::span<const CarriedPoint> more, const Checkpoint& checkpoint) : plc_(&plc) {
    std::vector<Vec3> points = plc.vertices;
    for (const CarriedPoint& p : more) points.push_back(p.point);
    Vec3 lo, hi;
    bounding_box(points, lo, hi);
    // Steiner points on the hull are rounded, so they may leave the input's box by an ulp; the filter must cover them.
    const Vec3 margin = 1e-9 * (hi - lo) + Vec3{1e-15 * std::abs(hi.x), 1e-15 * std::abs(hi.y), 1e-15 * std::abs(hi.z)} +
                        Vec3{1e-15 * std::abs(lo.x), 1e-15 * std::abs(lo.y), 1e-15 * std::abs(lo.z)};
    tri_ = Triangulation(lo - margin, hi + margin);
    if (!tri_.insert_all(points, checkpoint))
        throw MeshError(ErrorCode::bad_input, Stage::delaunay, "all vertices lie in one plane: there is no volume to mesh");
    WELLMESH_CHECK(Stage::delaunay, tri_.duplicate_count() == 0);
    on_facet_.resize(plc.facets.size());
    on_segment_.resize(plc.segments.size());
    info_.resize(points.size(), VertexInfo{});
    for (std::size_t i = 0; i < plc.vertices.size(); ++i) {
        info_[i].carrier = CarrierKind::input_vertex;
        info_[i].carrier_id = static_cast<std::uint32_t>(i);
    }
    for (std::size_t i = plc.vertices.size(); i < points.size(); ++i) {
        const CarriedPoint& p = more[i - plc.vertices.size()];
        info_[i].carrier = p.carrier;
        info_[i].carrier_id = p.carrier_id;
        if (p.carrier == CarrierKind::facet) on_facet_[p.carrier_id].push_back(VertexId{i});
        if (p.carrier == CarrierKind::segment) on_segment_[p.carrier_id].push_back(VertexId{i});
    }
    vertex_count_ = info_.size();
    facet_labelled_.assign(plc.facets.size(), 0);
    records_.push_back(TetLabels{});  // record 0 means none
    for (const ValidCell& c : plc.cells) filled_.push_back(c.filled ? 1 : 0);
    filled_.push_back(0);
    fit_arrays();
}

std::size_t ConformingMesh::reserve_for_tets() {
    const std::size_t slots = tri_.tets().slots();
    if (cell_.size() >= slots) return cell_.size();
    // As much room as the tetrahedra have: growing on their own they would be there twice at other times, too.
    const std::size_t room = tri_.tets().capacity();
    cell_.reserve(room);
    record_.reserve(room);
    return std::min(room, slots + slots / 64 + 64);  // a little ahead: this is asked after every insertion
}

void ConformingMesh::fit_arrays() {
    const std::size_t size = reserve_for_tets();
    if (size == cell_.size()) return;
    cell_.resize(size, CellId{0});
    record_.resize(size, 0);
}

void ConformingMesh::fit_arrays(Workers& workers) {
    const std::size_t size = reserve_for_tets(), before = cell_.size();
    if (size == before) return;
    cell_.resize_as_is(size);
    record_.resize_as_is(size);
    workers.for_ranges(size - before, std::size_t{1} << 16, [&](std::size_t begin, std::size_t end, std::size_t) {
        std::fill(&cell_[before] + begin, &cell_[before] + end, CellId{0});
        std::fill(&record_[before] + begin, &record_[before] + end, 0U);
    });
}

void ConformingMesh::release_all_but_tets() {
    tri_.release_all_but_tets();
    info_.release();
    cell_.release();
    record_.release();
    records_.release();
    for (std::vector<std::vector<VertexId>>* lists : {&on_facet_, &on_segment_}) lists->clear();
}

TetLabels& ConformingMesh::labels_for_writing(TetId t) {
    std::uint32_t& r = record_[t.index()];
    if (r != 0) {
        keep_record(r);
    } else {
        keep(t);
        if (free_records_.empty()) {
            r = static_cast<std::uint32_t>(records_.size());
            records_.push_back(TetLabels{});
        } else {
            r = free_records_.back();
            free_records_.pop_back();
            keep_record(r);
            records_[r] = TetLabels{};
        }
    }
    return records_[r];
}

void ConformingMesh::drop_labels(TetId t) {
    std::uint32_t& r = record_[t.index()];
    if (r == 0) return;
    keep(t);
    free_records_.push_back(r);
    r = 0;
}

std::span<const FacetId> ConformingMesh::facets_of(const Placement& where) {
    if (where.carrier == CarrierKind::segment) return plc_->segments[where.carrier_id].facets;
    carrier_facets_.clear();
    if (where.carrier == CarrierKind::facet) carrier_facets_.push_back(FacetId{where.carrier_id});
    return carrier_facets_;
}

bool ConformingMesh::is_on_facet(VertexId v, FacetId f) const {
    const VertexInfo& i = info(v);
    switch (i.carrier) {
        case CarrierKind::facet: return i.carrier_id == f.value();
        case CarrierKind::segment: {
            const auto& facets = plc_->segments[i.carrier_id].facets;
            return std::find(facets.begin(), facets.end(), f) != facets.end();
        }
        case CarrierKind::input_vertex: {
            const auto& on = plc_->facets[f.index()].vertices;
            return std::binary_search(on.begin(), on.end(), v);
        }
        case CarrierKind::region: return false;
    }
    return false;
}

std::vector<VertexId> ConformingMesh::steiner_vertices_of(FacetId f) const {
    std::vector<VertexId> out = on_facet_[f.index()];
    for (const SegmentId s : plc_->facets[f.index()].segments) {
        const auto more = steiner_vertices_of(s);
        out.insert(out.end(), more.begin(), more.end());
    }
    std::erase_if(out, [&](VertexId v) { return !tri_.is_inserted(v); });
    std::sort(out.begin(), out.end());
    return out;
}

std::vector<VertexId> ConformingMesh::steiner_vertices_of(SegmentId s) const {
    std::vector<VertexId> out = on_segment_[s.index()];
    std::erase_if(out, [&](VertexId v) { return !tri_.is_inserted(v); });
    return out;
}

std::vector<VertexId> ConformingMesh::chain_of(SegmentId s) const {
    const ValidSegment& segment = plc_->segments[s.index()];
    const Vec3 &a = point(segment.ends[0]), &b = point(segment.ends[1]);
    std::vector<std::pair<double, VertexId>> sorted{{-1e300, segment.ends[0]}, {1e300, segment.ends[1]}};
    for (const VertexId v : steiner_vertices_of(s)) sorted.push_back({dot(point(v) - a, b - a), v});
    std::sort(sorted.begin(), sorted.end());
    std::vector<VertexId> out;
    for (const auto& [along, v] : sorted) out.push_back(v);
    return out;
}

// ------------------------------------------------------------------------------------------------ labels

void ConformingMesh::label_edge(VertexId a, VertexId b, SegmentId s) {
    const TetId first = tri_.find_edge(a, b);
    if (!first.valid()) return;
    const TetStore& tets = tri_.tets();
    TetId t = first;
    const auto& corners = tets.corners(t);
    VertexId ahead{}, behind{};
    for (const VertexId v : corners)
        if (v != a && v != b) (ahead.valid() ? behind : ahead) = v;
    do {
        const unsigned edge = kEdgeOf[tets.find_corner(t, a)][tets.find_corner(t, b)];
        if (s.valid() || has_labels(t)) labels_for_writing(t).segments[edge] = s;
        const TetFace next = tets.across(t, tets.find_corner(t, behind));
        behind = ahead;
        ahead = tets.corner(next.tet(), next.face());
        t = next.tet();
    } while (t != first);
}

void ConformingMesh::label_face(TetFace tf, FacetId f) {
    if (f.valid()) facet_labelled_[f.index()] = 1;
    for (const TetFace side : {tf, tri_.tets().across(tf)})
        if (f.valid() || has_labels(side.tet())) labels_for_writing(side.tet()).facets[side.face()] = f;
}

/// Both sides of every face with the label.
std::vector<TetFace> ConformingMesh::labelled_faces(FacetId f) {
    std::vector<TetFace> out;
    if (!facet_labelled_[f.index()]) return out;  // never recovered yet
    std::vector<VertexId> on = plc_->facets[f.index()].vertices;
    for (const VertexId v : steiner_vertices_of(f)) on.push_back(v);
    std::vector<TetId> star;
    for (const VertexId v : on) {
        tri_.find_star(v, star);
        for (const TetId t : star)
            if (has_labels(t))
                for (unsigned k = 0; k < 4; ++k)
                    if (labels(t).facets[k] == f) out.emplace_back(t, k);
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

void ConformingMesh::relabel_facet(FacetId f, const std::vector<TetFace>& faces) {
    const std::vector<TetFace> before = labelled_faces(f);
    std::vector<TetFace> after;
    for (const TetFace tf : faces)
        for (const TetFace side : {tf, tri_.tets().across(tf)}) after.push_back(side);
    std::sort(after.begin(), after.end());
    std::vector<TetFace> changed;
    std::set_difference(before.begin(), before.end(), after.begin(), after.end(), std::back_inserter(changed));
    for (const TetFace tf : changed) labels_for_writing(tf.tet()).facets[tf.face()] = FacetId{};
    const std::size_t lost = changed.size();
    std::set_difference(after.begin(), after.end(), before.begin(), before.end(), std::back_inserter(changed));
    for (std::size_t i = lost; i < changed.size(); ++i) labels_for_writing(changed[i].tet()).facets[changed[i].face()] = f;
    for (const TetFace tf : changed) forget_cell(tf.tet());
    facet_labelled_[f.index()] = 1;
}

void ConformingMesh::forget_cell(TetId t) {
    keep(t);
    cell_[t.index()] = tri_.tets().is_ghost(t) ? CellId{0} : unknown_cell();
    forgotten_.push_back(t);
}

TetId ConformingMesh::find_subsegment(const Subsegment& s) {
    if (!tri_.is_inserted(s.a) || !tri_.is_inserted(s.b)) return {};
    const TetId t = tri_.find_edge(s.a, s.b);
    if (!t.valid() || segment_at(t, kEdgeOf[tets().find_corner(t, s.a)][tets().find_corner(t, s.b)]) != s.segment) return {};
    return t;
}

TetFace ConformingMesh::find_subface(const Subface& s) {
    if (s.near.valid() && tri_.may_look_at(s.near)) {
        const auto& store = tets();
        unsigned opposite = 0 + 1 + 2 + 3;
        bool has_all = true;
        for (const VertexId v : s.corners) {
            const unsigned at = store.find_corner(s.near, v);
            has_all = has_all && at < 4;
            opposite -= at;
        }
        if (has_all) return facet_at(TetFace{s.near, opposite}) == s.facet ? TetFace{s.near, opposite} : TetFace{};
    }
    for (const VertexId v : s.corners)
        if (!tri_.is_inserted(v)) return {};
    const TetFace tf = tri_.find_face(s.corners[0], s.corners[1], s.corners[2]);
    if (!tf.valid() || facet_at(tf) != s.facet) return {};
    return tf;
}

std::vector<FacetId> ConformingMesh::take_broken_facets() {
    std::sort(broken_facets_.begin(), broken_facets_.end());
    broken_facets_.erase(std::unique(broken_facets_.begin(), broken_facets_.end()), broken_facets_.end());
    return std::exchange(broken_facets_, {});
}

std::vector<SegmentId> ConformingMesh::take_broken_segments() {
    std::sort(broken_segments_.begin(), broken_segments_.end());
    broken_segments_.erase(std::unique(broken_segments_.begin(), broken_segments_.end()), broken_segments_.end());
    return std::exchange(broken_segments_, {});
}

}  // namespace wellmesh
