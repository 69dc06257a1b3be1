// SPDX-License-Identifier: Apache-2.0
// What is kept for savepoints, and how a mesh is put back. Every change of a tetrahedron, a vertex or a record of labels passes a keep(); all that is small is
// copied when a savepoint begins.
#include "conforming/savepoint.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace wellmesh {

void ConformingMesh::open_savepoint() {
    WELLMESH_CHECK(Stage::shape, !tri_.is_view());
    const auto sizes = [](const std::vector<std::vector<VertexId>>& lists) {
        std::vector<std::size_t> out(lists.size());
        std::transform(lists.begin(), lists.end(), out.begin(), [](const std::vector<VertexId>& list) { return list.size(); });
        return out;
    };
    frames_.push_back({tri_.frame(), vertex_count_, records_.size(), free_records_, sizes(on_facet_), sizes(on_segment_), facet_labelled_, forgotten_,
                       broken_facets_, broken_segments_, spare_vertices_});
    old_tets_.open(tets().slots());
    old_vertices_.open(info_.size());
    old_records_.open(records_.size());
}

void ConformingMesh::roll_back() {
    WELLMESH_CHECK(Stage::shape, !has_views_);
    const Frame& frame = frames_.back();
    tri_.cut_back(frame.triangulation);
    cell_.resize_as_is(frame.triangulation.slots);  // fit_arrays() fills what comes after
    record_.resize_as_is(frame.triangulation.slots);
    info_.resize_as_is(frame.triangulation.vertices);
    records_.resize_as_is(frame.records);
    old_tets_.roll_back([&](std::size_t i, const TetState& was) {
        tri_.put_back(TetId{i}, was.corners, was.across);
        cell_[i] = was.cell;
        record_[i] = was.record;
    });
    old_vertices_.roll_back([&](std::size_t i, const VertexState& was) {
        tri_.put_back(VertexId{i}, was.point, was.some_tet);
        info_[i] = was.info;
    });
    old_records_.roll_back([&](std::size_t r, const TetLabels& was) { records_[r] = was; });
    const auto cut = [](std::vector<std::vector<VertexId>>& lists, const std::vector<std::size_t>& sizes) {
        for (std::size_t i = 0; i < lists.size(); ++i) lists[i].resize(sizes[i]);
    };
    cut(on_facet_, frame.on_facet);
    cut(on_segment_, frame.on_segment);
    vertex_count_ = frame.vertex_count;
    free_records_ = frame.free_records;
    facet_labelled_ = frame.facet_labelled;
    forgotten_ = frame.forgotten;
    broken_facets_ = frame.broken_facets;
    broken_segments_ = frame.broken_segments;
    spare_vertices_ = frame.spare_vertices;
}

void ConformingMesh::close_savepoint() {
    old_tets_.close();
    old_vertices_.close();
    old_records_.close();
    frames_.pop_back();
}

/// Of tetrahedra that are about to go, and of what lies behind them. All vertices that get another tetrahedron are theirs.
void ConformingMesh::keep_surroundings(std::span<const TetId> going, std::span<const BoundaryFace> boundary) {
    for (const TetId t : going) {
        keep(t);
        for (const VertexId v : tets().corners(t))
            if (v != kInfiniteVertex) keep(v);
    }
    for (const BoundaryFace& b : boundary) keep(b.outside.tet());
}

/// Of new tetrahedra beyond the recycled ones: their slots held none.
void ConformingMesh::keep_taken(std::size_t recycled) {
    const std::vector<TetId>& fresh = tri_.new_tets();
    for (std::size_t k = recycled; k < fresh.size(); ++k)
        if (const std::size_t i = fresh[k].index(); old_tets_.wants(i)) old_tets_.keep(i, {{}, {}, cell_[i], record_[i]});
}

/// What the triangulation's does, kept for savepoints.
void ConformingMesh::insert_vertex(VertexId v, const Cavity& cavity) {
    const bool keeps = old_tets_.is_open();
    if (keeps) {
        keep(v);
        keep_surroundings(cavity.tets, cavity.boundary);
    }
    tri_.insert_vertex(v, cavity);
    if (keeps) keep_taken(cavity.tets.size());
    fit_arrays();
}

void ConformingMesh::remove_vertex(const Hole& hole) {
    const bool keeps = old_tets_.is_open();
    if (keeps) keep_surroundings(hole.star, hole.boundary);
    tri_.remove_vertex(hole);
    if (keeps) keep_taken(hole.star.size());
    fit_arrays();
}

}  // namespace wellmesh
