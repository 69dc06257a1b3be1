// SPDX-License-Identifier: Apache-2.0
// Many vertices at once, also on segments and facets: labels are taken off, and put on again by the names of the faces and edges that have them.
#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <utility>
#include <vector>

#include "conforming/conforming_mesh.hpp"
#include "core/check.hpp"
#include "core/corner_table.hpp"

namespace wellmesh {
namespace {

constexpr std::size_t kSlotsAPiece = std::size_t{1} << 14;

/// The carrier of a vertex, which tells of most edges and faces that they are none of the boundary.
class Place {
public:
    Place() = default;
    explicit Place(const VertexInfo& info) : packed_(info.carrier_id << 2 | static_cast<std::uint32_t>(info.carrier)) {}
    [[nodiscard]] bool is(CarrierKind kind) const { return (packed_ & 3U) == static_cast<std::uint32_t>(kind); }
    [[nodiscard]] bool is_inside() const { return is(CarrierKind::region); }
    friend bool operator==(const Place&, const Place&) = default;

private:
    std::uint32_t packed_ = static_cast<std::uint32_t>(CarrierKind::region);
};

bool may_be_on_segment(const Place& a, const Place& b) {
    if (a.is(CarrierKind::segment) && b.is(CarrierKind::segment)) return a == b;
    return (a.is(CarrierKind::segment) || a.is(CarrierKind::input_vertex)) && (b.is(CarrierKind::segment) || b.is(CarrierKind::input_vertex));
}

bool may_be_on_facet(const Place& a, const Place& b, const Place& c) {
    if (a.is_inside() || b.is_inside() || c.is_inside()) return false;
    const auto differ = [](const Place& p, const Place& q) { return p.is(CarrierKind::facet) && q.is(CarrierKind::facet) && p != q; };
    return !differ(a, b) && !differ(b, c) && !differ(c, a);
}

}  // namespace

VertexId ConformingMesh::add_vertices(std::size_t n) {
    info_.resize_as_is(info_.size() + n);
    return tri_.add_points(n);
}

void ConformingMesh::set_new_vertex(VertexId v, const CarriedPoint& p, InsertionReason reason, VertexId ball) {
    info_[v.index()] = {.carrier = p.carrier, .reason = reason, .carrier_id = p.carrier_id, .ball = ball};
    tri_.set_new_point(v, p.point);
}

void ConformingMesh::insert_at_once(Workers& workers, std::span<const std::uint32_t> order) {
    WELLMESH_CHECK(Stage::refine, frames_.empty() && !tri_.is_view());
    (void)tri_.insert_on(workers, order);
    for (const std::uint32_t i : order) {
        if (!tri_.is_inserted(VertexId{i})) continue;  // at the place of another
        ++vertex_count_;
        note_carrier(VertexId{i});
    }
    tri_.release_scratch();
    (void)tri_.renumber(workers);
    fit_arrays(workers);
    workers.for_ranges(cell_.size(), kSlotsAPiece, [&](std::size_t begin, std::size_t end, std::size_t) {
        std::fill(&cell_[0] + begin, &cell_[0] + end, CellId{0});
        std::fill(&record_[0] + begin, &record_[0] + end, 0U);
    });
    records_.resize_as_is(1);
    std::vector<std::uint32_t>().swap(free_records_);
    forgotten_.clear();
}

void ConformingMesh::relabel(Workers& workers, std::span<const Subsegment> segments, std::span<const Subface> faces) {
    WELLMESH_CHECK(Stage::conform, frames_.empty() && records_.size() == 1);
    const CornerTable<2> segment_at(workers, info_.size(), segments.size(), [&](std::size_t i) { return std::array{segments[i].a, segments[i].b}; });
    const CornerTable<3> face_at(workers, info_.size(), faces.size(), [&](std::size_t i) { return faces[i].corners; });
    std::vector<std::uint8_t> has_segment(segments.size(), 0), has_face(faces.size(), 0);
    const auto mark = [](std::uint8_t& m) { std::atomic_ref<std::uint8_t>(m).store(1, std::memory_order_relaxed); };
    SharedArray<Place> place;
    place.resize_as_is(info_.size());
    workers.for_ranges(place.size(), kSlotsAPiece, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t v = begin; v < end; ++v) place[v] = Place(info_[v]);
    });
    struct Labelled {
        TetId t;
        TetLabels labels;
    };
    const std::size_t slots = tri_.tets().slots();
    std::vector<std::vector<Labelled>> found((slots + kSlotsAPiece - 1) / kSlotsAPiece);
    workers.for_ranges(slots, kSlotsAPiece, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        for (std::size_t i = begin; i < end; ++i) {
            const TetId t{i};
            if (!tets().is_live(t)) continue;
            const TetStore::Corners& c = tets().corners(t);
            std::array<Place, 4> at{};
            unsigned on_boundary = 0;
            for (unsigned k = 0; k < 4; ++k) {
                if (c[k] != kInfiniteVertex) at[k] = place[c[k].index()];
                on_boundary += at[k].is_inside() ? 0U : 1U;
            }
            if (on_boundary < 2) continue;
            TetLabels labels;
            bool any = false;
            for (unsigned e = 0; e < 6; ++e) {
                const auto [j, k] = kEdgeCorners[e];
                if (!may_be_on_segment(at[j], at[k])) continue;
                const std::uint32_t s = segment_at.find({c[j], c[k]});
                if (s == segment_at.kNone) continue;
                labels.segments[e] = segments[s].segment;
                mark(has_segment[s]);
                any = true;
            }
            for (unsigned f = 0; f < 4 && on_boundary > 2; ++f) {
                if (!may_be_on_facet(at[(f + 1) % 4], at[(f + 2) % 4], at[(f + 3) % 4])) continue;
                const std::uint32_t s = face_at.find({c[(f + 1) % 4], c[(f + 2) % 4], c[(f + 3) % 4]});
                if (s == face_at.kNone) continue;
                labels.facets[f] = faces[s].facet;
                mark(has_face[s]);
                any = true;
            }
            if (any) found[piece].push_back({t, labels});
        }
    });
    std::vector<std::size_t> first(found.size() + 1, 1);  // record 0 means none
    for (std::size_t i = 0; i < found.size(); ++i) first[i + 1] = first[i] + found[i].size();
    records_.resize_as_is(first.back());
    workers.for_each(found.size(), [&](std::size_t piece) {
        const std::vector<Labelled>& labelled = found[piece];
        for (std::size_t k = 0; k < labelled.size(); ++k) {
            record_[labelled[k].t.index()] = static_cast<std::uint32_t>(first[piece] + k);
            records_[first[piece] + k] = labelled[k].labels;
        }
    });
    broken_segments_.clear();
    broken_facets_.clear();
    for (std::size_t s = 0; s < segments.size(); ++s)
        if (has_segment[s] == 0) broken_segments_.push_back(segments[s].segment);
    for (std::size_t s = 0; s < faces.size(); ++s) {
        if (has_face[s] == 0) broken_facets_.push_back(faces[s].facet);
        else facet_labelled_[faces[s].facet.index()] = 1;
    }
}

void ConformingMesh::find_cells_by_vertices(Workers& workers) {
    WELLMESH_CHECK(Stage::refine, frames_.empty());
    forgotten_.clear();
    const std::size_t slots = tri_.tets().slots();
    std::vector<std::vector<TetId>> left((slots + kSlotsAPiece - 1) / kSlotsAPiece);
    workers.for_ranges(slots, kSlotsAPiece, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        for (std::size_t i = begin; i < end; ++i) {
            const TetId t{i};
            cell_[i] = CellId{0};
            if (!tets().is_live(t) || tets().is_ghost(t)) continue;
            const TetStore::Corners& c = tets().corners(t);
            const auto inside = std::find_if(c.begin(), c.end(), [&](VertexId v) { return info(v).carrier == CarrierKind::region; });
            cell_[i] = inside != c.end() ? CellId{info(*inside).carrier_id} : unknown_cell();
            if (inside == c.end()) left[piece].push_back(t);
        }
    });
    for (const std::vector<TetId>& some : left) forgotten_.insert(forgotten_.end(), some.begin(), some.end());
}

}  // namespace wellmesh
