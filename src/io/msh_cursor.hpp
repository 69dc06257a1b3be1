// SPDX-License-Identifier: Apache-2.0
// Numbers of a Gmsh file, which stand there as text or as bytes.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "io/byte_order.hpp"
#include "io/number_parsing.hpp"
#include "io/text_precision.hpp"
#include "io/text_rows.hpp"
#include "io/text_scanner.hpp"

namespace wellmesh::io {

inline constexpr TextScanner::Syntax kMshSyntax{.hash_comments = false};

class MshCursor {
public:
    /// @param in  of syntax kMshSyntax; must outlive this.
    explicit MshCursor(TextScanner& in) : in_(in) {}

    [[nodiscard]] TextScanner& text() { return in_; }
    [[nodiscard]] const SourceFile& source() const { return in_.source(); }
    [[nodiscard]] std::uint32_t line32() const { return in_.line32(); }

    /// From here on numbers are bytes, until text() comes again.
    void set_binary(std::endian order) {
        binary_ = true;
        order_ = order;
    }
    [[nodiscard]] bool binary() const { return binary_; }

    /// Passes the end of the line after which binary data begin. In text there is nothing to do.
    void begin_data() {
        if (!binary_) return;
        if (!in_.at_end_of_line()) fail("expected the line to end before binary data");
        if (in_.bytes_left() > 0 && source().bytes[offset()] == '\r') in_.skip_bytes(1);
        if (in_.bytes_left() > 0 && source().bytes[offset()] == '\n') in_.skip_bytes(1);
    }

    std::int64_t integer(const char* what) { return binary_ ? std::int64_t{bytes<std::int32_t>(what)} : in_.integer(what); }
    std::int64_t size(const char* what) {
        if (!binary_) return in_.integer(what);
        return static_cast<std::int64_t>(bytes<std::uint64_t>(what));
    }
    double real(const char* what) {
        if (!binary_) return in_.real(what);
        return checked(bytes<double>(what), what);
    }
    /// As real(), but notes how precise it is.
    double coordinate(TextPrecision& precision) {
        if (binary_) {
            const double value = checked(bytes<double>("a coordinate"), "a coordinate");
            precision.note(value);
            return value;
        }
        const std::string_view token = in_.next();
        const double value = in_.to_real(token, "a coordinate");
        precision.note(token, value);
        return value;
    }
    /// A number of entities that the rest of the file can hold. @param text_bytes, binary_bytes  of the shortest entity
    std::size_t count(std::int64_t value, const char* what, std::size_t text_bytes, std::size_t binary_bytes) const {
        const std::size_t most = binary_ ? in_.bytes_left() / binary_bytes : (in_.bytes_left() + 1) / text_bytes;
        if (value < 0 || static_cast<std::uint64_t>(value) > most)
            fail(fmt::format("{} is stated as {}, but the {} bytes that follow cannot hold more than {}", what, value, in_.bytes_left(), most));
        return static_cast<std::size_t>(value);
    }

    /// Reads `n` rows, of text several at once: io::read_rows(), but read() gets a cursor.
    template <class Tally, class MakeRoom, class Read>
    void read_rows(std::size_t n, Tally& tally, const MakeRoom& make_room, const Read& read) {
        if (!binary_)
            return io::read_rows(in_, n, tally, make_room, [&](TextScanner& part, std::size_t i, Tally& part_tally) {
                MshCursor in(part);
                read(in, i, part_tally);
            });
        constexpr std::size_t kRoom = 1024;
        for (std::size_t i = 0; i < n; ++i) {
            if (i % kRoom == 0) make_room(std::min(n, i + kRoom));
            read(*this, i, tally);
        }
    }

    [[noreturn]] void fail(const std::string& message) const {
        if (binary_) fail_at_byte(source(), offset(), message);
        in_.fail(message);
    }

private:
    [[nodiscard]] std::size_t offset() const { return source().bytes.size() - in_.bytes_left(); }

    template <class T>
    T bytes(const char* what) {
        if (in_.bytes_left() < sizeof(T)) fail(fmt::format("expected {}, but the file ends", what));
        const T value = load<T>(source().bytes, offset(), order_);
        in_.skip_bytes(sizeof(T));
        return value;
    }
    double checked(double value, const char* what) const {
        if (!(value - value == 0)) fail(fmt::format("{} is not finite; expected {}", value, what));
        return value;
    }

    TextScanner& in_;
    bool binary_ = false;
    std::endian order_ = std::endian::native;
};

}  // namespace wellmesh::io
