// SPDX-License-Identifier: Apache-2.0
// Exact inverses of insertion and removal, labels included.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "conforming/conforming_mesh.hpp"
#include "core/check.hpp"

namespace wellmesh {
namespace {

TetStore::Corners sorted(TetStore::Corners c) {
    const auto order = [&](std::size_t i, std::size_t j) {
        const VertexId low = std::min(c[i], c[j]), high = std::max(c[i], c[j]);
        c[i] = low;
        c[j] = high;
    };
    order(0, 1);
    order(2, 3);
    order(0, 2);
    order(1, 3);
    order(1, 2);
    return c;
}

/// Two words, compared faster than four ids.
std::array<std::uint64_t, 2> words_of(const TetStore::Corners& c) { return std::bit_cast<std::array<std::uint64_t, 2>>(c); }

}  // namespace

void ConformingMesh::save(const std::vector<TetId>& tets, Snapshot& snapshot) const {
    snapshot.entries.clear();
    for (const TetId t : tets) {
        Snapshot::Entry e{sorted(tri_.tets().corners(t)), cell(t), has_labels(t), {}};
        if (e.labelled) {
            // Faces and edges are kept in the order of the sorted corners.
            const auto& c = tri_.tets().corners(t);
            const TetLabels& l = labels(t);
            const auto rank = [&](unsigned i) { return static_cast<std::size_t>(std::find(e.corners.begin(), e.corners.end(), c[i]) - e.corners.begin()); };
            for (unsigned f = 0; f < 4; ++f) e.labels.facets[rank(f)] = l.facets[f];
            for (unsigned k = 0; k < 6; ++k) e.labels.segments[kEdgeOf[rank(kEdgeCorners[k][0])][rank(kEdgeCorners[k][1])]] = l.segments[k];
        }
        snapshot.entries.push_back(e);
    }
}

/// Gives the triangulation's new tetrahedra, which must be those of the snapshot, their cells and labels back.
void ConformingMesh::restore(const Snapshot& snapshot) {
    const auto& fresh = tri_.new_tets();
    WELLMESH_CHECK(Stage::shape, fresh.size() == snapshot.entries.size());
    const TetStore& tets = tri_.tets();
    for (const TetId t : fresh) {
        const auto& c = tets.corners(t);
        const auto key = sorted(c);
        const auto [first, second] = words_of(key);
        const auto e = std::find_if(snapshot.entries.begin(), snapshot.entries.end(), [&](const Snapshot::Entry& x) {
            const auto [their_first, their_second] = words_of(x.corners);
            return ((their_first ^ first) | (their_second ^ second)) == 0;
        });
        WELLMESH_CHECK(Stage::shape, e != snapshot.entries.end());
        cell_[t.index()] = e->cell;
        if (!e->labelled) continue;
        TetLabels& l = labels_for_writing(t);
        const auto rank = [&](unsigned i) { return static_cast<std::size_t>(std::find(key.begin(), key.end(), c[i]) - key.begin()); };
        for (unsigned f = 0; f < 4; ++f) l.facets[f] = e->labels.facets[rank(f)];
        for (unsigned k = 0; k < 6; ++k) l.segments[k] = e->labels.segments[kEdgeOf[rank(kEdgeCorners[k][0])][rank(kEdgeCorners[k][1])]];
    }
    // The insertion may have taken a face's label away outside the cavity too.
    for (const TetId t : fresh) {
        if (!has_labels(t)) continue;
        for (unsigned f = 0; f < 4; ++f) {
            const FacetId mine = labels(t).facets[f];
            const TetFace outside = tets.across(t, f);
            if (mine.valid() && facet_at(outside) != mine) labels_for_writing(outside.tet()).facets[outside.face()] = mine;
        }
    }
}

void ConformingMesh::undo_insertion(VertexId v, const Placement& where, const Snapshot& before) {
    WELLMESH_CHECK(Stage::shape, tri_.find_hole(v, undo_hole_));
    for (const TetId t : undo_hole_.star) drop_labels(t);
    remove_vertex(undo_hole_);
    --vertex_count_;
    restore(before);
    if (where.carrier == CarrierKind::segment) label_edge(where.a, where.b, SegmentId{where.carrier_id});
}

void ConformingMesh::undo_new_insertion(VertexId v, const Placement& where, const Snapshot& before) {
    undo_insertion(v, where, before);
    if (!tri_.is_view()) return;
    WELLMESH_CHECK(Stage::shape, !added_.empty() && added_.back() == v);
    added_.pop_back();
    spare_vertices_.push_back(v);
}

void ConformingMesh::undo_removal(VertexId v, const Placement& where, const Snapshot& before, std::span<const TetId> filling) {
    // Whatever is in the hole is in conflict with v: then no walk is needed, which might leave a view's zone.
    const auto known = std::find_if(filling.begin(), filling.end(), [&](TetId t) { return tri_.in_conflict(t, point(v)); });
    const TetId seed = known != filling.end() ? *known : tri_.locate(point(v), tri_.new_tets()[0]);
    WELLMESH_CHECK(Stage::shape, seed.valid() && tri_.grow_conflict_cavity(point(v), seed, undo_cavity_, [](const BoundaryFace&) { return true; }));
    for (const TetId t : undo_cavity_.tets) drop_labels(t);
    insert_vertex(v, undo_cavity_);
    ++vertex_count_;
    restore(before);
    if (where.carrier == CarrierKind::segment) label_edge(where.a, where.b, SegmentId{});
}

}  // namespace wellmesh
