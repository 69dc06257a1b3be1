// SPDX-License-Identifier: Apache-2.0
// Points by place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/workers.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh::certifying {

/// Which points are where, by hashing; 0 and -0 are one place. O(n) time; 12 bytes a point.
class VertexPlaces {
public:
    /// @param points  finite; must outlive this.
    VertexPlaces(const std::vector<Vec3>& points, Workers& workers);

    /// The lowest number of a point there; kNone: there is none.
    [[nodiscard]] std::uint32_t first_at(const Vec3& p) const;

    [[nodiscard]] std::size_t buckets() const { return first_.size() - 2; }
    /// Calls visit(point, first) for the points of the buckets from `begin` to before `end` that are where a lower one is; `first` is the lowest.
    template <class Visit>
    void for_repetitions(std::size_t begin, std::size_t end, Visit&& visit) const {
        for (std::size_t b = begin; b < end; ++b)
            for (std::size_t i = first_[b] + std::size_t{1}; i < first_[b + 1]; ++i)
                for (std::size_t j = first_[b]; j < i; ++j) {
                    if (order_[i].tag != order_[j].tag || points_[order_[i].point] != points_[order_[j].point]) continue;
                    visit(order_[i].point, order_[j].point);
                    break;
                }
    }

private:
    struct Entry {
        std::uint32_t point, tag;  ///< the tags of points at one place are equal, of others hardly ever
    };
    [[nodiscard]] static std::uint64_t hash_of(const Vec3& p);

    const std::vector<Vec3>& points_;
    int shift_ = 0;
    std::vector<std::uint32_t> first_;  // of each bucket, a power of two of them
    std::vector<Entry> order_;          // ascending in each
};

}  // namespace wellmesh::certifying
