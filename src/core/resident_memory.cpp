// SPDX-License-Identifier: Apache-2.0
#include "core/resident_memory.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <charconv>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace wellmesh {
namespace {

/// /proc/self/statm: sizes in pages, the second one is what is resident. 0 if there is no such file.
std::uint64_t resident_pages() noexcept {
    const int descriptor = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return 0;
    char text[64];
    const ssize_t size = ::read(descriptor, text, sizeof text);
    ::close(descriptor);
    const char* at = text;
    const char* const end = text + (size > 0 ? size : 0);
    while (at != end && *at != ' ') ++at;
    std::uint64_t pages = 0;
    if (at != end) std::from_chars(at + 1, end, pages);
    return pages;
}

}  // namespace

std::uint64_t resident_bytes() noexcept {
    if (const std::uint64_t pages = resident_pages(); pages > 0) return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
    rusage usage{};
    if (::getrusage(RUSAGE_SELF, &usage) != 0 || usage.ru_maxrss <= 0) return 0;
#ifdef __APPLE__
    return static_cast<std::uint64_t>(usage.ru_maxrss);  // bytes there, KiB elsewhere
#else
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
#endif
}

void return_freed_memory() noexcept {
#ifdef __GLIBC__
    (void)::malloc_trim(0);
#endif
}

}  // namespace wellmesh
