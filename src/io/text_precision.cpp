// SPDX-License-Identifier: Apache-2.0
#include "io/text_precision.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <string>

#include <fmt/format.h>

#include "io/number_parsing.hpp"

namespace wellmesh::io {
namespace {

constexpr int kDoubleDigits = 16;     // rule 3
constexpr int kNominalDigits = 4;     // rule 4
constexpr int kWrittenOutDigits = 10; // float32 needs at most 9 digits; more means that a double was printed
constexpr int kMantissaDigits = 19;   // that surely fit 64 bits

struct DecimalText {
    int significant = 0;         // digits from the first that isn't zero
    std::uint64_t mantissa = 0;  // those digits, if there are at most kMantissaDigits
    int decimals = 0;            // places after the point, exponent included; negative for trailing integer zeros
};

DecimalText read_decimal(std::string_view token) {
    DecimalText text;
    bool after_point = false;
    std::size_t i = !token.empty() && (token[0] == '-' || token[0] == '+') ? 1 : 0;
    for (; i < token.size(); ++i) {
        const char c = token[i];
        if (c == '.') {
            after_point = true;
            continue;
        }
        if (c < '0' || c > '9') break;
        if (after_point) ++text.decimals;
        if (text.significant > 0 || c != '0') ++text.significant;
        if (text.significant <= kMantissaDigits) text.mantissa = 10 * text.mantissa + static_cast<std::uint64_t>(c - '0');
    }
    if (i + 1 < token.size() && (token[i] == 'e' || token[i] == 'E')) {
        i += token[i + 1] == '+' ? 2U : 1U;
        int exponent = 0;
        std::from_chars(token.data() + i, token.data() + token.size(), exponent);
        text.decimals -= std::clamp(exponent, -1000, 1000);  // finite doubles lie well within
    }
    return text;
}

bool is_exact(DecimalText text) {
    if (text.significant > kMantissaDigits) return false;
    while (text.mantissa % 10 == 0 && text.mantissa != 0) {
        text.mantissa /= 10;
        --text.decimals;
    }
    if (text.decimals <= 0) return true;
    constexpr int kLargestPower = 27;  // 5^27 < 2^63
    if (text.decimals > kLargestPower) return false;
    std::uint64_t power = 1;
    for (int f = 0; f < text.decimals; ++f) power *= 5;
    return text.mantissa % power == 0;
}

bool fills_float32(double value) {
    int exponent = 0;
    const double mantissa = std::frexp(std::abs(value), &exponent);       // in [0.5, 1)
    const double bits22 = std::ldexp(mantissa, 22);
    return bits22 != std::trunc(bits22);  // needs at least 23 bits
}

// Powers and logarithms by way of decimal text: libraries differ in the last bit of pow() and log10().
double power_of_ten(int exponent) {
    return parse_real(fmt::format("1e{}", exponent)).value;
}

int leading_place(double magnitude) {
    const std::string text = fmt::format("{:e}", magnitude);
    int place = 0;
    const char* first = text.data() + text.find('e') + 1;
    std::from_chars(first + (*first == '+' ? 1 : 0), text.data() + text.size(), place);
    return place;
}

}  // namespace

void TextPrecision::note(std::string_view token, double value) {
    const double magnitude = std::abs(value);
    largest_ = std::max(largest_, magnitude);
    if (value == 0 || (!all_float32_ && digits_ >= kDoubleDigits)) return;
    if (all_float32_ && (magnitude > 3.4e38 || static_cast<double>(static_cast<float>(value)) != value)) all_float32_ = false;
    const DecimalText text = read_decimal(token);
    if (all_float32_ && text.significant >= kWrittenOutDigits && fills_float32(value)) full_float32_ = true;
    if (is_exact(text)) return;
    digits_ = std::max(digits_, text.significant);
    largest_inexact_ = std::max(largest_inexact_, magnitude);
}

void TextPrecision::note(double value) {
    if (!all_float32_ && digits_ >= kDoubleDigits) {  // nothing can change but the largest
        largest_ = std::max(largest_, std::abs(value));
        return;
    }
    fmt::memory_buffer text;
    fmt::format_to(std::back_inserter(text), "{}", value);
    note(std::string_view(text.data(), text.size()), value);
}

void TextPrecision::join(const TextPrecision& other) {
    // Where note() returns early, what it leaves out can't change the outcome any more, here or there.
    largest_ = std::max(largest_, other.largest_);
    largest_inexact_ = std::max(largest_inexact_, other.largest_inexact_);
    digits_ = std::max(digits_, other.digits_);
    all_float32_ = all_float32_ && other.all_float32_;
    full_float32_ = full_float32_ || other.full_float32_;
}

double TextPrecision::relative_rounding() const {
    if (all_float32_ && full_float32_) return kFloat32Rounding;
    if (digits_ <= kNominalDigits || digits_ >= kDoubleDigits || largest_inexact_ == 0) return 0;
    return 0.5 * power_of_ten(leading_place(largest_inexact_) + 1 - digits_) / largest_;
}

}  // namespace wellmesh::io
