// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace wellmesh {

/// Bytes of physical memory that the process holds: now, where the system says so (Linux), else the most that it has held; 0 where neither is known.
[[nodiscard]] std::uint64_t resident_bytes() noexcept;

/// Gives back to the system what the program has freed and its allocator holds on to, as after many arrays of different sizes. Nothing depends on it.
void return_freed_memory() noexcept;

}  // namespace wellmesh
