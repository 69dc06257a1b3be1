// SPDX-License-Identifier: Apache-2.0
// Memory for large arrays, straight from the system. It grows without a copy: its pages move, so an array that grows is never there twice. What is given back
// is the system's again at once, where an allocator may keep it as a hole.
#pragma once

#include <cstddef>

namespace wellmesh {

/// Can this system do that? Sanitizers watch the allocator, so with them it can't.
#if defined(__linux__) && !defined(WELLMESH_SANITIZED)
inline constexpr bool kPagesMove = true;
#else
inline constexpr bool kPagesMove = false;
#endif
/// Smaller arrays are the allocator's.
inline constexpr std::size_t kLeastPaged = std::size_t{1} << 21;

/// Zeros, on huge pages where there is enough of them: visits at random miss the translation buffer with small ones.
/// @throws std::bad_alloc. @pre kPagesMove, for all of these
[[nodiscard]] void* take_pages(std::size_t bytes);
/// The same content in more memory; `pages` is no more. @throws std::bad_alloc, with nothing changed
[[nodiscard]] void* grow_pages(void* pages, std::size_t bytes, std::size_t more_bytes);
void give_back_pages(void* pages, std::size_t bytes) noexcept;

}  // namespace wellmesh
