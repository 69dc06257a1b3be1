// SPDX-License-Identifier: Apache-2.0
#include "certify/box_cover.hpp"

#include <algorithm>
#include <cmath>

#include "core/vec3_math.hpp"

namespace wellmesh::certifying {

BoxCover::BoxCover(const std::vector<Box3>& boxes) {
    if (boxes.empty()) return;
    Box3 all = boxes.front();
    for (const Box3& b : boxes) all.grow(b);
    low_ = all.low;
    const Vec3 extent = all.high - all.low;
    const std::array<double, 3> lengths{extent.x, extent.y, extent.z};
    // The boxes are those of a surface: n of them are about sqrt(n / 6) cells across. 64 keeps the table near a megabyte.
    const double across = std::clamp(std::sqrt(static_cast<double>(boxes.size())) / 2, 1.0, 64.0);
    const double per_unit = across / *std::max_element(lengths.begin(), lengths.end());
    for (std::size_t axis = 0; axis < 3 && std::isfinite(per_unit); ++axis) {
        size_[axis] = static_cast<std::size_t>(std::clamp(lengths[axis] * per_unit, 1.0, 64.0));
        cells_per_unit_[axis] = per_unit;
    }
    // The number of boxes over each cell, from its differences at the boxes' corners; then the number of cells with any.
    sums_.assign((size_[0] + 1) * (size_[1] + 1) * (size_[2] + 1), 0);
    for (const Box3& b : boxes) {
        const auto [i0, j0, k0] = cell_of(b.low);
        const auto [i1, j1, k1] = cell_of(b.high);
        for (const std::size_t i : {i0, i1 + 1})
            for (const std::size_t j : {j0, j1 + 1})
                for (const std::size_t k : {k0, k1 + 1}) {
                    const bool odd = (i != i0) != ((j != j0) != (k != k0));
                    sums_[place(i, j, k)] += odd ? ~std::uint32_t{0} : 1;  // minus or plus one, modulo 2^32
                }
    }
    accumulate();
    for (std::size_t i = size_[0] + 1; i-- > 0;)
        for (std::size_t j = size_[1] + 1; j-- > 0;)
            for (std::size_t k = size_[2] + 1; k-- > 0;) sums_[place(i, j, k)] = i > 0 && j > 0 && k > 0 && at(i - 1, j - 1, k - 1) != 0;
    accumulate();
}

void BoxCover::accumulate() {
    for (std::size_t i = 0; i <= size_[0]; ++i)
        for (std::size_t j = 0; j <= size_[1]; ++j)
            for (std::size_t k = 0; k <= size_[2]; ++k) {
                std::uint32_t& sum = sums_[place(i, j, k)];  // of all before, inclusive: the three planes before, inclusion and exclusion
                if (i > 0) sum += at(i - 1, j, k);
                if (j > 0) sum += at(i, j - 1, k);
                if (k > 0) sum += at(i, j, k - 1);
                if (i > 0 && j > 0) sum -= at(i - 1, j - 1, k);
                if (i > 0 && k > 0) sum -= at(i - 1, j, k - 1);
                if (j > 0 && k > 0) sum -= at(i, j - 1, k - 1);
                if (i > 0 && j > 0 && k > 0) sum += at(i - 1, j - 1, k - 1);
            }
}

}  // namespace wellmesh::certifying
