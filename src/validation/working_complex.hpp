// SPDX-License-Identifier: Apache-2.0
// The input while it is being checked: one soup of triangles over bit-distinct vertices that knows which facet each comes from.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/edge_key.hpp"
#include "core/ids.hpp"
#include "wellmesh/plc.hpp"

namespace wellmesh {

/// An input facet over bit-distinct vertices, without repeated vertices and without copies of itself.
struct CleanFacet {
    std::uint32_t source = 0;  ///< lowest number of the input facets that it stands for
    std::vector<std::vector<VertexId>> polygons;
    int winding = 1;           ///< copies that turn as it does minus copies that turn the other way
    bool single_triangle = false;  ///< the source stated one triangle
};

struct CleanInput {
    std::vector<Vec3> points;                  ///< bit-distinct, -0 is 0
    std::vector<std::uint32_t> source_vertex;  ///< lowest input number of each
    std::vector<VertexId> of_input;            ///< for each input vertex; invalid when its coordinates are unusable
    std::vector<CleanFacet> facets;
    std::vector<std::array<VertexId, 2>> wires;  ///< stated segments
    std::vector<std::int32_t> wire_markers;
    std::vector<VertexId> lone_vertices;         ///< polygons of one vertex that are a facet's only content
};

/// A triangle of an input facet.
struct SoupTriangle {
    std::array<VertexId, 3> v{};
    std::uint32_t facet = 0;  ///< index in CleanInput::facets
};

/// Triangles around each edge. Slot s of triangle t is the edge from v[s] to v[(s + 1) % 3]; a corner packs 3 t + s.
struct EdgeTable {
    std::vector<EdgeKey> keys;              ///< ascending
    std::vector<std::uint32_t> first;       ///< keys.size() + 1 offsets into `corners`
    std::vector<std::uint32_t> corners;     ///< ascending for each edge
    std::vector<std::uint32_t> edge_of;     ///< for each corner, its edge

    [[nodiscard]] std::span<const std::uint32_t> around(std::size_t edge) const {
        return {corners.data() + first[edge], corners.data() + first[edge + 1]};
    }
    [[nodiscard]] static constexpr std::size_t kNotFound() { return static_cast<std::size_t>(-1); }
    [[nodiscard]] std::size_t find(EdgeKey key) const;
};
[[nodiscard]] EdgeTable make_edge_table(std::span<const SoupTriangle> triangles);

/// Everything as simplices.
struct Soup {
    std::vector<SoupTriangle> triangles;
    /// Edges that stay segments whatever lies around them (polygons of several vertices, wires), with the marker of a wire or 0.
    std::unordered_map<EdgeKey, std::int32_t> hard_edges;
    std::vector<std::array<VertexId, 2>> wires;  ///< hard edges that belong to no triangle
};

/// Disjoint sets with path halving; the representative is the smallest member, so results do not depend on the order of unions.
class DisjointSets {
public:
    explicit DisjointSets(std::size_t n) : parent_(n) {
        for (std::size_t i = 0; i < n; ++i) parent_[i] = static_cast<std::uint32_t>(i);
    }
    [[nodiscard]] std::uint32_t find(std::uint32_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    bool unite(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        if (a == b) return false;
        if (b < a) std::swap(a, b);
        parent_[b] = a;
        return true;
    }

private:
    std::vector<std::uint32_t> parent_;
};

}  // namespace wellmesh
