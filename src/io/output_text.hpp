// SPDX-License-Identifier: Apache-2.0
// Text and bytes of a part of a file, formatted in memory.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#include "wellmesh/vec3.hpp"

namespace wellmesh::io {

inline constexpr std::size_t kLongestNumber = 32;  ///< shortest round-trip doubles take at most 24 characters, 64-bit integers 20

/// Members as OutputFile's, so that the same code writes to either.
class OutputText {
public:
    void clear() { used_ = 0; }
    [[nodiscard]] std::string_view written() const { return {buffer_.data(), used_}; }

    void text(std::string_view text) { bytes(text.data(), text.size()); }
    void character(char c) {
        make_room(1);
        buffer_[used_++] = c;
    }
    void integer(std::int64_t value) { number(value); }
    void real(double value) { number(value); }
    void bytes(const void* data, std::size_t size) {
        make_room(size);
        if (size > 0) std::memcpy(buffer_.data() + used_, data, size);
        used_ += size;
    }
    void point(const Vec3& p) {
        real(p.x);
        character(' ');
        real(p.y);
        character(' ');
        real(p.z);
    }

private:
    template <class T>
    void number(T value) {
        make_room(kLongestNumber);
        char* const first = buffer_.data() + used_;
        used_ += static_cast<std::size_t>(std::to_chars(first, first + kLongestNumber, value).ptr - first);
    }
    void make_room(std::size_t size) {
        if (buffer_.size() - used_ < size) buffer_.resize(2 * buffer_.size() + size + 4096);
    }
    std::vector<char> buffer_;
    std::size_t used_ = 0;
};

}  // namespace wellmesh::io
