// SPDX-License-Identifier: Apache-2.0
#include "certify/delaunay_cells.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "certify/space_claims.hpp"
#include "core/rng.hpp"

namespace wellmesh::certifying {

bool disjoint_as_delaunay(const SuspectMesh& mesh, const BallSearch& search) {
    // Of tetrahedra with more than their corners on their spheres: a key of all those vertices. Equal keys of different sets cost time only.
    std::vector<std::pair<std::uint64_t, std::uint32_t>> shared;
    std::vector<std::uint32_t> on_sphere;
    for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
        if (!mesh.positive(t)) return false;
        const auto& v = mesh.mesh().tets[t];
        const Ball ball = search.circumball(mesh.weighted(v[0]), mesh.weighted(v[1]), mesh.weighted(v[2]), mesh.weighted(v[3]));
        on_sphere.assign(v.begin(), v.end());
        const bool intruded = search.any_in(ball, [&](std::uint32_t q) {
            if (std::find(v.begin(), v.end(), q) != v.end()) return false;
            const Sign side = mesh.in_sphere(t, q);
            if (side == Sign::zero) on_sphere.push_back(q);
            return side == Sign::positive;
        });
        if (intruded) return false;
        if (on_sphere.size() == v.size()) continue;
        std::sort(on_sphere.begin(), on_sphere.end());
        std::uint64_t key = on_sphere.size();
        for (const std::uint32_t q : on_sphere) key = mix64(key, q);
        shared.emplace_back(key, static_cast<std::uint32_t>(t));
    }
    std::sort(shared.begin(), shared.end());
    for (auto first = shared.begin(); first != shared.end();) {
        const auto last = std::find_if(first, shared.end(), [&](const auto& s) { return s.first != first->first; });
        for (auto a = first; a != last; ++a)
            for (auto b = a + 1; b != last; ++b)
                if (overlap(mesh, a->second, b->second)) return false;
        first = last;
    }
    return true;
}

}  // namespace wellmesh::certifying
