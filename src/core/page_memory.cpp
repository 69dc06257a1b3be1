// SPDX-License-Identifier: Apache-2.0
#include "core/page_memory.hpp"

#include <cstdint>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace wellmesh {

#ifdef __linux__

namespace {

constexpr std::size_t kHugePage = std::size_t{1} << 21;
/// What lies between the last element and the end of its page is held for nothing: of smaller arrays it would be more than an eighth.
constexpr std::size_t kLeastHuge = 8 * kHugePage;

/// Whole huge pages, so that one advice covers a mapping: pages of two mappings don't move together. What is never touched costs nothing.
std::size_t whole_pages(std::size_t bytes) { return (bytes + kHugePage - 1) / kHugePage * kHugePage; }

}  // namespace

void* take_pages(std::size_t bytes) {
    const std::size_t wanted = whole_pages(bytes);
    void* const mapped = ::mmap(nullptr, wanted + kHugePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapped == MAP_FAILED) throw std::bad_alloc();
    // Aligned, else huge pages fall apart when they move.
    char* const begin = static_cast<char*>(mapped);
    const std::size_t ahead = (kHugePage - reinterpret_cast<std::uintptr_t>(mapped) % kHugePage) % kHugePage;
    if (ahead > 0) (void)::munmap(begin, ahead);
    if (ahead < kHugePage) (void)::munmap(begin + ahead + wanted, kHugePage - ahead);
    if (wanted >= kLeastHuge) (void)::madvise(begin + ahead, wanted, MADV_HUGEPAGE);
    return begin + ahead;
}

void* grow_pages(void* pages, std::size_t bytes, std::size_t more_bytes) {
    const std::size_t before = whole_pages(bytes), wanted = whole_pages(more_bytes);
    if (wanted == before) return pages;
    void* grown = ::mremap(pages, before, wanted, 0);
    if (grown == MAP_FAILED) {
        void* const place = take_pages(wanted);
        grown = ::mremap(pages, before, wanted, MREMAP_MAYMOVE | MREMAP_FIXED, place);
        if (grown == MAP_FAILED) {
            give_back_pages(place, wanted);
            throw std::bad_alloc();
        }
    }
    if (wanted >= kLeastHuge && before < kLeastHuge) (void)::madvise(grown, wanted, MADV_HUGEPAGE);
    return grown;
}

void give_back_pages(void* pages, std::size_t bytes) noexcept { (void)::munmap(pages, whole_pages(bytes)); }

#else

void* take_pages(std::size_t) { throw std::bad_alloc(); }
void* grow_pages(void*, std::size_t, std::size_t) { throw std::bad_alloc(); }
void give_back_pages(void*, std::size_t) noexcept {}

#endif

}  // namespace wellmesh
