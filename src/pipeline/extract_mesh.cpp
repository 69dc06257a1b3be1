// SPDX-License-Identifier: Apache-2.0
#include "pipeline/extract_mesh.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include "core/edge_key.hpp"
#include "core/huge_pages.hpp"
#include "core/resident_memory.hpp"
#include "core/shared_array.hpp"
#include "core/sorting.hpp"
#include "core/vec3_math.hpp"
#include "delaunay/spatial_order.hpp"

namespace wellmesh {
namespace {

constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kGrain = std::size_t{1} << 15;

struct ListedFace {
    std::array<std::uint32_t, 3> corners{};
    FacetId facet{};
};
struct ListedEdge {
    std::array<std::uint32_t, 2> ends{};
    SegmentId segment{};
    friend bool operator<(const ListedEdge& a, const ListedEdge& b) { return a.ends < b.ends; }
    friend bool operator==(const ListedEdge& a, const ListedEdge& b) { return a.ends == b.ends; }
};

void list_constraints(const ConformingMesh& mesh, TetId t, const std::vector<std::uint32_t>& number, std::vector<ListedFace>& faces, std::vector<ListedEdge>& edges) {
    const TetLabels& l = mesh.labels(t);
    const auto& c = mesh.tets().corners(t);
    for (unsigned f = 0; f < 4; ++f) {
        if (!l.facets[f].valid()) continue;
        const TetId other = mesh.tets().across(t, f).tet();
        if (other < t && !mesh.tets().is_ghost(other) && mesh.in_domain(other)) continue;  // listed from there
        const auto fc = mesh.tets().face_corners(TetFace{t, f});
        faces.push_back({{number[fc[0].index()], number[fc[1].index()], number[fc[2].index()]}, l.facets[f]});
    }
    for (unsigned e = 0; e < 6; ++e) {
        if (!l.segments[e].valid()) continue;
        const std::uint32_t a = number[c[kEdgeCorners[e][0]].index()], b = number[c[kEdgeCorners[e][1]].index()];
        edges.push_back({{std::min(a, b), std::max(a, b)}, l.segments[e]});
    }
}

/// Numbers the vertices of the output, stores them with their carriers, and lists its tetrahedra: input vertices in the input's order, then
/// the others along a space-filling curve, tetrahedra by their lowest vertex. So whoever walks through the mesh, a solver or the
/// certificate, walks through memory.
template <class InOutput>
SharedArray<TetId> number_output(const ConformingMesh& mesh, Workers& workers, InOutput&& in_output, std::vector<std::uint32_t>& number, TetMesh& out) {
    const TetStore& tets = mesh.tets();
    const ValidPlc& plc = mesh.plc();
    const bool alone = workers.threads() == 1;
    const auto for_output = [&](auto&& use) {
        workers.for_ranges(tets.slots(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t i = begin; i < end; ++i)
                if (in_output(TetId{i})) use(TetId{i});
        });
    };
    for_output([&](TetId t) {
        for (const VertexId v : tets.corners(t)) {
            std::uint32_t& n = number[v.index()];
            if (alone) n = 0;
            else std::atomic_ref(n).store(0, std::memory_order_relaxed);
        }
    });
    // Input vertices in front; where each piece's begin is known once all are counted.
    struct Counts {
        std::size_t input = 0, steiner = 0;
    };
    const auto for_used = [&](std::size_t begin, std::size_t end, auto&& use) {
        for (std::size_t i = begin; i < end; ++i)
            if (number[i] != kUnused) use(VertexId{i}, mesh.info(VertexId{i}).carrier == CarrierKind::input_vertex);
    };
    std::vector<Counts> before((number.size() + kGrain - 1) / kGrain);
    workers.for_ranges(number.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        for_used(begin, end, [&](VertexId, bool is_input) { ++(is_input ? before[piece].input : before[piece].steiner); });
    });
    Counts all;
    for (Counts& c : before) c = {std::exchange(all.input, all.input + c.input), std::exchange(all.steiner, all.steiner + c.steiner)};
    SharedArray<VertexId> order, steiner;
    SharedArray<Vec3> steiner_points;
    order.resize_as_is(all.input + all.steiner);
    steiner.resize_as_is(all.steiner);
    steiner_points.resize_as_is(all.steiner);
    workers.for_ranges(number.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        Counts next = before[piece];
        for_used(begin, end, [&](VertexId v, bool is_input) {
            if (is_input) {
                order[next.input++] = v;
            } else {
                steiner[next.steiner] = v;
                steiner_points[next.steiner++] = mesh.point(v);
            }
        });
    });
    const std::vector<std::uint32_t> along_curve = spatial_order({steiner_points.data(), steiner_points.size()}, workers);
    workers.for_ranges(all.steiner, kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) order[all.input + i] = steiner[along_curve[i]];
    });
    reserve_on_huge_pages(out.vertices, order.size(), workers);
    out.vertices.resize(order.size());
    reserve_on_huge_pages(out.vertex_carriers, order.size(), workers);
    out.vertex_carriers.resize(order.size());
    if (!plc.vertex_markers.empty()) out.vertex_markers.assign(order.size(), 0);
    workers.for_ranges(order.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            const VertexId v = order[i];
            number[v.index()] = static_cast<std::uint32_t>(i);
            out.vertices[i] = mesh.point(v);
            const VertexInfo& info = mesh.info(v);
            std::uint32_t id = info.carrier_id;
            if (info.carrier == CarrierKind::input_vertex) {
                if (!plc.vertex_markers.empty()) out.vertex_markers[i] = plc.vertex_markers[id];
                id = plc.source_vertex[id];
            }
            if (info.carrier == CarrierKind::region) id = static_cast<std::uint32_t>(plc.cells[id].region);
            out.vertex_carriers[i] = {info.carrier, id};
        }
    });
    // Counting sort; counted one place ahead, so that first[v] is where the tetrahedra of v begin.
    const auto lowest = [&](TetId t) {
        const auto& c = tets.corners(t);
        return std::min({number[c[0].index()], number[c[1].index()], number[c[2].index()], number[c[3].index()]});
    };
    const auto add_one = [alone](std::uint32_t& counter) { return alone ? counter++ : std::atomic_ref(counter).fetch_add(1, std::memory_order_relaxed); };
    std::vector<std::uint32_t> first(order.size() + 1, 0);
    for_output([&](TetId t) { add_one(first[lowest(t) + 1]); });
    for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
    SharedArray<TetId> listed;
    listed.resize_as_is(first.back());
    for_output([&](TetId t) { listed[add_one(first[lowest(t)])] = t; });
    // Each start has moved on to the next one's. Several threads dealt those of a vertex out as it happened.
    if (!alone)
        workers.for_ranges(order.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t v = begin; v < end; ++v)
                std::sort(listed.data() + (v == 0 ? 0 : first[v - 1]), listed.data() + first[v]);
        });
    return listed;
}

}  // namespace

TetMesh extract_mesh(ConformingMesh&& mesh, Workers& workers, const std::function<void(std::span<const TetId> order)>& look) {
    TetMesh out;
    const TetStore& tets = mesh.tets();
    const ValidPlc& plc = mesh.plc();
    std::vector<std::uint32_t> number(mesh.vertex_slots(), kUnused);
    const auto in_output = [&](TetId t) { return tets.is_finite(t) && mesh.in_domain(t); };
    const SharedArray<TetId> order = number_output(mesh, workers, in_output, number, out);
    return_freed_memory();
    look({order.data(), order.size()});
    mesh.triangulation().release_all_but_tets();
    const std::size_t count = order.size();
    reserve_on_huge_pages(out.tet_regions, count, workers);
    out.tet_regions.resize(count);
    struct Listed {
        std::vector<ListedFace> faces;
        std::vector<ListedEdge> edges;
    };
    std::vector<Listed> listed((count + kGrain - 1) / kGrain);
    workers.for_ranges(count, kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        for (std::size_t i = begin; i < end; ++i) {
            const TetId t = order[i];
            out.tet_regions[i] = plc.cells[mesh.cell(t).index()].region;
            if (mesh.has_labels(t)) list_constraints(mesh, t, number, listed[piece].faces, listed[piece].edges);
        }
    });
    mesh.release_all_but_tets();
    std::vector<ListedFace> faces;
    std::vector<ListedEdge> edges;
    for (const Listed& l : listed) {
        faces.insert(faces.end(), l.faces.begin(), l.faces.end());
        edges.insert(edges.end(), l.edges.begin(), l.edges.end());
    }
    listed.clear();
    sort_on(workers, std::span(edges), std::less<>());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    out.subfaces.reserve(faces.size());
    out.subface_facets.reserve(faces.size());
    out.subface_markers.reserve(faces.size());
    for (const ListedFace& f : faces) {
        out.subfaces.push_back(f.corners);
        out.subface_facets.push_back(static_cast<std::int32_t>(plc.facets[f.facet.index()].source_facet) + 1);
        out.subface_markers.push_back(plc.facets[f.facet.index()].marker);
    }
    for (const ListedEdge& e : edges) {
        out.subsegments.push_back(e.ends);
        out.subsegment_segments.push_back(static_cast<std::int32_t>(e.segment.value()) + 1);
        out.subsegment_markers.push_back(plc.segments[e.segment.index()].marker);
    }
    reserve_on_huge_pages(out.tets, count, workers);
    out.tets.resize(count);
    constexpr std::size_t kAhead = 16;
    workers.for_ranges(count, kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            if (i + kAhead < count) tets.prefetch(order[i + kAhead]);
            const auto& c = tets.corners(order[i]);
            out.tets[i] = {number[c[0].index()], number[c[1].index()], number[c[2].index()], number[c[3].index()]};
        }
    });
    return out;
}

double largest_bend_rad(const TetMesh& mesh) {
    struct Side {
        std::uint64_t edge = 0;
        std::uint32_t apex = 0;
        std::int32_t facet = 0;
    };
    std::vector<Side> sides;
    sides.reserve(3 * mesh.subfaces.size());
    for (std::size_t f = 0; f < mesh.subfaces.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = mesh.subfaces[f][(k + 1) % 3], b = mesh.subfaces[f][(k + 2) % 3];
            const std::array<std::uint32_t, 2> edge{std::min(a, b), std::max(a, b)};
            if (!std::binary_search(mesh.subsegments.begin(), mesh.subsegments.end(), edge))
                sides.push_back({edge_key(VertexId{edge[0]}, VertexId{edge[1]}), mesh.subfaces[f][k], mesh.subface_facets[f]});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return std::tie(a.edge, a.apex) < std::tie(b.edge, b.apex); });
    double largest = 0;
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
        if (sides[i].edge != sides[i + 1].edge || sides[i].facet != sides[i + 1].facet) continue;
        const auto [first, second] = edge_ends(sides[i].edge);
        const Vec3 &a = mesh.vertices[first.index()], &b = mesh.vertices[second.index()];
        const Vec3 m = cross(b - a, mesh.vertices[sides[i].apex] - a), n = cross(mesh.vertices[sides[i + 1].apex] - a, b - a);
        largest = std::max(largest, std::atan2(norm(cross(m, n)), dot(m, n)));
    }
    return largest;
}

}  // namespace wellmesh
