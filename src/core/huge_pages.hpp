// SPDX-License-Identifier: Apache-2.0
// Large arrays on large pages. Visits at random miss the translation buffer with 4 kB pages, and the system clears a page of 2 MB faster than 512 small ones.
// A hint: nothing depends on it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

#include "core/workers.hpp"

namespace wellmesh {

/// To be called before the memory is touched.
inline void advise_huge_pages([[maybe_unused]] void* data, [[maybe_unused]] std::size_t bytes) {
#ifdef __linux__
    constexpr std::uintptr_t kHugePage = std::uintptr_t{1} << 21;
    const auto begin = (reinterpret_cast<std::uintptr_t>(data) + kHugePage - 1) & ~(kHugePage - 1);
    const auto end = (reinterpret_cast<std::uintptr_t>(data) + bytes) & ~(kHugePage - 1);
    if (begin < end) (void)madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
#endif
}

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
    constexpr std::size_t kPage = 4096, kPiece = std::size_t{1} << 21;
    auto* const room = reinterpret_cast<unsigned char*>(list.data() + list.size());
    workers.for_ranges((n - list.size()) * sizeof(T), kPiece, [room](std::size_t begin, std::size_t end, std::size_t) {
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
