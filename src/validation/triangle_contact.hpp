// SPDX-License-Identifier: Apache-2.0
// Do two simplices share a point that is not a common vertex or edge? Exact answers, rounded witnesses.
#pragma once

#include <array>
#include <optional>

#include "wellmesh/predicates.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh {

/// A triangle with names for its corners: equal names are the same vertex. @pre not degenerate.
struct NamedTriangle {
    std::array<Vec3, 3> p{};
    std::array<std::uint32_t, 3> name{};
};
struct NamedSegment {
    std::array<Vec3, 2> p{};
    std::array<std::uint32_t, 2> name{};
};

/// A point (rounded) in which the closed triangles meet outside of their common vertex or edge; empty iff there is none. Triangles
/// folded onto each other about a common edge meet in their interiors.
[[nodiscard]] std::optional<Vec3> contact(const NamedTriangle& s, const NamedTriangle& t);
[[nodiscard]] std::optional<Vec3> contact(const NamedSegment& s, const NamedTriangle& t);
[[nodiscard]] std::optional<Vec3> contact(const NamedSegment& s, const NamedSegment& t);

/// Of triangles that meet according to contact(): the ends of their common part, or two points of it that are far apart where it is an area. Which points
/// are tried is decided exactly, their coordinates are rounded; equal ends: one point.
[[nodiscard]] std::array<Vec3, 2> contact_ends(const NamedTriangle& s, const NamedTriangle& t);

/// Is p on the closed triangle or segment? Exact.
[[nodiscard]] bool is_on(const Vec3& p, const std::array<Vec3, 3>& triangle);
[[nodiscard]] bool is_on(const Vec3& p, const std::array<Vec3, 2>& segment);

}  // namespace wellmesh
