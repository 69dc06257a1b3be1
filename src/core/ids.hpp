// SPDX-License-Identifier: Apache-2.0
// 32-bit ids that do not mix: a TetId where a VertexId is wanted does not compile.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>

namespace wellmesh {

template <class Tag>
class Id {
public:
    constexpr Id() = default;
    constexpr explicit Id(std::uint32_t value) : value_(value) {}
    constexpr explicit Id(std::size_t value) : value_(static_cast<std::uint32_t>(value)) {}
    constexpr explicit Id(int value) : value_(static_cast<std::uint32_t>(value)) {}
    [[nodiscard]] constexpr std::uint32_t value() const { return value_; }
    [[nodiscard]] constexpr std::size_t index() const { return value_; }
    [[nodiscard]] constexpr bool valid() const { return value_ != kNone; }
    friend constexpr auto operator<=>(Id, Id) = default;

private:
    static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    std::uint32_t value_ = kNone;  // a default-made id is invalid
};

using VertexId = Id<struct VertexTag>;    ///< vertex of a mesh or of a validated PLC (the latter come first in the former)
using TetId = Id<struct TetTag>;
using SegmentId = Id<struct SegmentTag>;  ///< input 1-cell
using FacetId = Id<struct FacetTag>;      ///< input 2-cell, after coplanar neighbours were merged
using CellId = Id<struct CellTag>;        ///< input 3-cell: a cell of the arrangement of the facets

}  // namespace wellmesh

template <class Tag>
struct std::hash<wellmesh::Id<Tag>> {
    std::size_t operator()(wellmesh::Id<Tag> id) const noexcept { return id.index(); }
};
