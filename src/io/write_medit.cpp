// SPDX-License-Identifier: Apache-2.0
// MEDIT .mesh: Edges are the subsegments (reference: number of the input segment, from 1), Triangles the subfaces (input facet),
// Tetrahedra the domain (region). Vertices on nothing are listed like all others; sections without entries are left out.
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

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
    for (std::size_t i = 0; i < elements.size(); ++i) {
        for (const std::uint32_t v : elements[i]) {
            out.integer(std::int64_t{v} + 1);
            out.character(' ');
        }
        out.integer(references[i]);
        out.character('\n');
    }
}

}  // namespace

void write_medit(const TetMesh& mesh, OutputFile& out) {
    out.text("MeshVersionFormatted 2\nDimension 3\nVertices\n");
    out.integer(static_cast<std::int64_t>(mesh.vertices.size()));
    out.character('\n');
    for (const Vec3& p : mesh.vertices) {
        out.real(p.x);
        out.character(' ');
        out.real(p.y);
        out.character(' ');
        out.real(p.z);
        out.text(" 0\n");
    }
    write_section(out, "Edges", mesh.subsegments, mesh.subsegment_segments);
    write_section(out, "Triangles", mesh.subfaces, mesh.subface_facets);
    write_section(out, "Tetrahedra", mesh.tets, mesh.tet_regions);
    out.text("End\n");
}

void write_medit_weights(const std::vector<double>& weights, OutputFile& out) {
    out.text("MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n");
    out.integer(static_cast<std::int64_t>(weights.size()));
    out.text("\n1 1\n");  // one field, a scalar
    for (const double w : weights) {
        out.real(w);
        out.character('\n');
    }
    out.text("End\n");
}

}  // namespace wellmesh::io
