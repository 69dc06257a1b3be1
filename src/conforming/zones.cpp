// SPDX-License-Identifier: Apache-2.0
// A conforming mesh split into views of zones, and put together again.
#include <algorithm>
#include <utility>

#include "conforming/conforming_mesh.hpp"
#include "core/check.hpp"
#include "delaunay/zones.hpp"

namespace wellmesh {

std::vector<ConformingMesh> ConformingMesh::split(Workers& workers, const Zones& zones, const ZoneRoom& room, ZoneViews& parts) {
    if (const std::size_t wanted = room.vertices * zones.count(); spare_vertices_.size() < wanted) {
        // The first zone takes from the end: the smallest ids are for it.
        std::vector<VertexId> more;
        while (more.size() + spare_vertices_.size() < wanted) {
            more.push_back(tri_.add_point(Vec3{}));
            info_.push_back({});
        }
        spare_vertices_.insert(spare_vertices_.begin(), more.rbegin(), more.rend());
    }
    tri_.split(workers, zones, room.tets, parts);
    fit_arrays(workers);
    if (const std::size_t wanted = room.records * zones.count(), free = free_records_.size(); free < wanted) {
        // Left as they are in memory: most are never used.
        for (std::size_t r = records_.size(); r < records_.size() + wanted - free; ++r) free_records_.push_back(static_cast<std::uint32_t>(r));
        records_.resize_as_is(records_.size() + wanted - free);
    }
    const auto take = [](auto& from, std::size_t count, auto& to) {
        to.assign(from.end() - static_cast<std::ptrdiff_t>(count), from.end());
        from.resize(from.size() - count);
    };
    has_views_ = true;
    std::vector<ConformingMesh> views;
    views.reserve(zones.count());
    for (std::size_t z = 0; z < zones.count(); ++z) {
        ConformingMesh& view = views.emplace_back(ConformingMesh());
        view.plc_ = plc_;
        view.tri_ = std::move(parts.views[z]);
        view.info_ = info_.view();
        view.vertex_count_ = vertex_count_;
        view.cell_ = cell_.view();
        view.record_ = record_.view();
        view.records_ = records_.view();
        take(free_records_, room.records, view.free_records_);
        take(spare_vertices_, room.vertices, view.spare_vertices_);
        view.filled_ = filled_;
        view.old_tets_ = old_tets_.view();
        view.old_vertices_ = old_vertices_.view();
        view.old_records_ = old_records_.view();
    }
    return views;
}

void ConformingMesh::join(std::vector<ConformingMesh>& views) {
    has_views_ = false;
    const std::size_t before = vertex_count_;
    for (ConformingMesh& view : views) {
        WELLMESH_CHECK(Stage::shape, view.vertex_count_ <= before + view.added_.size() && !view.has_broken() && view.forgotten_.empty());
        tri_.join(view.tri_);
        old_tets_.join(view.old_tets_);
        old_vertices_.join(view.old_vertices_);
        old_records_.join(view.old_records_);
        free_records_.insert(free_records_.end(), view.free_records_.begin(), view.free_records_.end());
        vertex_count_ = vertex_count_ + view.vertex_count_ - before;  // fewer where vertices were taken out
        for (const VertexId v : view.added_) note_carrier(v);
    }
    for (std::size_t z = views.size(); z-- > 0;) spare_vertices_.insert(spare_vertices_.end(), views[z].spare_vertices_.begin(), views[z].spare_vertices_.end());
}

bool ConformingMesh::may_insert(const Cavity& cavity, const Placement& where) {
    planned_ = false;
    if (!tri_.is_view()) return true;
    if (tri_.left_zone()) return false;
    const std::size_t made = cavity.boundary.size();
    bool may = !spare_vertices_.empty() && tri_.has_room(made);
    if (may && std::any_of(cavity.tets.begin(), cavity.tets.end(), [&](TetId t) { return has_labels(t) || cell_[t.index()] != cell_[cavity.tets[0].index()]; })) {
        may = free_records_.size() >= made;
        if (may) {
            plan(cavity, where);
            planned_ = may = !breaks_something(where);
        }
    }
    if (!may || cell_[cavity.tets[0].index()] == unknown_cell()) tri_.leave_zone();
    return !tri_.left_zone();
}

}  // namespace wellmesh
