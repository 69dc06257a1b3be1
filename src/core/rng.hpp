// SPDX-License-Identifier: Apache-2.0
// Counter-based random numbers: a value depends on its key alone, never on how many were drawn before, so the output is
// the same for any order of work and any number of threads. SplitMix64 finaliser [Steele14].
#pragma once

#include <cstdint>

namespace wellmesh {

constexpr std::uint64_t mix64(std::uint64_t z) {
    z += 0x9e3779b97f4a7c15ULL;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
}

constexpr std::uint64_t mix64(std::uint64_t a, std::uint64_t b) { return mix64(a ^ mix64(b)); }

/// Uniform in [0, 1), 53 bits.
constexpr double unit_double(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

}  // namespace wellmesh
