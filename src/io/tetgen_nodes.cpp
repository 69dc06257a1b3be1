// SPDX-License-Identifier: Apache-2.0
#include "io/tetgen_nodes.hpp"

#include <fmt/format.h>

#include "io/number_parsing.hpp"
#include "io/plc_building.hpp"
#include "io/text_rows.hpp"

namespace wellmesh::io {

NodeList read_node_list(TextScanner& in, TextPrecision& precision) {
    constexpr std::size_t kLeastPointBytes = 8;  // "1 0 0 0\n"
    NodeList nodes;
    const std::size_t points = in.count("the number of points", kLeastPointBytes);
    if (points > kMostVertices) in.fail(fmt::format("{} points are more than 32-bit numbers hold", points));
    std::int64_t dimension = 3, attributes = 0, markers = 0;
    if (!in.at_end_of_line()) dimension = in.to_integer(in.next_on_line(), "the dimension");
    if (dimension != 3) in.fail(fmt::format("the dimension is {}, only 3 is supported", dimension));
    if (!in.at_end_of_line()) attributes = in.to_integer(in.next_on_line(), "the number of attributes");
    if (attributes < 0) in.fail("the number of attributes cannot be negative");
    if (!in.at_end_of_line()) markers = in.to_integer(in.next_on_line(), "the number of boundary markers (0 or 1)");
    if (markers != 0 && markers != 1) in.fail(fmt::format("the number of boundary markers is 0 or 1, not {}", markers));
    if (!in.at_end_of_line()) in.fail_expected(in.next_on_line(), "the end of the line after the counts");

    nodes.points.reserve(points);
    nodes.numbers.reserve(points);
    nodes.lines.reserve(points);
    const auto make_room = [&](std::size_t rows) {
        nodes.points.resize(rows);
        nodes.numbers.resize(rows);
        nodes.lines.resize(rows);
        if (attributes > 0) nodes.first_attributes.resize(rows);
        if (markers == 1) nodes.markers.resize(rows);
    };
    read_rows(in, points, precision, make_room, [&](TextScanner& row, std::size_t i, TextPrecision& noted) {
        nodes.numbers[i] = vertex_number(row, row.next());
        nodes.lines[i] = row.line32();
        Vec3& point = nodes.points[i];
        for (double* const coordinate : {&point.x, &point.y, &point.z}) {
            const std::string_view token = row.next_on_line();
            *coordinate = row.to_real(token, "a coordinate");
            noted.note(token, *coordinate);
        }
        for (std::int64_t a = 0; a < attributes; ++a) {
            const double attribute = row.to_real(row.next_on_line(), "an attribute");
            if (a == 0) nodes.first_attributes[i] = attribute;
        }
        if (markers == 1) nodes.markers[i] = row.to_reference(row.next_on_line(), "a boundary marker");
        row.skip_line();
    });
    return nodes;
}

std::uint32_t vertex_number(const TextScanner& in, std::string_view token) {
    const std::int64_t number = in.to_integer(token, "a vertex number");
    if (number < 0 || number > static_cast<std::int64_t>(kMostVertices)) in.fail(fmt::format("vertex number {} is out of range", number));
    return static_cast<std::uint32_t>(number);
}

NodeNumbering::NodeNumbering(const NodeList& nodes) : size_(nodes.numbers.size()) {
    if (size_ == 0) return;
    first_ = nodes.numbers.front();
    for (std::size_t i = 0; i < size_ && sequential_; ++i)
        if (nodes.numbers[i] != first_ + static_cast<std::uint64_t>(i)) {
            sequential_ = false;
            irregular_line_ = nodes.lines[i];
        }
    if (sequential_) return;
    index_of_.reserve(size_);
    for (std::size_t i = 0; i < size_; ++i)
        if (!index_of_.try_emplace(nodes.numbers[i], static_cast<std::uint32_t>(i)).second) repeats_ = true;
}

std::optional<std::uint32_t> NodeNumbering::as_stated(std::uint32_t number) const {
    if (sequential_) {
        if (number < first_ || number - first_ >= size_) return std::nullopt;
        return number - first_;
    }
    const auto at = index_of_.find(number);
    if (repeats_ || at == index_of_.end()) return std::nullopt;
    return at->second;
}

std::optional<std::uint32_t> NodeNumbering::as_counted(std::uint32_t number) const {
    if (first_ > 1 || number < first_ || number - first_ >= size_) return std::nullopt;
    return number - first_;
}

}  // namespace wellmesh::io
