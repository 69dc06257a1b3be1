// SPDX-License-Identifier: Apache-2.0
#include "io/text_scanner.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "io/number_parsing.hpp"

namespace wellmesh::io {

TextScanner::TextScanner(const SourceFile& source, Syntax syntax)
    : source_(source), cursor_(source.bytes.data()), end_(source.bytes.data() + source.bytes.size()) {
    for (const char c : {' ', '\t', '\v', '\f'}) classes_[static_cast<unsigned char>(c)] = Class::blank;
    for (const char c : {'\n', '\r'}) classes_[static_cast<unsigned char>(c)] = Class::line_end;
    if (syntax.hash_comments) classes_[static_cast<unsigned char>('#')] = Class::comment;
    if (syntax.commas_separate) classes_[static_cast<unsigned char>(',')] = Class::blank;
    if (syntax.backslash_continues) classes_[static_cast<unsigned char>('\\')] = Class::backslash;
    if (source.bytes.starts_with("\xef\xbb\xbf")) cursor_ += 3;
}

void TextScanner::pass_line_end() {
    if (*cursor_ == '\r' && cursor_ + 1 != end_ && cursor_[1] == '\n') ++cursor_;
    ++cursor_;
    ++line_;
}

void TextScanner::skip_blanks() {
    while (cursor_ != end_) {
        switch (class_of(*cursor_)) {
            case Class::blank: ++cursor_; break;
            case Class::comment: skip_line(); return;
            case Class::backslash:
                if (cursor_ + 1 == end_ || class_of(cursor_[1]) != Class::line_end) return;
                ++cursor_;
                pass_line_end();
                break;
            case Class::token:
            case Class::line_end: return;
        }
    }
}

std::string_view TextScanner::next_on_line() {
    skip_blanks();
    const char* const first = cursor_;
    while (true) {
        while (cursor_ != end_ && class_of(*cursor_) == Class::token) ++cursor_;
        if (cursor_ == end_ || class_of(*cursor_) != Class::backslash) break;
        if (cursor_ + 1 != end_ && class_of(cursor_[1]) == Class::line_end) break;
        ++cursor_;
    }
    return {first, static_cast<std::size_t>(cursor_ - first)};
}

std::string_view TextScanner::next() {
    while (true) {
        const std::string_view token = next_on_line();
        if (!token.empty() || cursor_ == end_) return token;
        pass_line_end();
    }
}

bool TextScanner::at_end_of_line() {
    skip_blanks();
    return cursor_ == end_ || class_of(*cursor_) == Class::line_end;
}

bool TextScanner::at_end() {
    while (at_end_of_line()) {
        if (cursor_ == end_) return true;
        pass_line_end();
    }
    return false;
}

void TextScanner::skip_line() {
    while (cursor_ != end_ && class_of(*cursor_) != Class::line_end) ++cursor_;
}

std::string_view TextScanner::rest_of_line() {
    const char* first = cursor_;
    skip_line();
    const char* last = cursor_;
    while (first != last && class_of(*first) == Class::blank) ++first;
    while (first != last && class_of(last[-1]) == Class::blank) --last;
    return {first, static_cast<std::size_t>(last - first)};
}

std::vector<TextScanner> TextScanner::stretches(std::size_t bytes, std::size_t most) const {
    std::vector<TextScanner> out;
    for (const char* first = cursor_; first != end_ && out.size() < most;) {
        TextScanner& stretch = out.emplace_back(*this);
        stretch.cursor_ = first;
        // Only LF is looked for: CR LF stays together, and a text without any LF is one stretch.
        const std::string_view rest(first, static_cast<std::size_t>(end_ - first));
        const std::size_t last = bytes < rest.size() ? rest.find('\n', bytes) : std::string_view::npos;
        first = last == std::string_view::npos ? end_ : first + last + 1;
        stretch.end_ = first;
    }
    return out;
}

TextScanner::Lines TextScanner::count_lines() const {
    TextScanner ahead = *this;
    Lines lines;
    while (true) {
        if (!ahead.at_end_of_line()) {
            ++lines.with_tokens;
            ahead.skip_line();
        }
        if (ahead.cursor_ == ahead.end_) break;
        ahead.pass_line_end();
    }
    lines.ends = ahead.line_ - line_;
    return lines;
}

std::size_t TextScanner::count_lines_since(Place from) const {
    TextScanner until_here = *this;
    until_here.end_ = cursor_;
    until_here.move_to(from);
    return until_here.count_lines().with_tokens;
}

std::uint32_t TextScanner::line32() const {
    return static_cast<std::uint32_t>(std::min<std::uint64_t>(line_, std::numeric_limits<std::uint32_t>::max()));
}

void TextScanner::fail_expected(std::string_view token, const char* what) const {
    if (!token.empty()) fail(fmt::format("expected {}, found {}", what, quoted_token(token)));
    fail(fmt::format("expected {}, but the {} ends", what, cursor_ == end_ ? "file" : "line"));
}

double TextScanner::to_real(std::string_view token, const char* what) const {
    const ParsedReal parsed = parse_real(token);
    switch (parsed.fault) {
        case NumberFault::none: return parsed.value;
        case NumberFault::not_a_number: fail_expected(token, what);
        case NumberFault::not_finite: fail(fmt::format("{} is not finite; expected {}", quoted_token(token), what));
        case NumberFault::too_large: fail(fmt::format("{} is too large for a double; expected {}", quoted_token(token), what));
    }
    return 0;
}

std::int64_t TextScanner::to_integer(std::string_view token, const char* what) const {
    const auto parsed = parse_integer(token);
    if (!parsed) fail_expected(token, what);
    return *parsed;
}

std::int32_t TextScanner::integer32(const char* what) {
    return to_reference(next(), what);
}

std::int32_t TextScanner::to_reference(std::string_view token, const char* what) const {
    const auto parsed = parse_integral_real(token);
    if (!parsed) fail_expected(token, what);
    using Limits = std::numeric_limits<std::int32_t>;
    if (*parsed < Limits::min() || *parsed > Limits::max()) fail(fmt::format("{} doesn't fit 32 bits; expected {}", quoted_token(token), what));
    return static_cast<std::int32_t>(*parsed);
}

std::size_t TextScanner::to_count(std::string_view token, const char* what, std::size_t least_bytes) const {
    const std::int64_t count = to_integer(token, what);
    if (count < 0) fail(fmt::format("expected {}, found {}: it cannot be negative", what, quoted_token(token)));
    // The last entity needs no separator after it, hence the extra byte.
    const std::size_t possible = (bytes_left() + 1) / std::max<std::size_t>(least_bytes, 1);
    if (static_cast<std::uint64_t>(count) > possible)
        fail(fmt::format("{} is stated as {}, but the {} bytes that follow cannot hold more than {}", what, count, bytes_left(), possible));
    return static_cast<std::size_t>(count);
}

}  // namespace wellmesh::io
