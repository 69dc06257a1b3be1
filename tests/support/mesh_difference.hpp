// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

#include <fmt/format.h>

#include "conforming/conforming_mesh.hpp"

namespace wellmesh::testing {

inline bool same_info(const VertexInfo& a, const VertexInfo& b) {
    return a.carrier == b.carrier && a.reason == b.reason && a.copied == b.copied && a.generation == b.generation && a.carrier_id == b.carrier_id &&
           a.parent == b.parent && a.ball == b.ball && a.insertion_length == b.insertion_length;
}

/// Where two meshes of one domain are not the same, ids and what later changes depend on included; empty: nowhere.
inline std::string difference(const ConformingMesh& a, const ConformingMesh& b) {
    const Triangulation::Frame mine = a.triangulation().frame(), theirs = b.triangulation().frame();
    if (mine.slots != theirs.slots || mine.vertices != theirs.vertices)
        return fmt::format("{} and {} slots, {} and {} vertices", mine.slots, theirs.slots, mine.vertices, theirs.vertices);
    if (mine.free != theirs.free) return "free slots";
    if (mine.last_located != theirs.last_located) return "where searches begin";
    if (a.vertex_count() != b.vertex_count() || a.vertex_slots() != b.vertex_slots()) return "numbers of vertices";
    if (a.broken_facets() != b.broken_facets() || a.has_broken() != b.has_broken()) return "what is broken";
    for (std::size_t i = 0; i < mine.slots; ++i) {
        const TetId t{i};
        if (a.tets().is_live(t) != b.tets().is_live(t)) return fmt::format("whether tetrahedron {} is there", i);
        if (!a.tets().is_live(t)) continue;
        if (a.tets().corners(t) != b.tets().corners(t) || a.tets().across_all(t) != b.tets().across_all(t)) return fmt::format("tetrahedron {}", i);
        if (a.cell(t) != b.cell(t)) return fmt::format("cell of {}", i);
        if (a.has_labels(t) != b.has_labels(t)) return fmt::format("whether {} has labels", i);
        if (a.has_labels(t) && (a.labels(t).facets != b.labels(t).facets || a.labels(t).segments != b.labels(t).segments)) return fmt::format("labels of {}", i);
    }
    for (std::size_t i = 0; i < mine.vertices; ++i) {
        const VertexId v{i};
        if (a.triangulation().tet_of(v) != b.triangulation().tet_of(v)) return fmt::format("tetrahedron at vertex {}", i);
        if (a.triangulation().is_inserted(v) && !(a.point(v) == b.point(v))) return fmt::format("place of vertex {}", i);
        if (!same_info(a.info(v), b.info(v))) return fmt::format("what is known of vertex {}", i);
    }
    for (std::size_t f = 0; f < a.plc().facets.size(); ++f)
        if (a.steiner_vertices_of(FacetId{f}) != b.steiner_vertices_of(FacetId{f}) || a.steiner_vertices_ever(FacetId{f}) != b.steiner_vertices_ever(FacetId{f}))
            return fmt::format("vertices on facet {}", f);
    for (std::size_t s = 0; s < a.plc().segments.size(); ++s)
        if (a.steiner_vertices_of(SegmentId{s}) != b.steiner_vertices_of(SegmentId{s})) return fmt::format("vertices on segment {}", s);
    return {};
}

}  // namespace wellmesh::testing
