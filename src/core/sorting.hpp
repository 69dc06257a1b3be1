// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "core/workers.hpp"

namespace wellmesh {

/// Sorts on all workers: pieces by themselves, which are merged two by two.
/// @pre elements neither of which is less are alike to the caller: their order depends on the number of threads
template <class T, class Less>
void sort_on(Workers& workers, std::span<T> range, const Less& less) {
    constexpr std::size_t kFew = std::size_t{1} << 13;  // take less time than to wake a thread
    if (workers.threads() == 1 || range.size() < kFew) {
        std::sort(range.begin(), range.end(), less);
        return;
    }
    const auto at = [&](std::size_t i) { return range.data() + i; };
    std::size_t run = (range.size() + workers.threads() - 1) / workers.threads();
    workers.for_ranges(range.size(), run, [&](std::size_t begin, std::size_t end, std::size_t) { std::sort(at(begin), at(end), less); });
    for (; run < range.size(); run *= 2)
        workers.for_ranges(range.size(), 2 * run, [&](std::size_t begin, std::size_t end, std::size_t) {
            std::inplace_merge(at(begin), at(std::min(begin + run, end)), at(end), less);
        });
}

}  // namespace wellmesh
