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
    std::vector<std::uint32_t> bucket(points.size());
    workers.for_ranges(points.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) bucket[i] = static_cast<std::uint32_t>(bucket_of(points[i]));
    });
    first_.assign(buckets + 2, 0);
    // Counted two places ahead so that, after filling, first_[b] .. first_[b + 1] is bucket b.
    for (const std::uint32_t b : bucket) ++first_[std::size_t{b} + 2];
    for (std::size_t b = 2; b < first_.size(); ++b) first_[b] += first_[b - 1];
    for (std::size_t i = 0; i < bucket.size(); ++i) order_[first_[std::size_t{bucket[i]} + 1]++] = static_cast<std::uint32_t>(i);
}

std::size_t VertexPlaces::bucket_of(const Vec3& p) const {
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x + 0.0); };  // -0 + 0 is 0
    return static_cast<std::size_t>(mix64(mix64(bits(p.x), bits(p.y)), bits(p.z)) >> shift_);
}

std::uint32_t VertexPlaces::first_at(const Vec3& p) const {
    const std::size_t b = bucket_of(p);
    for (std::size_t i = first_[b]; i < first_[b + 1]; ++i)
        if (points_[order_[i]] == p) return order_[i];
    return kNone;
}

}  // namespace wellmesh::certifying
