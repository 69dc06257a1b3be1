// SPDX-License-Identifier: Apache-2.0
// TetGen's .node (weights, if there are any, as the attribute, and vertex markers, if there are any), .ele (region as the attribute), .face and .edge (boundary markers), counted
// from 1. All four are always written, so
// that no file of an older mesh stays beside. The marker of a face is the input's marker of its facet; of an input without markers
// (all zero), the facet's number. The same for edges and segments.
#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "io/writers.hpp"

namespace wellmesh::io {
namespace {

template <std::size_t N>
void write_rows(OutputFile& out, std::string_view columns, const std::vector<std::array<std::uint32_t, N>>& elements,
                const std::vector<std::int32_t>& references) {
    out.integer(static_cast<std::int64_t>(elements.size()));
    out.text(columns);
    out.rows(elements.size(), [&](auto& row, std::size_t i) {
        row.integer(static_cast<std::int64_t>(i) + 1);
        for (const std::uint32_t v : elements[i]) {
            row.character(' ');
            row.integer(std::int64_t{v} + 1);
        }
        row.character(' ');
        row.integer(references[i]);
        row.character('\n');
    });
}

}  // namespace

void write_tetgen(const TetMesh& mesh, const std::filesystem::path& path, OutputSet& files) {
    const auto add = [&](const char* extension) -> OutputFile& { return files.add(std::filesystem::path(path).replace_extension(extension)); };
    OutputFile& nodes = add(".node");
    nodes.integer(static_cast<std::int64_t>(mesh.vertices.size()));
    nodes.text(mesh.weights.empty() ? " 3 0" : " 3 1");
    nodes.text(mesh.vertex_markers.empty() ? " 0\n" : " 1\n");
    nodes.rows(mesh.vertices.size(), [&](auto& row, std::size_t v) {
        row.integer(static_cast<std::int64_t>(v) + 1);
        for (const double coordinate : {mesh.vertices[v].x, mesh.vertices[v].y, mesh.vertices[v].z}) {
            row.character(' ');
            row.real(coordinate);
        }
        if (!mesh.weights.empty()) {
            row.character(' ');
            row.real(mesh.weights[v]);
        }
        if (!mesh.vertex_markers.empty()) {
            row.character(' ');
            row.integer(mesh.vertex_markers[v]);
        }
        row.character('\n');
    });
    write_rows(add(".ele"), " 4 1\n", mesh.tets, mesh.tet_regions);
    const auto any = [](const std::vector<std::int32_t>& markers) { return std::any_of(markers.begin(), markers.end(), [](std::int32_t m) { return m != 0; }); };
    write_rows(add(".face"), " 1\n", mesh.subfaces, any(mesh.subface_markers) ? mesh.subface_markers : mesh.subface_facets);
    write_rows(add(".edge"), " 1\n", mesh.subsegments, any(mesh.subsegment_markers) ? mesh.subsegment_markers : mesh.subsegment_segments);
}

}  // namespace wellmesh::io
