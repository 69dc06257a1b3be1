// SPDX-License-Identifier: Apache-2.0
// First step of validation: usable vertices, each once; usable facets, each once.
#pragma once

#include "validation/report.hpp"
#include "validation/rounding.hpp"
#include "validation/working_complex.hpp"

namespace wellmesh {

/// Reports coordinates that are not finite or outside the exact range and vertex numbers out of range (errors; what uses them is left
/// out), merges bit-identical vertices and copies of facets, and drops degenerate facets: exactly collinear vertices, and triangles that
/// are lower than rounding.contact(). Where a dropped needle (a, b, c) has b inside the edge ac, polygons with the edge ac get b
/// inserted, so that no gap of topology is left behind.
[[nodiscard]] CleanInput clean_input(const Plc& plc, const Rounding& rounding, Report& report);

/// Chains of vertices that lie inside edges: each edge of a polygon is replaced by its chain.
class EdgeChains {
public:
    explicit EdgeChains(std::span<const Vec3> points) : points_(points) {}
    /// Only if both parts are shorter than the edge, which makes every sequence of splits end.
    void split(VertexId a, VertexId b, VertexId inside);
    [[nodiscard]] bool empty() const { return inside_.empty(); }
    /// Appends the vertices strictly between a and b, from a to b, to `out`.
    void append_between(VertexId a, VertexId b, std::vector<VertexId>& out) const;
    /// True if the polygon changed. Polygons of two vertices become chains there and back.
    bool expand(std::vector<VertexId>& polygon) const;

private:
    std::span<const Vec3> points_;
    std::unordered_map<EdgeKey, VertexId> inside_;
};

}  // namespace wellmesh
