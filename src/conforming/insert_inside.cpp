// SPDX-License-Identifier: Apache-2.0
// Bulk insertion inside cells, and numbering afterwards.
#include <algorithm>
#include <array>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include "conforming/conforming_mesh.hpp"
#include "core/check.hpp"
#include "delaunay/known_tets.hpp"

namespace wellmesh {
namespace {

constexpr std::size_t kGrain = std::size_t{1} << 15;

}  // namespace

/// Points that encroach nothing destroy no subface or subsegment: labels on the cavity's boundary are inherited, and that is all.
class ConformingMesh::InsideObserver : public BulkObserver {
public:
    InsideObserver(ConformingMesh& mesh, Workers& workers, const std::function<bool(const Vec3&, CellId)>& is_welcome, const std::function<bool()>& may_go_on)
        : mesh_(mesh), workers_(workers), is_welcome_(is_welcome), may_go_on_(may_go_on) {}

    void make_room(std::size_t) override { mesh_.fit_arrays(workers_); }
    /// Each zone has records of its own, all of them together as many more as are in use now, and a few.
    void split(std::size_t zones) override {
        std::vector<std::uint32_t>& free = mesh_.free_records_;
        const std::size_t share = (mesh_.records_.size() - free.size()) / zones + kSpareRecords;
        parts_.clear();
        for (std::size_t z = 0; z < zones; ++z) parts_.emplace_back(mesh_, workers_, is_welcome_, may_go_on_);
        for (InsideObserver& part : parts_) {
            part.is_part_ = true;
            for (std::size_t k = 0; k < share; ++k) {
                if (free.empty()) {
                    free.push_back(static_cast<std::uint32_t>(mesh_.records_.size()));
                    mesh_.records_.resize_as_is(mesh_.records_.size() + 1);
                }
                part.records_.push_back(free.back());
                free.pop_back();
            }
        }
    }
    BulkObserver& for_zone(std::size_t zone) override { return parts_[zone]; }
    void join() override {
        for (const InsideObserver& part : parts_) {
            mesh_.free_records_.insert(mesh_.free_records_.end(), part.records_.begin(), part.records_.end());
            encroaching_.insert(encroaching_.end(), part.encroaching_.begin(), part.encroaching_.end());
        }
        parts_.clear();
    }

    bool welcomes(const Vec3& p, TetId holder) override {
        return !mesh_.tets().is_ghost(holder) && mesh_.in_domain(holder) && is_welcome_(p, mesh_.cell(holder));
    }
    Answer prepare(VertexId v, const Cavity& cavity) override {
        std::size_t dropped = 0;
        for (const TetId t : cavity.tets) {
            if (!mesh_.has_labels(t)) continue;
            ++dropped;
            if (mesh_.is_encroached_at(t, cavity.point)) {
                encroaching_.push_back(v);
                return Answer::never;
            }
        }
        if (dropped > 1 && deletes_subface(cavity)) return Answer::never;
        captured_.clear();
        cell_ = mesh_.cell(cavity.tets[0]);
        if (dropped == 0) return Answer::yes;  // no surface to pass on: one cell, as that of nearly every cavity
        if (is_part_ && records_.size() + dropped < cavity.boundary.size()) return Answer::not_now;
        mesh_.capture(cavity, captured_);
        for (const TetId t : cavity.tets) {
            std::uint32_t& r = mesh_.record_[t.index()];
            if (r != 0) pool().push_back(std::exchange(r, 0));
        }
        return Answer::yes;
    }
    void made(VertexId v, const std::vector<TetId>& tets) override {
        mesh_.info_[v.index()].carrier_id = cell_.value();
        if (captured_.empty()) {
            for (const TetId t : tets) {
                mesh_.cell_[t.index()] = cell_;
                mesh_.record_[t.index()] = 0;
            }
            return;
        }
        for (std::size_t i = 0; i < tets.size(); ++i) {
            const TetId t = tets[i];
            const CapturedFace& c = captured_[i];
            mesh_.cell_[t.index()] = c.cell;
            mesh_.record_[t.index()] = 0;
            if (!c.facet.valid() && !c.segments[0].valid() && !c.segments[1].valid() && !c.segments[2].valid()) continue;
            const TetStore& store = mesh_.tets();
            TetLabels labels;
            labels.facets[store.find_corner(t, v)] = c.facet;
            for (std::size_t k = 0; k < 3; ++k)
                labels.segments[kEdgeOf[store.find_corner(t, c.corners[(k + 1) % 3])][store.find_corner(t, c.corners[(k + 2) % 3])]] = c.segments[k];
            put(t, labels);
        }
    }
    bool may_go_on() override { return may_go_on_(); }
    [[nodiscard]] std::vector<VertexId>& encroaching() { return encroaching_; }

private:
    static constexpr std::size_t kSpareRecords = 1024;

    /// One that the point does not encroach upon, beside flat tetrahedra.
    [[nodiscard]] bool deletes_subface(const Cavity& cavity) const {
        for (const TetId t : cavity.tets)
            for (unsigned f = 0; f < 4; ++f) {
                if (!mesh_.facet_at(TetFace{t, f}).valid()) continue;
                const auto is_it = [&](const BoundaryFace& b) { return b.inside == TetFace{t, f}; };
                if (std::none_of(cavity.boundary.begin(), cavity.boundary.end(), is_it)) return true;
            }
        return false;
    }
    std::vector<std::uint32_t>& pool() { return is_part_ ? records_ : mesh_.free_records_; }
    void put(TetId t, const TetLabels& labels) {
        if (pool().empty()) {  // of the whole: a part's were counted
            pool().push_back(static_cast<std::uint32_t>(mesh_.records_.size()));
            mesh_.records_.push_back(TetLabels{});
        }
        mesh_.record_[t.index()] = pool().back();
        mesh_.records_[pool().back()] = labels;
        pool().pop_back();
    }

    ConformingMesh& mesh_;
    Workers& workers_;
    const std::function<bool(const Vec3&, CellId)>& is_welcome_;
    const std::function<bool()>& may_go_on_;
    bool is_part_ = false;
    std::vector<std::uint32_t> records_;
    std::vector<CapturedFace> captured_;  // none: no tetrahedron of the cavity has labels
    CellId cell_{};                       // of its first one
    std::vector<VertexId> encroaching_;   // vertices that were not to be
    std::vector<InsideObserver> parts_;
};

/// Does p encroach upon a subface or subsegment of this tetrahedron's? @pre it has labels
bool ConformingMesh::is_encroached_at(TetId t, const Vec3& p) const {
    const TetLabels& l = labels(t);
    const TetStore::Corners& c = tets().corners(t);
    for (unsigned e = 0; e < 6; ++e)
        if (l.segments[e].valid() && side_of_diametral_sphere(point(c[kEdgeCorners[e][0]]), point(c[kEdgeCorners[e][1]]), p) == Sign::positive) return true;
    for (unsigned f = 0; f < 4; ++f) {
        if (!l.facets[f].valid()) continue;
        const auto& k = kFaceCorners[f];
        if (side_of_equatorial_sphere(point(c[k[0]]), point(c[k[1]]), point(c[k[2]]), p) == Sign::positive) return true;
    }
    return false;
}

std::vector<VertexId> ConformingMesh::insert_inside(Workers& workers, std::span<const Vec3> points, std::span<const char> waits, InsertionReason reason,
                                                    const std::function<bool(const Vec3&, CellId)>& is_welcome, const std::function<bool()>& may_go_on,
                                                    std::vector<VertexId>& encroaching) {
    const std::size_t first = tri_.vertex_count();
    tri_.reserve(first + points.size());
    info_.reserve(first + points.size() + points.size() / 8);
    std::vector<VertexId> order;
    order.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const VertexId v = tri_.add_point(points[i]);
        info_.push_back({.carrier = CarrierKind::region, .reason = reason});
        if (waits.empty() || waits[i] == 0) order.push_back(v);
    }
    return insert_inside(workers, order, is_welcome, may_go_on, encroaching);
}

std::vector<VertexId> ConformingMesh::insert_inside(Workers& workers, std::span<const VertexId> vertices, const std::function<bool(const Vec3&, CellId)>& is_welcome,
                                                    const std::function<bool()>& may_go_on, std::vector<VertexId>& encroaching) {
    WELLMESH_CHECK(Stage::refine, frames_.empty());
    InsideObserver observer(*this, workers, is_welcome, may_go_on);
    std::vector<std::uint32_t> order(vertices.size());
    std::transform(vertices.begin(), vertices.end(), order.begin(), [](VertexId v) { return v.value(); });
    std::vector<VertexId> left;
    const std::vector<std::uint32_t> refused = tri_.insert_on(workers, order, &observer);
    encroaching = std::move(observer.encroaching());
    std::sort(encroaching.begin(), encroaching.end());
    for (const std::uint32_t v : refused)
        if (!std::binary_search(encroaching.begin(), encroaching.end(), VertexId{v})) left.push_back(VertexId{v});
    for (const VertexId v : vertices) vertex_count_ += tri_.is_inserted(v);
    return left;
}

bool ConformingMesh::put_known_tets(Workers& workers, const KnownTets& known, std::span<const VertexId> fresh, const std::function<bool()>& goes_on) {
    WELLMESH_CHECK(Stage::refine, frames_.empty());
    KnownRegion region;
    if (!tri_.find_region(workers, known, region, goes_on)) return false;
    std::vector<CellId> cell_of;  // by group
    for (std::size_t i = 0; i < region.tets.size(); ++i) {
        const TetId t = region.tets[i];
        if (region.group[i] >= cell_of.size()) cell_of.resize(region.group[i] + 1);
        CellId& cell = cell_of[region.group[i]];
        if (!cell.valid()) cell = cell_[t.index()];
        if (has_labels(t) || cell_[t.index()] != cell || cell == unknown_cell()) return false;
    }
    tri_.replace_region(workers, known, region);
    fit_arrays(workers);
    workers.for_each(known.pieces(), [&](std::size_t piece) {
        const bool only_one = cell_of.size() == 1;
        std::vector<KnownTets::Tet> tets;
        if (!only_one) known.list(piece, tets);
        for (std::size_t first = known.first(piece), n = first; n < known.first(piece + 1); ++n) {
            const std::size_t t = region.tet(n).index();
            cell_[t] = cell_of[only_one ? 0 : tets[n - first].group];
            record_[t] = 0;
        }
    });
    for (const VertexId v : fresh) info_[v.index()].carrier_id = cell_[tri_.tet_of(v).index()].value();
    vertex_count_ += fresh.size();
    return true;
}

void ConformingMesh::insert_known(VertexId v, const Cavity& cavity, const Placement& where) {
    set_carrier_id(v, where.carrier_id);
    ++vertex_count_;
    commit(v, cavity, where);
}

/// @param turned  called with each tetrahedron that has labels, and them: returns those to keep. From any thread.
template <class Turned>
void ConformingMesh::pack_records(Workers& workers, Turned&& turned) {
    WELLMESH_CHECK(Stage::refine, frames_.empty());
    const std::size_t tets = record_.size();
    std::vector<std::uint32_t> next((tets + kGrain - 1) / kGrain);
    workers.for_ranges(tets, kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        next[piece] = static_cast<std::uint32_t>(end - begin - static_cast<std::size_t>(std::count(&record_[0] + begin, &record_[0] + end, 0U)));
    });
    std::uint32_t used = 1;  // record 0 means none
    for (std::uint32_t& n : next) n = std::exchange(used, used + n);
    SharedArray<TetLabels> packed;
    packed.resize_as_is(used);
    packed[0] = TetLabels{};
    workers.for_ranges(tets, kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        for (std::size_t i = begin; i < end; ++i) {
            if (record_[i] == 0) continue;
            packed[next[piece]] = turned(TetId{i}, records_[record_[i]]);
            record_[i] = next[piece]++;
        }
    });
    records_ = std::move(packed);
    std::vector<std::uint32_t>().swap(free_records_);
}

void ConformingMesh::pack_records(Workers& workers) {
    pack_records(workers, [](TetId, const TetLabels& labels) { return labels; });
}

void ConformingMesh::renumber_tets(Workers& workers) {
    tri_.release_scratch();  // it would be for tetrahedra that are no more
    const Triangulation::Renumbering renumbering = tri_.renumber(workers);
    const std::vector<TetId>& old_of = renumbering.old_of;
    const auto take_along = [&](auto& values) {
        std::remove_reference_t<decltype(values)> moved;
        moved.reserve(values.capacity());
        moved.resize_as_is(old_of.size());
        workers.for_ranges(old_of.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t i = begin; i < end; ++i) moved[i] = values[old_of[i].index()];
        });
        values = std::move(moved);
    };
    take_along(cell_);
    take_along(record_);
    // Labels stand by corner: they follow their vertices.
    pack_records(workers, [&](TetId t, const TetLabels& before) {
        TetLabels labels;
        std::array<unsigned, 4> slot{};  // by corner: where it was
        for (unsigned k = 0; k < 4; ++k) slot[k] = renumbering.old_corner(t, k);
        for (unsigned k = 0; k < 4; ++k) labels.facets[k] = before.facets[slot[k]];
        for (unsigned e = 0; e < 6; ++e) labels.segments[e] = before.segments[kEdgeOf[slot[kEdgeCorners[e][0]]][slot[kEdgeCorners[e][1]]]];
        return labels;
    });
}

}  // namespace wellmesh
