// SPDX-License-Identifier: Apache-2.0
#include "certify/edge_lengths.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <span>

#include "core/vec3_math.hpp"

namespace wellmesh::certifying {
namespace {

struct EdgeLengths {
    double lowest = 0, highest = 0;
    long double sum = 0;
    std::uint64_t count = 0;

    void add(double length) {
        lowest = count == 0 ? length : std::min(lowest, length);
        highest = std::max(highest, length);
        sum += static_cast<long double>(length);
        ++count;
    }
    void add(const EdgeLengths& o) {
        if (o.count == 0) return;
        lowest = count == 0 ? o.lowest : std::min(lowest, o.lowest);
        highest = std::max(highest, o.highest);
        sum += o.sum;
        count += o.count;
    }
    void store(ShapeStatistics& s) const {
        s.min_edge = lowest;
        s.max_edge = highest;
        s.mean_edge = count == 0 ? 0 : static_cast<double>(sum / static_cast<long double>(count));
    }
};

/// Of one range of vertices: the edges of which they are the lower ends.
struct Lengths {
    EdgeLengths all, interior, boundary;
};

/// The edges from one vertex to higher ones, each once.
class UpperEdges {
public:
    struct End {
        std::uint32_t vertex;
        bool interior, boundary;  ///< an end of an edge of such a tetrahedron
    };

    const std::vector<End>& of(const SuspectMesh& mesh, std::uint32_t vertex, std::span<const std::uint32_t> tets, const std::vector<TetClass>& classes) {
        ends_.clear();
        const std::size_t slots = std::bit_ceil(std::max<std::size_t>(16, 4 * tets.size()));
        table_.assign(slots, kNone);
        const int shift = 64 - std::countr_zero(slots);
        for (const std::uint32_t t : tets) {
            if (classes[t] == TetClass::left_out) continue;
            for (const std::uint32_t w : mesh.mesh().tets[t]) {
                if (w <= vertex) continue;
                auto i = static_cast<std::size_t>((w * 0x9E3779B97F4A7C15U) >> shift);
                while (table_[i] != kNone && ends_[table_[i]].vertex != w) i = (i + 1) & (slots - 1);
                if (table_[i] == kNone) {
                    table_[i] = static_cast<std::uint32_t>(ends_.size());
                    ends_.push_back({w, false, false});
                }
                End& end = ends_[table_[i]];
                (classes[t] == TetClass::interior ? end.interior : end.boundary) = true;
            }
        }
        return ends_;
    }

private:
    std::vector<End> ends_;             // in order of appearance
    std::vector<std::uint32_t> table_;  // by open addressing, numbers in ends_
};

}  // namespace

void measure_edges(const SuspectMesh& mesh, const TetsByCorner& stars, const std::vector<TetClass>& classes, ShapeStatistics& all, ShapeStatistics& interior,
                   ShapeStatistics& boundary) {
    std::vector<Lengths> parts((mesh.vertex_count() + kVertexGrain - 1) / kVertexGrain);
    mesh.workers().for_ranges(mesh.vertex_count(), kVertexGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        UpperEdges edges;
        Lengths lengths;
        for (std::size_t i = begin; i < end; ++i) {
            const auto v = static_cast<std::uint32_t>(i);
            for (const UpperEdges::End& e : edges.of(mesh, v, stars.of(v), classes)) {
                const double length = distance(mesh.mesh().vertices[v], mesh.mesh().vertices[e.vertex]);
                lengths.all.add(length);
                if (e.interior) lengths.interior.add(length);
                if (e.boundary) lengths.boundary.add(length);
            }
        }
        parts[piece] = lengths;
    });
    Lengths sum;
    for (const Lengths& part : parts) sum.all.add(part.all), sum.interior.add(part.interior), sum.boundary.add(part.boundary);
    sum.all.store(all);
    sum.interior.store(interior);
    sum.boundary.store(boundary);
}

}  // namespace wellmesh::certifying
