// SPDX-License-Identifier: Apache-2.0
// Lists of different lengths one behind the other in one array, as rows of a sparse matrix are stored.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace wellmesh {

template <class Item>
class CompressedRows {
public:
    CompressedRows() = default;
    /// @param rows     how many
    /// @param entries  pairs of a row, below `rows`, and an item, in any order; each row keeps theirs. Fewer than 2^32.
    template <class Entries>
    CompressedRows(std::size_t rows, const Entries& entries) : first_(rows + 1, 0), items_(entries.size()) {
        for (const auto& [row, item] : entries) ++first_[row + 1];
        for (std::size_t i = 0; i < rows; ++i) first_[i + 1] += first_[i];
        std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
        for (const auto& [row, item] : entries) items_[next[row]++] = item;
    }

    [[nodiscard]] std::span<const Item> operator[](std::size_t row) const { return {items_.data() + first_[row], items_.data() + first_[row + 1]}; }

private:
    std::vector<std::uint32_t> first_;  // a row's items begin there and end where the next one's begin
    std::vector<Item> items_;
};

}  // namespace wellmesh
