// SPDX-License-Identifier: Apache-2.0
#include "io/number_parsing.hpp"

#include <charconv>
#include <cmath>
#include <cstddef>
#include <system_error>

namespace wellmesh::io {
namespace {

std::string_view without_plus(std::string_view token) noexcept {
    // "+-1" must stay wrong, so a sign after the plus is not eaten.
    if (token.size() > 1 && token[0] == '+' && token[1] != '-' && token[1] != '+') token.remove_prefix(1);
    return token;
}

/// Whether a decimal token that no double holds is too small rather than too large: the sign of its exponent decides,
/// because digits alone cannot leave the range in any file that exists, and zeros after the point only make it smaller.
bool underflows(std::string_view token) noexcept {
    const std::size_t e = token.find_first_of("eE");
    if (e != std::string_view::npos) return e + 1 < token.size() && token[e + 1] == '-';
    const std::size_t first = token.find_first_of("123456789"), point = token.find('.');
    return point != std::string_view::npos && point < first;
}

}  // namespace

ParsedReal parse_real(std::string_view token) noexcept {
    const std::string_view text = without_plus(token);
    ParsedReal parsed;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), parsed.value);
    if (error == std::errc::invalid_argument || end != text.data() + text.size()) return {0, NumberFault::not_a_number};
    if (error == std::errc::result_out_of_range) {
        if (!underflows(text)) return {0, NumberFault::too_large};
        return {text.front() == '-' ? -0.0 : 0.0, NumberFault::none};
    }
    if (!std::isfinite(parsed.value)) return {0, NumberFault::not_finite};
    return parsed;
}

std::optional<std::int64_t> parse_integer(std::string_view token) noexcept {
    const std::string_view text = without_plus(token);
    std::int64_t value = 0;
    const bool negative = text.starts_with('-');
    const std::string_view digits = text.substr(negative ? 1 : 0);
    constexpr std::size_t kSafeDigits = 18;  // that 64 bits hold whatever they are: most of what is read, without a check of each digit
    if (!digits.empty() && digits.size() <= kSafeDigits) {
        for (const char c : digits) {
            if (c < '0' || c > '9') return std::nullopt;
            value = 10 * value + (c - '0');
        }
        return negative ? -value : value;
    }
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

std::optional<std::int64_t> parse_integral_real(std::string_view token) noexcept {
    if (const auto integer = parse_integer(token)) return integer;
    const ParsedReal real = parse_real(token);
    constexpr double kLargestExact = 0x1p53;
    if (real.fault != NumberFault::none || std::abs(real.value) > kLargestExact || real.value != std::trunc(real.value)) return std::nullopt;
    return static_cast<std::int64_t>(real.value);
}

}  // namespace wellmesh::io
