// SPDX-License-Identifier: Apache-2.0
#include "core/page_memory.hpp"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#include <time.h>
#endif

namespace wellmesh {

#ifdef __linux__

namespace {

constexpr std::size_t kHugePage = std::size_t{1} << 21;
/// What lies between the last element and the end of its page is held for nothing: of smaller arrays it would be more than an eighth.
constexpr std::size_t kLeastHuge = 8 * kHugePage;

/// Whole huge pages, so that one advice covers a mapping: pages of two mappings don't move together. What is never touched costs nothing.
std::size_t whole_pages(std::size_t bytes) { return (bytes + kHugePage - 1) / kHugePage * kHugePage; }

/// @pre whole huge pages
char* map_pages(std::size_t wanted) {
    void* const mapped = ::mmap(nullptr, wanted + kHugePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapped == MAP_FAILED) throw std::bad_alloc();
    // Aligned, else huge pages fall apart when they move.
    char* const begin = static_cast<char*>(mapped);
    const std::size_t ahead = (kHugePage - reinterpret_cast<std::uintptr_t>(mapped) % kHugePage) % kHugePage;
    if (ahead > 0) (void)::munmap(begin, ahead);
    if (ahead < kHugePage) (void)::munmap(begin + ahead + wanted, kHugePage - ahead);
    return begin + ahead;
}

/// Of so much memory the first huge page is tried.
constexpr std::size_t kWindow = 4 * kHugePage;
/// Nanoseconds. Clearing 2 MB takes 0.1 to 0.3 ms; where the host of a virtual machine has taken free memory back and now brings it 4 kB at a time, 4 ms.
std::atomic<std::int64_t> slow_page{kSlowPage};
/// After a slow page so many askings have small pages without a trial, which costs what it finds.
constexpr int kLeftOut = 15;
std::atomic<int> askings_left_out{0};

/// Nanoseconds that this thread was at work: being interrupted says nothing about pages.
std::int64_t thread_clock() {
    timespec t{};
    (void)::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

/// Are huge pages slow here? Those at every so many bytes from `page` to `end`, advised to be huge, are touched to see.
bool are_slow(char* page, char* end, std::size_t step) {
    for (; page < end; page += std::min(step, static_cast<std::size_t>(end - page))) {
        const std::int64_t before = thread_clock();
        *static_cast<volatile char*>(page) = 0;
        if (thread_clock() - before <= slow_page.load(std::memory_order_relaxed)) continue;
        askings_left_out.store(kLeftOut, std::memory_order_relaxed);
        return true;
    }
    return false;
}

/// The whole huge pages in some memory.
struct HugePages {
    char* begin;
    std::size_t bytes;
};
HugePages huge_pages_in(void* data, std::size_t bytes) {
    const std::size_t ahead = (kHugePage - reinterpret_cast<std::uintptr_t>(data) % kHugePage) % kHugePage;
    return {static_cast<char*>(data) + ahead, bytes < ahead ? 0 : (bytes - ahead) / kHugePage * kHugePage};
}

/// Touches those in a share of them, until they are slow: then the rest of all is to be small.
void touch_share(HugePages all, HugePages share) {
    if (askings_left_out.load(std::memory_order_relaxed) != 0 || are_slow(share.begin, share.begin + share.bytes, kHugePage))
        (void)::madvise(all.begin, all.bytes, MADV_NOHUGEPAGE);
}

/// Huge pages for `bytes` from `begin` on, after a look at those from `first` to `last`, which nobody has touched.
/// @return false where they are slow: then it's small ones that are asked for, as they come out of memory that the host never had back, or in pieces of it
bool advise(char* begin, std::size_t bytes, char* first, char* last) {
    int left_out = askings_left_out.load(std::memory_order_relaxed);
    const bool is_left_out = left_out > 0 && askings_left_out.compare_exchange_strong(left_out, left_out - 1, std::memory_order_relaxed);
    if (!is_left_out && (::madvise(begin, bytes, MADV_HUGEPAGE) != 0 || !are_slow(first, last, kWindow))) return true;
    (void)::madvise(begin, bytes, MADV_NOHUGEPAGE);
    return false;
}

}  // namespace

void advise_huge_pages(void* data, std::size_t bytes) {
    const HugePages pages = huge_pages_in(data, bytes);
    if (pages.bytes != 0) (void)advise(pages.begin, pages.bytes, pages.begin, pages.begin + pages.bytes);
}

void touch_huge_pages(void* data, std::size_t bytes, std::size_t first, std::size_t last) {
    touch_share(huge_pages_in(data, bytes), huge_pages_in(static_cast<char*>(data) + first, last - first));
}

void set_slow_page(std::int64_t nanoseconds) { slow_page.store(nanoseconds, std::memory_order_relaxed); }

void* take_pages(std::size_t bytes) { return map_pages(whole_pages(bytes)); }

void* grow_pages(void* pages, std::size_t bytes, std::size_t more_bytes) {
    const std::size_t before = whole_pages(bytes), wanted = whole_pages(more_bytes);
    if (wanted == before) return pages;
    void* grown = ::mremap(pages, before, wanted, 0);
    if (grown == MAP_FAILED) {
        void* const place = map_pages(wanted);
        grown = ::mremap(pages, before, wanted, MREMAP_MAYMOVE | MREMAP_FIXED, place);
        if (grown == MAP_FAILED) {
            give_back_pages(place, wanted);
            throw std::bad_alloc();
        }
    }
    return grown;
}

std::size_t ready_pages(void* pages, std::size_t bytes, std::size_t ready, std::size_t wanted) {
    const std::size_t whole = whole_pages(bytes);
    if (whole < kLeastHuge) return whole;
    char* const begin = static_cast<char*>(pages);
    ready = whole_pages(ready);
    const std::size_t end = std::min(whole, std::max(whole_pages(wanted), ready + kWindow));
    // The whole mapping, as one of two kinds wouldn't move in one. What was touched stays as it is.
    return advise(begin, whole, begin + ready, begin + end) ? end : whole;
}

void touch_pages(void* pages, std::size_t bytes, std::size_t first, std::size_t last) {
    const std::size_t whole = whole_pages(bytes);
    char* const begin = static_cast<char*>(pages);
    if (whole >= kLeastHuge) touch_share({begin, whole}, huge_pages_in(begin + first, last - first));
}

void give_back_pages(void* pages, std::size_t bytes) noexcept { (void)::munmap(pages, whole_pages(bytes)); }

#else

void advise_huge_pages(void*, std::size_t) {}
void touch_huge_pages(void*, std::size_t, std::size_t, std::size_t) {}
void* take_pages(std::size_t) { throw std::bad_alloc(); }
void* grow_pages(void*, std::size_t, std::size_t) { throw std::bad_alloc(); }
std::size_t ready_pages(void*, std::size_t bytes, std::size_t, std::size_t) { return bytes; }
void touch_pages(void*, std::size_t, std::size_t, std::size_t) {}
void set_slow_page(std::int64_t) {}
void give_back_pages(void*, std::size_t) noexcept {}

#endif

}  // namespace wellmesh
