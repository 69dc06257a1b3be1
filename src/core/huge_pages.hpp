// SPDX-License-Identifier: Apache-2.0
// Large arrays on large pages. Visits at random miss the translation buffer with 4 kB pages, and the system clears a page of 2 MB faster than 512 small ones.
#pragma once

#include <cstddef>
#include <vector>

#include "core/page_memory.hpp"
#include "core/workers.hpp"

namespace wellmesh {

/// Room for n elements.
template <class T>
void reserve_on_huge_pages(std::vector<T>& list, std::size_t n) {
    if (n <= list.capacity()) return;
    list.reserve(n);
    advise_huge_pages(list.data() + list.size(), (n - list.size()) * sizeof(T));
}

/// The same; the system clears the room's pages on all workers, not on the one that writes to them first.
template <class T>
void reserve_on_huge_pages(std::vector<T>& list, std::size_t n, Workers& workers) {
    reserve_on_huge_pages(list, n);
    if (workers.threads() == 1 || n <= list.size()) return;
    constexpr std::size_t kPage = 4096, kPiece = std::size_t{1} << 23;
    auto* const room = reinterpret_cast<unsigned char*>(list.data() + list.size());
    const std::size_t bytes = (n - list.size()) * sizeof(T);
    workers.for_ranges(bytes, kPiece, [room, bytes](std::size_t begin, std::size_t end, std::size_t) {
        touch_huge_pages(room, bytes, begin, end);
        for (; begin < end; begin += kPage) static_cast<volatile unsigned char*>(room)[begin] = 0;
    });
}

/// n elements, made new.
template <class T>
std::vector<T> make_on_huge_pages(std::size_t n, Workers& workers) {
    std::vector<T> list;
    reserve_on_huge_pages(list, n, workers);
    list.resize(n);
    return list;
}

}  // namespace wellmesh
