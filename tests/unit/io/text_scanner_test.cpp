// SPDX-License-Identifier: Apache-2.0
#include "io/text_scanner.hpp"

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "sample_files.hpp"

namespace wellmesh::io {
namespace {

using testing::expect_error;
using testing::source_of;
using Token = std::pair<std::string, std::uint64_t>;

std::vector<Token> tokens(const std::string& text, TextScanner::Syntax syntax = {}) {
    const SourceFile source = source_of(text);
    TextScanner in(source, syntax);
    std::vector<Token> out;
    for (std::string_view t = in.next(); !t.empty(); t = in.next()) out.emplace_back(std::string(t), in.line());
    return out;
}

TEST(TextScanner, CountsLinesOfEveryKind) {
    const std::vector<Token> expected{{"a", 1}, {"b", 1}, {"c", 2}, {"d", 4}};
    EXPECT_EQ(tokens("a b\nc\n\nd"), expected);
    EXPECT_EQ(tokens("a b\r\nc\r\n\r\nd\r\n"), expected);
    EXPECT_EQ(tokens("a b\rc\r\rd\r"), expected);
    EXPECT_EQ(tokens("\xef\xbb\xbf a\tb # x y\nc# z\n#\n\v\fd"), expected);
}

TEST(TextScanner, CommasAndContinuationsOnlyWhereAskedFor) {
    EXPECT_EQ(tokens("1,2"), (std::vector<Token>{{"1,2", 1}}));
    EXPECT_EQ(tokens("1,2", {.commas_separate = true}), (std::vector<Token>{{"1", 1}, {"2", 1}}));
    EXPECT_EQ(tokens("#1 2", {.hash_comments = false}), (std::vector<Token>{{"#1", 1}, {"2", 1}}));
    const SourceFile source = source_of("f 1 \\\r\n 2\\\n3\nf\\x \\");
    TextScanner in(source, {.backslash_continues = true});
    for (const char* const expected : {"f", "1", "2", "3"}) EXPECT_EQ(in.next_on_line(), expected);
    EXPECT_TRUE(in.next_on_line().empty());
    EXPECT_EQ(in.line(), 3U);
    EXPECT_EQ(in.next(), "f\\x");
    EXPECT_EQ(in.next(), "\\");
    EXPECT_TRUE(in.next().empty());
}

TEST(TextScanner, KnowsWhereLinesAndTheFileEnd) {
    const SourceFile source = source_of("a  rest # of it \nb #c\n \n# d");
    TextScanner in(source, {});
    EXPECT_EQ(in.next(), "a");
    EXPECT_FALSE(in.at_end_of_line());
    EXPECT_EQ(in.rest_of_line(), "rest # of it");
    EXPECT_TRUE(in.at_end_of_line());
    EXPECT_TRUE(in.next_on_line().empty());
    EXPECT_FALSE(in.at_end());
    EXPECT_EQ(in.next_on_line(), "b");
    EXPECT_TRUE(in.at_end());
    EXPECT_TRUE(in.next().empty());
}

TEST(TextScanner, ErrorsNameFileLineAndToken) {
    const SourceFile source = source_of("1\n\n  zwei\n", "some.off");
    TextScanner in(source, {});
    EXPECT_EQ(in.real("x"), 1);
    expect_error(ErrorCode::bad_input, {"some.off:3:", "'zwei'", "a coordinate"}, [&] { in.real("a coordinate"); });
    expect_error(ErrorCode::bad_input, {"some.off:4:", "a coordinate", "file ends"}, [&] { in.real("a coordinate"); });
}

TEST(TextScanner, QuotesBinaryAndLongTokensSafely) {
    EXPECT_EQ(quoted_token(std::string("a\0\xff", 3)), "'a\\x00\\xff'");
    EXPECT_LT(quoted_token(std::string(100000, 'x')).size(), 60U);
}

TEST(TextScanner, CountsAreBoundedByTheBytesThatFollow) {
    const SourceFile fits = source_of("3\n1\n2\n3"), too_many = source_of("4\n1\n2\n3"), negative = source_of("-1"),
                     huge = source_of("99999999999999999999");
    EXPECT_EQ(TextScanner(fits, {}).count("the number of things", 2), 3U);
    for (const SourceFile* const source : {&too_many, &negative, &huge})
        expect_error(ErrorCode::bad_input, {":1:", "the number of things"}, [&] { TextScanner(*source, {}).count("the number of things", 2); });
}

TEST(TextScanner, ReferencesFitThirtyTwoBits) {
    const SourceFile source = source_of("-2147483648 2147483647.0 2147483648 1.5");
    TextScanner in(source, {});
    EXPECT_EQ(in.integer32("r"), INT32_MIN);
    EXPECT_EQ(in.integer32("r"), INT32_MAX);
    expect_error(ErrorCode::bad_input, {"32 bits"}, [&] { in.integer32("r"); });
    expect_error(ErrorCode::bad_input, {"1.5"}, [&] { in.integer32("r"); });
}

TEST(TextScanner, StretchesAreTheText) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        std::string text = "0";
        for (int i = 1; i < 400; ++i) text += i % 7 == 0 ? end + " # none" + end + end : i % 3 == 0 ? end + std::to_string(i) : " " + std::to_string(i);
        const SourceFile source = source_of(text);
        std::vector<std::string> expected;
        for (const Token& token : tokens(text)) expected.push_back(token.first);
        for (const std::size_t bytes : {1U, 10U, 300U, 100000U}) {
            std::vector<std::string> found;
            std::uint64_t ends = 0;
            std::size_t lines = 0;
            for (TextScanner& stretch : TextScanner(source, {}).stretches(bytes, 100000)) {
                const TextScanner::Lines counted = stretch.count_lines();
                const std::uint64_t first = stretch.line();
                std::uint64_t line = 0;
                for (std::string_view t = stretch.next(); !t.empty(); t = stretch.next()) {
                    found.emplace_back(t);
                    lines += stretch.line() != line ? 1U : 0U;
                    line = stretch.line();
                }
                EXPECT_EQ(stretch.line(), first + counted.ends);
                ends += counted.ends;
                lines -= counted.with_tokens;
            }
            EXPECT_EQ(found, expected);
            EXPECT_EQ(ends, TextScanner(source, {}).count_lines().ends);
            EXPECT_EQ(lines, 0U);  // as many as there were counted
        }
        EXPECT_EQ(TextScanner(source, {}).stretches(10, 3).size(), end == "\r" ? 1U : 3U);
    }
}

}  // namespace
}  // namespace wellmesh::io
