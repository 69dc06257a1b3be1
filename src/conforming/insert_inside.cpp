// SPDX-License-Identifier: Apache-2.0
// Bulk insertion inside cells, and numbering afterwards.
#include <algorithm>
#include <numeric>

#include "conforming/conforming_mesh.hpp"

namespace wellmesh {

/// A cavity without labels is inside one cell, and no subface or subsegment is encroached by its point: the tetrahedra at one that is would be in it.
class ConformingMesh::InsideObserver : public BulkObserver {
public:
    InsideObserver(ConformingMesh& mesh, const std::function<bool(const Vec3&, CellId)>& is_welcome, const std::function<bool()>& may_go_on)
        : mesh_(mesh), is_welcome_(is_welcome), may_go_on_(may_go_on) {}
    void make_room(std::size_t) override { mesh_.fit_arrays(); }
    bool welcomes(const Vec3& p, TetId holder) override {
        return !mesh_.tets().is_ghost(holder) && mesh_.in_domain(holder) && is_welcome_(p, mesh_.cell(holder));
    }
    std::uint32_t prepare(const Cavity& cavity) override {
        if (std::any_of(cavity.tets.begin(), cavity.tets.end(), [&](TetId t) { return mesh_.has_labels(t); })) return kRefused;
        return mesh_.cell(cavity.tets[0]).value();
    }
    void made(VertexId v, const std::vector<TetId>& tets, std::uint32_t cell) override {
        mesh_.info_[v.index()].carrier_id = cell;
        for (const TetId t : tets) {
            mesh_.cell_[t.index()] = CellId{cell};
            mesh_.record_[t.index()] = 0;
        }
    }
    bool may_go_on() override { return may_go_on_(); }

private:
    ConformingMesh& mesh_;
    const std::function<bool(const Vec3&, CellId)>& is_welcome_;
    const std::function<bool()>& may_go_on_;
};

std::vector<VertexId> ConformingMesh::insert_inside(Workers& workers, std::span<const Vec3> points, InsertionReason reason,
                                                    const std::function<bool(const Vec3&, CellId)>& is_welcome, const std::function<bool()>& may_go_on) {
    const std::size_t first = tri_.vertex_count();
    tri_.reserve(first + points.size());
    for (const Vec3& p : points) {
        (void)tri_.add_point(p);
        info_.push_back({.carrier = CarrierKind::region, .reason = reason});
    }
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), static_cast<std::uint32_t>(first));
    InsideObserver observer(*this, is_welcome, may_go_on);
    std::vector<VertexId> left;
    for (const std::uint32_t v : tri_.insert_on(workers, order, &observer)) left.push_back(VertexId{v});
    for (std::size_t v = first; v < info_.size(); ++v) vertex_count_ += tri_.is_inserted(VertexId{v});
    return left;
}

void ConformingMesh::insert_known(VertexId v, const Cavity& cavity, const Placement& where) {
    info_[v.index()].carrier_id = where.carrier_id;
    ++vertex_count_;
    commit(v, cavity, where);
}

void ConformingMesh::renumber_tets(Workers& workers) {
    // Labels stand by corner: they follow their vertices.
    const TetStore& tets = tri_.tets();
    std::vector<TetStore::Corners> labelled(records_.size());
    for (std::size_t i = 0; i < record_.size() && i < tets.slots(); ++i)
        if (record_[i] != 0 && tets.is_live(TetId{i})) labelled[record_[i]] = tets.corners(TetId{i});
    const std::vector<TetId> old_of = tri_.renumber(workers);
    std::vector<CellId> cells(old_of.size());
    std::vector<std::uint32_t> records(old_of.size());
    std::vector<TetLabels> ordered(1);  // 0: no labels
    for (std::size_t i = 0; i < old_of.size(); ++i) {
        const TetId t{i};
        cells[i] = cell_[old_of[i].index()];
        const std::uint32_t r = record_[old_of[i].index()];
        if (r == 0) continue;
        const TetLabels& before = records_[r];
        std::array<std::size_t, 4> slot{};  // by corner: where it was
        for (unsigned k = 0; k < 4; ++k)
            slot[k] = static_cast<std::size_t>(std::find(labelled[r].begin(), labelled[r].end(), tets.corner(t, k)) - labelled[r].begin());
        records[i] = static_cast<std::uint32_t>(ordered.size());
        TetLabels& after = ordered.emplace_back();
        for (unsigned k = 0; k < 4; ++k) after.facets[k] = before.facets[slot[k]];
        for (unsigned e = 0; e < 6; ++e) after.segments[e] = before.segments[kEdgeOf[slot[kEdgeCorners[e][0]]][slot[kEdgeCorners[e][1]]]];
    }
    cell_ = std::move(cells);
    record_ = std::move(records);
    records_ = std::move(ordered);
    free_records_.clear();
}

}  // namespace wellmesh
