// SPDX-License-Identifier: Apache-2.0
// The point in front of a face whose sphere with it is empty of all others: gift wrapping's question, put to many points at once.
//
// Relative to the face's first corner let u and v be the others, n = u x v and m = |u|^2 v - |v|^2 u. A point d is in front if n.d > 0.
// For e in front the insphere determinant of the tetrahedron at d is k.d - (n.e) |d|^2 with k = |e|^2 n + m x e: once e is chosen, a
// test costs little more than one of orientation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "wellmesh/vec3.hpp"

namespace wellmesh {

/// Numbered points, each coordinate in a column of its own, padded to whole lanes. What is not set compares as false with everything.
class PointColumns {
public:
    static constexpr std::size_t kLanes = 4;
    void reset(std::size_t points) {
        rows_ = (points + kLanes - 1) / kLanes * kLanes;
        values_.assign(3 * rows_, std::numeric_limits<double>::quiet_NaN());
    }
    void set(std::size_t i, const Vec3& p) {
        values_[i] = p.x;
        values_[rows_ + i] = p.y;
        values_[2 * rows_ + i] = p.z;
    }
    [[nodiscard]] Vec3 operator[](std::size_t i) const { return {x()[i], y()[i], z()[i]}; }
    [[nodiscard]] std::size_t rows() const { return rows_; }
    [[nodiscard]] const double* x() const { return values_.data(); }
    [[nodiscard]] const double* y() const { return values_.data() + rows_; }
    [[nodiscard]] const double* z() const { return values_.data() + 2 * rows_; }

private:
    std::size_t rows_ = 0;
    std::vector<double> values_;
};

/// One face's search, and the static filter's bounds.
struct ApexSearch {
    const PointColumns& points;
    std::array<std::uint32_t, 3> face{};
    double orient3d_bound = 0, insphere_bound = 0;
    static constexpr std::uint32_t kNobody = 0xffffffffU;

    /// @param rivals  gets all points but the face's corners that are neither certainly behind the face nor certainly outside the
    ///                nominee's sphere
    /// @return a point that is certainly in front of the face, the one that is wanted as far as rounding lets see; or kNobody
    [[nodiscard]] std::uint32_t nominate(std::vector<std::uint32_t>& rivals) const;
    /// The same in lanes. @pre has_insphere_lanes()
    [[nodiscard]] std::uint32_t nominate_in_lanes(std::vector<std::uint32_t>& rivals) const;
};

}  // namespace wellmesh
