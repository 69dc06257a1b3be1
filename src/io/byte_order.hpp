// SPDX-License-Identifier: Apache-2.0
// Numbers in binary files.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <string_view>

namespace wellmesh::io {

/// The T at `offset`, which may be unaligned. @pre offset + sizeof(T) <= bytes.size()
template <class T>
[[nodiscard]] T load(std::string_view bytes, std::size_t offset, std::endian order) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes.data() + offset, sizeof(T));
    if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
}

}  // namespace wellmesh::io
