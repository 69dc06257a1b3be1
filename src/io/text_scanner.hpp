// SPDX-License-Identifier: Apache-2.0
// Tokens of a text file with their line numbers. Views into the file's buffer; nothing is copied.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/source_file.hpp"

namespace wellmesh::io {

class TextScanner {
public:
    struct Syntax {
        bool hash_comments = true;          ///< '#' starts a comment that ends with the line
        bool commas_separate = false;       ///< a comma is a blank
        bool backslash_continues = false;   ///< a backslash at the end of a line joins it to the next one
    };

    /// @param source  must outlive the scanner. A UTF-8 byte order mark is passed over; LF, CR LF and CR end lines.
    TextScanner(const SourceFile& source, Syntax syntax);

    /// Next token on this or a later line; empty at the end of the file.
    std::string_view next();
    /// Next token on this line; empty at its end.
    std::string_view next_on_line();
    /// Whether no further token is on this line.
    bool at_end_of_line();
    /// The rest of this line as it stands (comments too), without blanks at either end; moves to its end.
    std::string_view rest_of_line();
    /// Moves to the end of this line.
    void skip_line();
    /// Moves past `n` bytes that are no text (binary data within the file). @pre n <= bytes_left(). Line numbers mean nothing from then on.
    void skip_bytes(std::size_t n) { cursor_ += n; }
    /// Whether only blanks and comments are left. Moves to the next token.
    bool at_end();

    [[nodiscard]] std::uint64_t line() const { return line_; }  ///< of the latest token, from 1
    [[nodiscard]] std::uint32_t line32() const;                 ///< the same, saturated
    [[nodiscard]] std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - cursor_); }
    [[nodiscard]] const SourceFile& source() const { return source_; }

    struct Place {
        const char* byte;
        std::uint64_t line;
    };
    [[nodiscard]] Place place() const { return {cursor_, line_}; }
    /// @pre `to` is a place of the same text.
    void move_to(Place to) {
        cursor_ = to.byte;
        line_ = to.line;
    }

    /// Scanners of the next stretches of the text, each of `bytes` or more, the last one perhaps fewer; all but the first begin with a line. No more than
    /// `most`.
    [[nodiscard]] std::vector<TextScanner> stretches(std::size_t bytes, std::size_t most) const;
    struct Lines {
        std::size_t with_tokens = 0;
        std::uint64_t ends = 0;
    };
    /// How many lines there are from here on. Doesn't move.
    [[nodiscard]] Lines count_lines() const;
    /// How many lines with tokens there are from `from` to here.
    [[nodiscard]] std::size_t count_lines_since(Place from) const;
    /// Makes a stretch end where a later one, or the whole text, does. @param line  where it begins
    void widen_to(const TextScanner& later, std::uint64_t line) {
        end_ = later.end_;
        line_ = line;
    }
    /// Is there no character left?
    [[nodiscard]] bool is_used_up() const { return cursor_ == end_; }

    /// Next token as a finite real. `what` completes "expected ...". @throws MeshError{bad_input}
    double real(const char* what) { return to_real(next(), what); }
    std::int64_t integer(const char* what) { return to_integer(next(), what); }
    std::int32_t integer32(const char* what);
    double to_real(std::string_view token, const char* what) const;
    std::int64_t to_integer(std::string_view token, const char* what) const;
    /// Integers printed as reals ("3.000") count; the range is that of 32 bits.
    std::int32_t to_reference(std::string_view token, const char* what) const;

    /// Next token as a number of entities that the rest of the file can hold at `least_bytes` each, separator included.
    /// So a count is safe to loop over and to reserve for. @throws MeshError{bad_input}
    std::size_t count(const char* what, std::size_t least_bytes) { return to_count(next(), what, least_bytes); }
    std::size_t to_count(std::string_view token, const char* what, std::size_t least_bytes) const;

    [[noreturn]] void fail(const std::string& message) const { fail_at_line(source_, line_, message); }
    /// "expected WHAT, found TOKEN", or that the line or file ends.
    [[noreturn]] void fail_expected(std::string_view token, const char* what) const;

private:
    enum class Class : std::uint8_t { token, blank, line_end, comment, backslash };
    [[nodiscard]] Class class_of(char c) const { return classes_[static_cast<unsigned char>(c)]; }
    void skip_blanks();  // stops at a token or at a line end
    void pass_line_end();

    const SourceFile& source_;
    std::array<Class, 256> classes_{};
    const char* cursor_;
    const char* end_;
    std::uint64_t line_ = 1;
};

}  // namespace wellmesh::io
