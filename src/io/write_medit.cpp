// SPDX-License-Identifier: Apache-2.0
// MEDIT .mesh: Edges are the subsegments, Triangles the subfaces, Tetrahedra the domain (reference: region). References of the former and of vertices are
// numbers of the input's segments, facets and vertices, from 1 (0: not the input's), or their markers. Vertices on nothing are listed like all others; sections without entries are left out.
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "io/writers.hpp"

namespace wellmesh::io {
namespace {

template <std::size_t N>
void write_section(OutputFile& out, std::string_view keyword, const std::vector<std::array<std::uint32_t, N>>& elements,
                   const std::vector<std::int32_t>& references) {
    if (elements.empty()) return;
    out.text(keyword);
    out.character('\n');
    out.integer(static_cast<std::int64_t>(elements.size()));
    out.character('\n');
    out.rows(elements.size(), [&](auto& row, std::size_t i) {
        for (const std::uint32_t v : elements[i]) {
            row.integer(std::int64_t{v} + 1);
            row.character(' ');
        }
        row.integer(references[i]);
        row.character('\n');
    });
}

}  // namespace

void write_medit(const TetMesh& mesh, References references, const std::vector<std::uint32_t>& required, OutputFile& out) {
    const bool markers = references == References::marker;
    const auto vertex_reference = [&](std::size_t v) -> std::int64_t {
        if (markers || mesh.vertex_carriers.empty()) return mesh.vertex_markers.empty() ? 0 : mesh.vertex_markers[v];
        const VertexCarrier& carrier = mesh.vertex_carriers[v];
        return carrier.kind == CarrierKind::input_vertex ? std::int64_t{carrier.id} + 1 : 0;
    };
    out.text("MeshVersionFormatted 2\nDimension 3\nVertices\n");
    out.integer(static_cast<std::int64_t>(mesh.vertices.size()));
    out.character('\n');
    out.rows(mesh.vertices.size(), [&](auto& row, std::size_t v) {
        row.point(mesh.vertices[v]);
        row.character(' ');
        row.integer(vertex_reference(v));
        row.character('\n');
    });
    const std::vector<std::int32_t> unmarked(markers && mesh.subsegment_markers.empty() ? mesh.subsegments.size() : 0, 0);
    write_section(out, "Edges", mesh.subsegments, !markers ? mesh.subsegment_segments : mesh.subsegment_markers.empty() ? unmarked : mesh.subsegment_markers);
    write_section(out, "Triangles", mesh.subfaces, markers ? mesh.subface_markers : mesh.subface_facets);
    write_section(out, "Tetrahedra", mesh.tets, mesh.tet_regions);
    if (!required.empty()) {
        out.text(fmt::format("RequiredVertices\n{}\n", required.size()));
        for (const std::uint32_t v : required) {
            out.integer(std::int64_t{v} + 1);
            out.character('\n');
        }
    }
    out.text("End\n");
}

void write_medit_weights(const std::vector<double>& weights, OutputFile& out) {
    out.text("MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n");
    out.integer(static_cast<std::int64_t>(weights.size()));
    out.text("\n1 1\n");  // one field, a scalar
    out.rows(weights.size(), [&](auto& row, std::size_t v) {
        row.real(weights[v]);
        row.character('\n');
    });
    out.text("End\n");
}

}  // namespace wellmesh::io
