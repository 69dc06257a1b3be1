// SPDX-License-Identifier: Apache-2.0
// A conforming mesh split into views of zones, and put together again.
#include <algorithm>
#include <utility>

#include "conforming/conforming_mesh.hpp"
#include "core/check.hpp"
#include "delaunay/zones.hpp"

namespace wellmesh {
namespace {

/// Tetrahedra and records of labels that each zone may have more of: vertices that move change their number by little.
constexpr std::size_t kSpare = 2048;

}  // namespace

std::vector<ConformingMesh> ConformingMesh::split(Workers& workers, const Zones& zones, ZoneViews& parts) {
    tri_.split(workers, zones, kSpare, parts);
    fit_arrays();
    const std::size_t share = kSpare * zones.count();
    while (free_records_.size() < share) {
        free_records_.push_back(static_cast<std::uint32_t>(records_.size()));
        records_.push_back(TetLabels{});
    }
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
        view.free_records_.assign(free_records_.end() - static_cast<std::ptrdiff_t>(kSpare), free_records_.end());
        free_records_.resize(free_records_.size() - kSpare);
        view.filled_ = filled_;
    }
    return views;
}

void ConformingMesh::join(std::vector<ConformingMesh>& views) {
    for (ConformingMesh& view : views) {
        WELLMESH_CHECK(Stage::shape, view.vertex_count_ == vertex_count_ && !view.has_broken() && view.forgotten_.empty());
        tri_.join(view.tri_);
        free_records_.insert(free_records_.end(), view.free_records_.begin(), view.free_records_.end());
    }
}

}  // namespace wellmesh
