// SPDX-License-Identifier: Apache-2.0
// Memory for large arrays, straight from the system. It grows without a copy: its pages move, so an array that grows is never there twice. What is given back
// is the system's again at once, where an allocator may keep it as a hole.
#pragma once

#include <cstddef>
#include <cstdint>

namespace wellmesh {

/// Can this system do that? Sanitizers watch the allocator, so with them it can't.
#if defined(__linux__) && !defined(WELLMESH_SANITIZED)
inline constexpr bool kPagesMove = true;
#else
inline constexpr bool kPagesMove = false;
#endif
/// Smaller arrays are the allocator's.
inline constexpr std::size_t kLeastPaged = std::size_t{1} << 21;

/// Zeros. @throws std::bad_alloc. @pre kPagesMove, for all of these
[[nodiscard]] void* take_pages(std::size_t bytes);
/// The same content in more memory; `pages` is no more. @throws std::bad_alloc, with nothing changed
[[nodiscard]] void* grow_pages(void* pages, std::size_t bytes, std::size_t more_bytes);
/// To be called before bytes are touched that weren't yet, of `pages` of so many `bytes`: what is touched next is put on huge pages, where there is enough
/// of it and the machine has them at hand (docs/decisions/0034-slow-pages.md). Visits at random miss the translation buffer with small ones. A hint: nothing
/// depends on it.
/// @param ready   so many of the first bytes were told of before
/// @param wanted  so many are to be touched now
/// @return so many may be touched before the next call; at least `wanted`
[[nodiscard]] std::size_t ready_pages(void* pages, std::size_t bytes, std::size_t ready, std::size_t wanted);
/// Touches the huge pages among bytes `first` to `last` of pages that ready_pages() was told of, until they turn out to come slowly. For several threads,
/// each with a share.
/// @pre nobody has touched that share
void touch_pages(void* pages, std::size_t bytes, std::size_t first, std::size_t last);
void give_back_pages(void* pages, std::size_t bytes) noexcept;

/// Huge pages for memory from elsewhere that nobody has touched yet and somebody will, all of it, unless they come slowly.
void advise_huge_pages(void* data, std::size_t bytes);
/// As touch_pages(), for such memory.
void touch_huge_pages(void* data, std::size_t bytes, std::size_t first, std::size_t last);

/// Nanoseconds of a thread's work from which on a huge page comes slowly.
inline constexpr std::int64_t kSlowPage = 1'000'000;
/// For tests, which have no slow machine at hand: another number instead, of the whole process.
void set_slow_page(std::int64_t nanoseconds);

}  // namespace wellmesh
