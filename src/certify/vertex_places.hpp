// SPDX-License-Identifier: Apache-2.0
// Points by place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/workers.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh::certifying {

/// Which points are where, by hashing; 0 and -0 are one place. O(n) time; 8 bytes a point.
class VertexPlaces {
public:
    /// @param points  finite; must outlive this.
    VertexPlaces(const std::vector<Vec3>& points, Workers& workers);

    /// The lowest number of a point there; kNone: there is none.
    [[nodiscard]] std::uint32_t first_at(const Vec3& p) const;

private:
    [[nodiscard]] std::size_t bucket_of(const Vec3& p) const;

    const std::vector<Vec3>& points_;
    int shift_ = 0;
    std::vector<std::uint32_t> first_, order_;  // of each bucket, a power of two of them; ascending in each
};

}  // namespace wellmesh::certifying
