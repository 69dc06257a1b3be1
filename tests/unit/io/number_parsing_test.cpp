// SPDX-License-Identifier: Apache-2.0
#include "io/number_parsing.hpp"

#include <bit>
#include <clocale>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <fmt/format.h>

#include "core/rng.hpp"

namespace wellmesh::io {
namespace {

TEST(ParseReal, AcceptsWhatFilesContain) {
    const std::pair<const char*, double> cases[] = {{"1", 1},
                                                    {"+1", 1},
                                                    {"-1", -1},
                                                    {"1.", 1},
                                                    {".5", 0.5},
                                                    {"-.5e1", -5},
                                                    {"1e5", 1e5},
                                                    {"1E+05", 1e5},
                                                    {"1.5e-3", 1.5e-3},
                                                    {"3.055220e+000", 3.05522},
                                                    {"007", 7},
                                                    {"4.0822e-017", 4.0822e-17},
                                                    {"5e-324", 5e-324},
                                                    {"1.7976931348623157e308", 1.7976931348623157e308},
                                                    {"-31165.1952999999994062819", -31165.1953},
                                                    {"0e999", 0}};
    for (const auto& [text, value] : cases) {
        const ParsedReal parsed = parse_real(text);
        EXPECT_EQ(parsed.fault, NumberFault::none) << text;
        EXPECT_EQ(parsed.value, value) << text;
    }
}

TEST(ParseReal, RejectsWhatIsNoFiniteDecimal) {
    for (const char* const text :
         {"", "+", "-", ".", "e5", "1e", "1e+", "1d5", "1D5", "0x10", "1,5", "1 ", " 1", "--1", "+-1", "++1", "abc", "1.2.3", "1.#INF", "1_000"})
        EXPECT_EQ(parse_real(text).fault, NumberFault::not_a_number) << text;
    for (const char* const text : {"nan", "NaN", "-nan", "inf", "-inf", "INFINITY", "+inf"})
        EXPECT_EQ(parse_real(text).fault, NumberFault::not_finite) << text;
    for (const char* const text : {"1e309", "-1e400", "1e99999999999"}) EXPECT_EQ(parse_real(text).fault, NumberFault::too_large) << text;
}

TEST(ParseReal, TooSmallBecomesASignedZero) {
    for (const char* const text : {"1e-400", "1e-99999999999", "4.9e-326"}) {
        const ParsedReal parsed = parse_real(text);
        EXPECT_EQ(parsed.fault, NumberFault::none) << text;
        EXPECT_EQ(parsed.value, 0) << text;
        EXPECT_TRUE(std::signbit(parse_real(std::string("-") + text).value)) << text;
    }
    EXPECT_EQ(parse_real("0." + std::string(400, '0') + "1").fault, NumberFault::none);
    EXPECT_EQ(parse_real("1" + std::string(400, '0')).fault, NumberFault::too_large);
}

TEST(ParseReal, AgreesWithStrtodOnRandomDoubles) {
    int finite = 0;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        const double value = std::bit_cast<double>(mix64(5, i));
        if (!std::isfinite(value)) continue;
        ++finite;
        const std::string text = fmt::format("{:.{}e}", value, i % 20);
        const ParsedReal parsed = parse_real(text);
        if (std::isinf(std::strtod(text.c_str(), nullptr))) {  // rounded up beyond the largest double
            EXPECT_EQ(parsed.fault, NumberFault::too_large) << text;
            continue;
        }
        EXPECT_EQ(std::bit_cast<std::uint64_t>(parsed.value), std::bit_cast<std::uint64_t>(std::strtod(text.c_str(), nullptr))) << text;
    }
    EXPECT_GT(finite, 19000);
}

TEST(ParseReal, DoesNotDependOnTheLocale) {
    const char* const set = std::setlocale(LC_ALL, "de_DE.UTF-8");
    EXPECT_EQ(parse_real("1.5").value, 1.5);
    EXPECT_EQ(parse_real("1,5").fault, NumberFault::not_a_number);
    std::setlocale(LC_ALL, "C");
    if (set == nullptr) GTEST_SKIP() << "no German locale here: checked in the C locale only";
}

TEST(ParseInteger, TakesWholeTokensOnly) {
    EXPECT_EQ(parse_integer("+12"), 12);
    EXPECT_EQ(parse_integer("-0"), 0);
    EXPECT_EQ(parse_integer("9223372036854775807"), INT64_MAX);
    for (const char* const text : {"", "+", "1.0", "1e3", "12a", "0x1", "9223372036854775808", "+-3"}) EXPECT_FALSE(parse_integer(text)) << text;
    EXPECT_EQ(parse_integral_real("3.000000"), 3);
    EXPECT_EQ(parse_integral_real("-2e1"), -20);
    for (const char* const text : {"3.5", "nan", "1e300", "x"}) EXPECT_FALSE(parse_integral_real(text)) << text;
}

}  // namespace
}  // namespace wellmesh::io
