// SPDX-License-Identifier: Apache-2.0
#include "certify/tets_by_corner.hpp"

#include <algorithm>
#include <atomic>

namespace wellmesh::certifying {
namespace {

/// Calls visit(slot, tet) for every entry of tetrahedra: slot 3 v + i says that v is the lowest, second or third corner (i = 0, 1, 2). They may repeat
/// a corner.
template <class Visit>
void for_entries(const SuspectMesh& mesh, Visit&& visit) {
    mesh.workers().for_ranges(mesh.tet_count(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t t = begin; t < end; ++t) {
            const auto v = AscendingTet(mesh.mesh().tets[t]).v;
            for (std::size_t i = 0; i < 3; ++i)
                if (i == 0 || v[i] != v[i - 1]) visit(3 * std::size_t{v[i]} + i, static_cast<std::uint32_t>(t));
        }
    });
}

}  // namespace

TetsByCorner::TetsByCorner(const SuspectMesh& mesh) : first_(3 * mesh.vertex_count() + 2, 0) {
    const bool alone = mesh.workers().threads() == 1;
    const auto next = [&](std::uint64_t& counter) { return alone ? counter++ : std::atomic_ref(counter).fetch_add(1, std::memory_order_relaxed); };
    // Counted two places ahead so that, after filling, first_[i] .. first_[i + 1] is what slot i has.
    for_entries(mesh, [&](std::size_t slot, std::uint32_t) { next(first_[slot + 2]); });
    for (std::size_t i = 2; i < first_.size(); ++i) first_[i] += first_[i - 1];
    tets_.resize(first_.back());
    for_entries(mesh, [&](std::size_t slot, std::uint32_t t) { tets_[next(first_[slot + 1])] = t; });
    if (alone) return;
    mesh.workers().for_ranges(first_.size() - 2, 3 * kVertexGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto at = [&](std::size_t k) { return tets_.begin() + static_cast<std::ptrdiff_t>(first_[k]); };
            if (!std::is_sorted(at(i), at(i + 1))) std::sort(at(i), at(i + 1));
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
