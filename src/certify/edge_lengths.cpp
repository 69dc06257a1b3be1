// SPDX-License-Identifier: Apache-2.0
#include "certify/edge_lengths.hpp"

#include <cstddef>

namespace wellmesh::certifying {

void EdgeLengths::Lengths::add(const Lengths& o) {
    if (o.count == 0) return;
    lowest = count == 0 ? o.lowest : std::min(lowest, o.lowest);
    highest = std::max(highest, o.highest);
    sum += o.sum;
    count += o.count;
}

void EdgeLengths::Lengths::store(ShapeStatistics& s) const {
    s.min_edge = lowest;
    s.max_edge = highest;
    s.mean_edge = count == 0 ? 0 : static_cast<double>(sum / static_cast<long double>(count));
}

void EdgeLengths::add(const EdgeLengths& later) {
    all_.add(later.all_);
    interior_.add(later.interior_);
    boundary_.add(later.boundary_);
}

void EdgeLengths::store(ShapeStatistics& all, ShapeStatistics& interior, ShapeStatistics& boundary) const {
    all_.store(all);
    interior_.store(interior);
    boundary_.store(boundary);
}

EdgeLengths measure_edges(const SuspectMesh& mesh, const TetsByCorner& stars, const std::vector<TetClass>& classes) {
    std::vector<EdgeLengths> parts((mesh.vertex_count() + kVertexGrain - 1) / kVertexGrain);
    ScratchPool<UpperEdges> pool;
    mesh.workers().for_ranges(mesh.vertex_count(), kVertexGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        std::unique_ptr<UpperEdges> edges = pool.take([&] { return std::make_unique<UpperEdges>(mesh.vertex_count()); });
        for (std::size_t i = begin; i < end; ++i) {
            const auto vertex = static_cast<std::uint32_t>(i);
            const auto tets = stars.of(vertex);
            edges->start(vertex, tets.size());
            for (const std::uint32_t t : tets) {
                if (classes[t] == TetClass::left_out) continue;
                const auto v = AscendingTet(mesh.mesh().tets[t]).v;
                for (std::size_t k = v[0] == vertex ? 1 : v[1] == vertex ? 2 : 3; k < 4; ++k) edges->visit(v[k], classes[t] == TetClass::interior);
            }
            parts[piece].add(mesh, vertex, edges->ends());
        }
        pool.give_back(std::move(edges));
    });
    EdgeLengths sum;
    for (const EdgeLengths& part : parts) sum.add(part);
    return sum;
}

}  // namespace wellmesh::certifying
