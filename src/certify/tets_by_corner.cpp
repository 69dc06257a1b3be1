// SPDX-License-Identifier: Apache-2.0
#include "certify/tets_by_corner.hpp"

#include <algorithm>

namespace wellmesh::certifying {
namespace {

/// Calls visit(slot, tet) for every entry of the tetrahedra: slot 3 v + i says that v is the lowest, second or third corner (i = 0, 1, 2). They may
/// repeat a corner.
template <class Visit>
void for_entries(const SuspectMesh& mesh, std::size_t begin, std::size_t end, Visit&& visit) {
    for (std::size_t t = begin; t < end; ++t) {
        const auto v = AscendingTet(mesh.mesh().tets[t]).v;
        for (std::size_t i = 0; i < 3; ++i)
            if (i == 0 || v[i] != v[i - 1]) visit(3 * std::size_t{v[i]} + i, static_cast<std::uint32_t>(t));
    }
}

}  // namespace

TetsByCorner::TetsByCorner(const SuspectMesh& mesh) : first_(3 * mesh.vertex_count() + 2, 0) {
    Workers& workers = mesh.workers();
    if (workers.threads() == 1) {
        // Counted two places ahead so that, after filling, first_[i] .. first_[i + 1] is what slot i has.
        for_entries(mesh, 0, mesh.tet_count(), [&](std::size_t slot, std::uint32_t) { ++first_[slot + 2]; });
        for (std::size_t i = 2; i < first_.size(); ++i) first_[i] += first_[i - 1];
        tets_.resize(first_.back());
        for_entries(mesh, 0, mesh.tet_count(), [&](std::size_t slot, std::uint32_t t) { tets_[first_[slot + 1]++] = t; });
        return;
    }
    // Each thread counts what its share of the tetrahedra has for every slot, and then knows where to put it: behind that of the shares before.
    constexpr std::size_t kMostShares = 8;
    const std::size_t shares = std::min<std::size_t>(workers.threads(), kMostShares), grain = (mesh.tet_count() + shares - 1) / shares;
    const std::size_t slots = first_.size() - 2;
    std::vector<std::vector<std::uint32_t>> next(shares);
    workers.for_ranges(mesh.tet_count(), grain, [&](std::size_t begin, std::size_t end, std::size_t share) {
        next[share].assign(slots, 0);
        for_entries(mesh, begin, end, [&](std::size_t slot, std::uint32_t) { ++next[share][slot]; });
    });
    workers.for_ranges(slots, 3 * kVertexGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::vector<std::uint32_t>& of_share : next)
            for (std::size_t i = begin; i < end && !of_share.empty(); ++i) {
                const std::uint32_t count = of_share[i];
                of_share[i] = static_cast<std::uint32_t>(first_[i + 1]);
                first_[i + 1] += count;
            }
    });
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    tets_.resize(first_.back());
    workers.for_ranges(mesh.tet_count(), grain, [&](std::size_t begin, std::size_t end, std::size_t share) {
        for_entries(mesh, begin, end, [&](std::size_t slot, std::uint32_t t) { tets_[first_[slot] + next[share][slot]++] = t; });
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
