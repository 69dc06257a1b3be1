// SPDX-License-Identifier: Apache-2.0
#include "certify/vertex_places.hpp"

#include <algorithm>
#include <bit>

#include "certify/suspect_mesh.hpp"
#include "core/rng.hpp"

namespace wellmesh::certifying {

VertexPlaces::VertexPlaces(const std::vector<Vec3>& points, Workers& workers) : points_(points), order_(points.size()) {
    const std::size_t buckets = std::bit_ceil(std::max<std::size_t>(2, points.size()));
    shift_ = 64 - std::countr_zero(buckets);
    std::vector<std::uint64_t> hashes(points.size());
    workers.for_ranges(points.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) hashes[i] = hash_of(points[i]);
    });
    first_.assign(buckets + 2, 0);
    // Counted two places ahead so that, after filling, first_[b] .. first_[b + 1] is bucket b.
    for (const std::uint64_t h : hashes) ++first_[(h >> shift_) + 2];
    for (std::size_t b = 2; b < first_.size(); ++b) first_[b] += first_[b - 1];
    for (std::size_t i = 0; i < hashes.size(); ++i) order_[first_[(hashes[i] >> shift_) + 1]++] = {static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(hashes[i])};
}

std::uint64_t VertexPlaces::hash_of(const Vec3& p) {
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x + 0.0); };  // -0 + 0 is 0
    return mix64(mix64(bits(p.x), bits(p.y)), bits(p.z));
}

std::uint32_t VertexPlaces::first_at(const Vec3& p) const {
    const std::size_t b = hash_of(p) >> shift_;
    for (std::size_t i = first_[b]; i < first_[b + 1]; ++i)
        if (points_[order_[i].point] == p) return order_[i].point;
    return kNone;
}

}  // namespace wellmesh::certifying
