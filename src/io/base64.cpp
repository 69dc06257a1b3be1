// SPDX-License-Identifier: Apache-2.0
#include "io/base64.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

namespace wellmesh::io {
namespace {

constexpr std::uint8_t kNone = 64, kPadding = 65, kBlank = 66;

constexpr std::array<std::uint8_t, 256> make_values() {
    std::array<std::uint8_t, 256> values{};
    values.fill(kNone);
    constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < kAlphabet.size(); ++i) values[static_cast<unsigned char>(kAlphabet[i])] = static_cast<std::uint8_t>(i);
    values[static_cast<unsigned char>('=')] = kPadding;
    for (const char c : {' ', '\t', '\n', '\r'}) values[static_cast<unsigned char>(c)] = kBlank;
    return values;
}
constexpr std::array<std::uint8_t, 256> kValues = make_values();

}  // namespace

std::string decode_base64(std::string_view text, std::size_t most, std::size_t& used) {
    std::string out;
    out.reserve(std::min(most, text.size() / 4 * 3 + 3));
    std::uint32_t group = 0;
    int characters = 0, padding = 0;
    std::size_t i = 0;
    for (; i < text.size() && out.size() < most; ++i) {
        const std::uint8_t value = kValues[static_cast<unsigned char>(text[i])];
        if (value == kBlank) continue;
        if (value == kNone || (value == kPadding && characters < 2) || (value != kPadding && padding > 0)) break;
        group = (group << 6) | (value == kPadding ? 0U : value);
        padding += value == kPadding ? 1 : 0;
        if (++characters < 4) continue;
        for (int byte = 0; byte < 3 - padding && out.size() < most; ++byte) out += static_cast<char>((group >> (16 - 8 * byte)) & 0xffU);
        group = 0;
        characters = padding = 0;
    }
    used = i;
    return out;
}

std::string decode_base64(std::string_view text, std::size_t most) {
    std::size_t used = 0;
    return decode_base64(text, most, used);
}

}  // namespace wellmesh::io
