// SPDX-License-Identifier: Apache-2.0
#include "repair/vertex_pool.hpp"

#include <cmath>
#include <limits>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

}  // namespace

std::size_t VertexPool::CellHash::operator()(const Cell& c) const noexcept {
    return mix64(mix64(static_cast<std::uint64_t>(c.x), static_cast<std::uint64_t>(c.y)), static_cast<std::uint64_t>(c.z));
}

std::int64_t VertexPool::cell_of(double coordinate) const { return static_cast<std::int64_t>(std::floor(coordinate / cell_)); }

std::uint32_t VertexPool::find_or_add(const Vec3& p) {
    std::uint32_t nearest = kNone;
    double least = reach_;
    // a ball of radius reach meets at most two cells along each axis
    for (std::int64_t x = cell_of(p.x - reach_); x <= cell_of(p.x + reach_); ++x)
        for (std::int64_t y = cell_of(p.y - reach_); y <= cell_of(p.y + reach_); ++y)
            for (std::int64_t z = cell_of(p.z - reach_); z <= cell_of(p.z + reach_); ++z) {
                const auto found = newest_.find({x, y, z});
                if (found == newest_.end()) continue;
                for (std::uint32_t v = found->second; v != kNone; v = next_[v]) {
                    const double d = distance(points_[v], p);
                    if (d < least || (d == least && v < nearest)) {
                        least = d;
                        nearest = v;
                    }
                }
            }
    if (nearest != kNone) return nearest;
    const auto [here, fresh] = newest_.try_emplace({cell_of(p.x), cell_of(p.y), cell_of(p.z)}, size());
    next_.push_back(fresh ? kNone : here->second);
    here->second = size();
    points_.push_back(p);
    return size() - 1;
}

}  // namespace wellmesh
