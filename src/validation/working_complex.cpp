// SPDX-License-Identifier: Apache-2.0
#include "validation/working_complex.hpp"

#include <algorithm>

namespace wellmesh {

std::size_t EdgeTable::find(EdgeKey key) const {
    const auto it = std::lower_bound(keys.begin(), keys.end(), key);
    return it != keys.end() && *it == key ? static_cast<std::size_t>(it - keys.begin()) : kNotFound();
}

EdgeTable make_edge_table(std::span<const SoupTriangle> triangles) {
    std::vector<std::pair<EdgeKey, std::uint32_t>> all;
    all.reserve(3 * triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t s = 0; s < 3; ++s)
            all.emplace_back(edge_key(triangles[t].v[s], triangles[t].v[(s + 1) % 3]), static_cast<std::uint32_t>(3 * t + s));
    std::sort(all.begin(), all.end());
    EdgeTable table;
    table.corners.reserve(all.size());
    table.edge_of.resize(all.size());
    for (const auto& [key, corner] : all) {
        if (table.keys.empty() || table.keys.back() != key) {
            table.keys.push_back(key);
            table.first.push_back(static_cast<std::uint32_t>(table.corners.size()));
        }
        table.edge_of[corner] = static_cast<std::uint32_t>(table.keys.size() - 1);
        table.corners.push_back(corner);
    }
    table.first.push_back(static_cast<std::uint32_t>(table.corners.size()));
    return table;
}

}  // namespace wellmesh
