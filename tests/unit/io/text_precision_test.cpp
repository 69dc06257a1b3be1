// SPDX-License-Identifier: Apache-2.0
#include "io/text_precision.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <fmt/format.h>

#include "core/rng.hpp"
#include "io/number_parsing.hpp"

namespace wellmesh::io {
namespace {

double rounding_of(const std::vector<std::string>& tokens) {
    TextPrecision precision;
    for (const std::string& token : tokens) precision.note(token, parse_real(token).value);
    return precision.relative_rounding();
}

TEST(TextPrecision, ExactCoordinatesHaveNoRounding) {
    EXPECT_EQ(rounding_of({}), 0);
    EXPECT_EQ(rounding_of({"0", "0.0", "-0"}), 0);
    EXPECT_EQ(rounding_of({"1", "0.5", "0.25", "-12.375", "1e3", "2.5e-1", "1000000", "123456789", "0.500000", "3.000000e+00"}), 0);
}

TEST(TextPrecision, ShortDecimalsMeanWhatTheySay) {
    EXPECT_EQ(rounding_of({"0.1", "2.54", "1.2", "12.7"}), 0);
}

TEST(TextPrecision, FullTextHasNoRounding) {
    EXPECT_EQ(rounding_of({"0.10000000000000001", "12.699999999999999"}), 0);
    EXPECT_EQ(rounding_of({"-31165.1952999999994062819", "5180.8051800000002913293"}), 0);
}

TEST(TextPrecision, IsHalfAUnitOfTheLastDigitOfTheLargest) {
    EXPECT_DOUBLE_EQ(rounding_of({"0.287649", "0.0626717", "0.5"}), 0.5e-6 / 0.5);        // %g: six digits, largest inexact 0.28
    EXPECT_DOUBLE_EQ(rounding_of({"63.879372", "143.027054", "0.5"}), 0.5e-6 / 143.027054);  // %f
    EXPECT_DOUBLE_EQ(rounding_of({"3.055220e+000", "5.027685e+000", "1.000000e+01"}), 0.5e-6 / 10);  // %e; 10 is exact
    EXPECT_DOUBLE_EQ(rounding_of({"896.321", "824.553", "5.66", "6.21211"}), 0.5e-3 / 896.321);
}

TEST(TextPrecision, RecognisesFloat32WrittenOut) {
    EXPECT_EQ(rounding_of({"-25.198211669921875", "-650.77587890625", "1174.5123291015625"}), 0x1p-24);
    EXPECT_EQ(rounding_of({"0.100000001490116119384765625", "1"}), 0x1p-24);
    EXPECT_EQ(rounding_of({"-25.198211669921875", "0.10000000000000001"}), 0) << "one coordinate is no float32 number";
    EXPECT_EQ(rounding_of({"4194303.5", "5412345"}), 0) << "a half-metre grid is no float32 data";
}

// The claim itself: printing random coordinates with few digits moves none of them by more than the bound, nor is the bound
// more than 10 x the largest move (it is a worst case over the digits of the largest coordinate).
TEST(TextPrecision, BoundsWhatPrintingLoses) {
    int tested = 0;
    for (const char kind : {'g', 'e', 'f'})
        for (int digits = 5; digits <= 12; ++digits)
            for (std::uint64_t round = 0; round < 20; ++round) {
                const double scale = std::pow(10.0, static_cast<double>(round % 7) - 3);
                TextPrecision precision;
                double largest = 0, moved = 0;
                for (std::uint64_t i = 0; i < 200; ++i) {
                    const double value = scale * (2 * unit_double(mix64(round, i)) - 1);
                    const std::string text = kind == 'g' ? fmt::format("{:.{}g}", value, digits)
                                             : kind == 'e' ? fmt::format("{:.{}e}", value, digits - 1)
                                                           : fmt::format("{:.{}f}", value, digits);
                    const double read = parse_real(text).value;
                    precision.note(text, read);
                    largest = std::max(largest, std::abs(read));
                    moved = std::max(moved, std::abs(read - value));
                }
                const double bound = precision.relative_rounding() * largest;
                if (bound == 0) continue;  // %f of tiny numbers leaves four digits or fewer: taken at their word
                ++tested;
                EXPECT_LE(moved, bound + 2 * std::numeric_limits<double>::epsilon() * largest) << kind << digits << " scale " << scale;
                EXPECT_GE(moved * 11, bound) << kind << digits << " scale " << scale;
            }
    EXPECT_GT(tested, 400);
}

// Each part of a list is of one kind; so joining has to bring together what decides each of the rules.
TEST(TextPrecision, IsTheSameForPartsThatAreJoined) {
    int rounded = 0;
    for (std::uint64_t round = 0; round < 500; ++round) {
        TextPrecision whole, joined;
        for (std::uint64_t part = 0; part < 1 + round % 4; ++part) {
            TextPrecision alone;
            const std::uint64_t kind = mix64(round, 10 * part) % 5, digits = 3 + mix64(round, 10 * part + 1) % 8;
            for (std::uint64_t i = 0; i < mix64(round, 10 * part + 2) % 4; ++i) {
                const double value = 10 * unit_double(mix64(round, 10 * part + 3 + i));
                const std::string text = kind == 0   ? fmt::format("{}", std::floor(value))
                                         : kind == 1 ? fmt::format("{:.30g}", static_cast<double>(static_cast<float>(value)))
                                         : kind == 2 ? fmt::format("{}", value)
                                                     : fmt::format("{:.{}g}", value, digits);
                const double read = parse_real(text).value;
                whole.note(text, read);
                alone.note(text, read);
            }
            joined.join(alone);
        }
        EXPECT_EQ(joined.relative_rounding(), whole.relative_rounding()) << round;
        rounded += whole.relative_rounding() > 0 ? 1 : 0;
    }
    EXPECT_GT(rounded, 100);
}

}  // namespace
}  // namespace wellmesh::io
