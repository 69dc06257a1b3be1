// SPDX-License-Identifier: Apache-2.0
// The edges from one vertex to higher ones, each once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "certify/suspect_mesh.hpp"

namespace wellmesh::certifying {

/// What a tetrahedron counts as in statistics.
enum class TetClass : std::uint8_t { left_out, interior, boundary };

class UpperEdges {
public:
    struct End {
        std::uint32_t vertex;
        bool interior, boundary;  ///< an end of an edge of such a tetrahedron
    };

    explicit UpperEdges(std::size_t vertices) : marks_(vertices, {kNone, 0}) {}

    /// @param vertex  the lower end; not the same as any before. @param tets  at least as many as those whose corners are going to be visited.
    void start(std::uint32_t vertex, std::size_t tets) {
        vertex_ = vertex;
        count_ = 0;
        ends_.resize(std::max(ends_.size(), 3 * tets + 1));
    }
    /// An upper end of an edge of a tetrahedron of this class. @return its place in ends().
    std::uint32_t visit(std::uint32_t upper, bool interior) {  // whether an edge is new can't be foreseen, so there is no branch
        Mark& mark = marks_[upper];
        const bool is_new = mark.by != vertex_;
        mark = {vertex_, is_new ? count_ : mark.place};
        End& end = ends_[mark.place];
        end = {upper, static_cast<bool>((end.interior & !is_new) | interior), static_cast<bool>((end.boundary & !is_new) | !interior)};
        count_ += is_new;
        return mark.place;
    }
    [[nodiscard]] std::span<const End> ends() const { return {ends_.data(), count_}; }  ///< in order of appearance
    /// kNone: not visited.
    [[nodiscard]] std::uint32_t place_of(std::uint32_t upper) const { return marks_[upper].by == vertex_ ? marks_[upper].place : kNone; }

private:
    struct Mark {
        std::uint32_t by, place;  // the lower end that was last to find the vertex, and where in ends_
    };
    std::uint32_t vertex_ = 0, count_ = 0;
    std::vector<End> ends_;
    std::vector<Mark> marks_;
};

}  // namespace wellmesh::certifying
