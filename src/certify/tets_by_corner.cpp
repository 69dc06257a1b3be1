// SPDX-License-Identifier: Apache-2.0
#include "certify/tets_by_corner.hpp"

#include <algorithm>
#include <atomic>
#include <utility>

namespace wellmesh::certifying {
namespace {

/// Calls visit(vertex, tet) for every entry of tetrahedra of which the vertex is the lowest, second or third corner (0, 1, 2). They may repeat a corner.
template <class Visit>
void for_entries(const SuspectMesh& mesh, std::size_t first, std::size_t last, Visit&& visit) {
    mesh.workers().for_ranges(mesh.tet_count(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t t = begin; t < end; ++t) {
            const auto v = AscendingTet(mesh.mesh().tets[t]).v;
            for (std::size_t i = first; i <= last; ++i)
                if (i == 0 || v[i] != v[i - 1]) visit(v[i], static_cast<std::uint32_t>(t));
        }
    });
}

}  // namespace

TetsByCorner::TetsByCorner(const SuspectMesh& mesh) : first_(mesh.vertex_count() + 2, 0) {
    const bool alone = mesh.workers().threads() == 1;
    const auto next = [&](std::uint64_t& counter) { return alone ? counter++ : std::atomic_ref(counter).fetch_add(1, std::memory_order_relaxed); };
    // Counted two places ahead so that, after filling, first_[v] .. first_[v + 1] is what v has.
    for_entries(mesh, 0, 2, [&](std::uint32_t v, std::uint32_t) { next(first_[std::size_t{v} + 2]); });
    for (std::size_t v = 2; v < first_.size(); ++v) first_[v] += first_[v - 1];
    tets_.resize(first_.back());
    for (std::size_t rank = 0; rank < 3; ++rank)
        for_entries(mesh, rank, rank, [&](std::uint32_t v, std::uint32_t t) { tets_[next(first_[std::size_t{v} + 1])] = t; });
    if (alone) return;
    mesh.workers().for_ranges(mesh.vertex_count(), kVertexGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t v = begin; v < end; ++v) {
            const auto at = [&](std::size_t i) { return tets_.begin() + static_cast<std::ptrdiff_t>(first_[i]); };
            const auto key = [&](std::uint32_t t) {
                const auto corners = AscendingTet(mesh.mesh().tets[t]).v;
                return std::pair(corners[0] == v ? 0 : corners[1] == v ? 1 : 2, t);
            };
            const auto before = [&](std::uint32_t t, std::uint32_t u) { return key(t) < key(u); };
            if (!std::is_sorted(at(v), at(v + 1), before)) std::sort(at(v), at(v + 1), before);
        }
    });
}

bool has_edge(const SuspectMesh& mesh, const TetsByCorner& stars, const Edge& edge) {
    const auto tets = stars.of(edge[0]);
    return std::any_of(tets.begin(), tets.end(), [&](std::uint32_t t) {
        const auto& v = mesh.mesh().tets[t];
        return std::count(v.begin(), v.end(), edge[1]) > (edge[0] == edge[1] ? 1 : 0);
    });
}

}  // namespace wellmesh::certifying
