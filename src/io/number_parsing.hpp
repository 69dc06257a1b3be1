// SPDX-License-Identifier: Apache-2.0
// Numbers of text files, whatever the locale: std::from_chars, plus the leading '+' that real files contain.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace wellmesh::io {

enum class NumberFault { none, not_a_number, not_finite, too_large };

struct ParsedReal {
    double value = 0;
    NumberFault fault = NumberFault::none;
};

/// The whole token as a decimal real, correctly rounded; too small a magnitude gives a signed zero. Hexadecimal digits and
/// Fortran's D exponents are not numbers here.
[[nodiscard]] ParsedReal parse_real(std::string_view token) noexcept;

/// The whole token as a decimal integer; empty if it isn't one or doesn't fit.
[[nodiscard]] std::optional<std::int64_t> parse_integer(std::string_view token) noexcept;

/// As parse_integer, but integral reals ("3.000000", "-2e1") count too: attributes are often printed as reals.
[[nodiscard]] std::optional<std::int64_t> parse_integral_real(std::string_view token) noexcept;

}  // namespace wellmesh::io
