// SPDX-License-Identifier: Apache-2.0
// TetGen's node list (.node, part 1 of .poly and .smesh) and its numbering.
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "io/text_precision.hpp"
#include "io/text_scanner.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh::io {

struct NodeList {
    std::vector<Vec3> points;
    std::vector<std::uint32_t> numbers;  ///< the list's own
    std::vector<std::int32_t> markers;   ///< empty unless the header states that there are some
    std::vector<std::uint32_t> lines;
    std::vector<double> first_attributes;  ///< empty unless the header states that there are some
};

/// Syntax of all of TetGen's files.
inline constexpr TextScanner::Syntax kTetgenSyntax{.hash_comments = true, .commas_separate = true, .backslash_continues = false};

/// Reads "points dimension [attributes [markers]]" and the points. Attributes after the first are checked, not kept. Columns after those that the
/// header states are passed over, as TetGen does.
NodeList read_node_list(TextScanner& in, TextPrecision& precision);

/// A vertex number of the file. @throws MeshError{bad_input} unless it is an integer that 32 bits hold.
std::uint32_t vertex_number(const TextScanner& in, std::string_view token);

/// Turns numbers of the file into indices from 0.
///
/// Numbers that go up by one from any first number mean what they say, and so do others that are all different. TetGen ignores
/// the numbers of a list after the first and counts on from it; some files rely on that (they number two layers 1-6 and 1-6
/// and use 7-12). So a list that starts at 0 or 1 with a repeated number, or one that lacks a number that is used, is counted
/// that way; if that leaves a used number out of range too, the file is wrong.
class NodeNumbering {
public:
    explicit NodeNumbering(const NodeList& nodes);

    /// Whether indices are known at once: number - first().
    [[nodiscard]] bool sequential() const { return sequential_; }
    [[nodiscard]] std::uint32_t first() const { return first_; }
    /// Message base (Plc::first_number).
    [[nodiscard]] std::uint32_t first_number() const { return first_ == 0 ? 0 : 1; }

    /// Index of `number` as the list states it; empty: none.
    [[nodiscard]] std::optional<std::uint32_t> as_stated(std::uint32_t number) const;
    /// Index of `number` when the list is counted from its first number; empty: none, or such counting isn't allowed.
    [[nodiscard]] std::optional<std::uint32_t> as_counted(std::uint32_t number) const;
    [[nodiscard]] bool repeats() const { return repeats_; }
    [[nodiscard]] std::uint32_t irregular_line() const { return irregular_line_; }  ///< first that isn't one more than the last
    [[nodiscard]] std::size_t size() const { return size_; }

private:
    std::uint32_t first_ = 0, irregular_line_ = 0;
    std::size_t size_ = 0;
    bool sequential_ = true, repeats_ = false;
    std::unordered_map<std::uint32_t, std::uint32_t> index_of_;  // only looked up; empty if sequential
};

}  // namespace wellmesh::io
