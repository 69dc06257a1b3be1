// SPDX-License-Identifier: Apache-2.0
// A complex as .mesh, .msh or .vtp: faces, segments and points with their markers. Facets are single polygons (with_simple_facets()).
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/vtk_file.hpp"
#include "io/writers.hpp"

namespace wellmesh::io {
namespace {

/// The complex as a mesh without tetrahedra. Its parts are its markers: facets of a surface may be as many as its triangles.
TetMesh as_mesh(const Plc& plc) {
    TetMesh mesh;
    mesh.vertices = plc.vertices;
    mesh.vertex_markers = plc.vertex_markers;
    mesh.names = plc.names;
    mesh.names.of_dimension[3].clear();
    for (const PlcFacet& facet : plc.facets) {
        const auto& c = facet.polygons.front();
        if (c.size() != 3) continue;
        mesh.subfaces.push_back({c[0], c[1], c[2]});
        mesh.subface_markers.push_back(facet.marker);
    }
    mesh.subface_facets = mesh.subface_markers;
    for (const PlcSegment& segment : plc.segments) {
        mesh.subsegments.push_back(segment.vertices);
        mesh.subsegment_markers.push_back(segment.marker);
    }
    mesh.subsegment_segments = mesh.subsegment_markers;
    return mesh;
}

/// Cells of one kind of a .vtp.
struct PolyCells {
    template <class Corners>
    void add(const Corners& corners, std::int32_t marker) {
        for (const std::uint32_t v : corners) connectivity.push_back(v);
        offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
        markers.push_back(marker);
    }
    std::vector<std::int64_t> connectivity, offsets;
    std::vector<std::int32_t> markers;
};

}  // namespace

void write_medit_surface(const Plc& plc, OutputFile& out) {
    std::vector<std::uint32_t> required;
    for (const PlcFacet& facet : plc.facets)
        if (facet.polygons.front().size() == 1) required.push_back(facet.polygons.front()[0]);
    write_medit(as_mesh(plc), References::marker, required, out);
}

void write_msh_surface(const Plc& plc, int version, OutputFile& out) { (version == 41 ? write_msh41 : write_msh22)(as_mesh(plc), out); }

void write_vtp(const Plc& plc, OutputFile& out) {
    std::array<PolyCells, 3> cells;  // vertices, lines, polygons: the order of their cell data
    for (const PlcFacet& facet : plc.facets) {
        const auto& c = facet.polygons.front();
        cells[c.size() == 1 ? 0 : 2].add(c, facet.marker);
    }
    for (const PlcSegment& segment : plc.segments) cells[1].add(segment.vertices, segment.marker);
    std::vector<std::int32_t> markers;
    for (const PolyCells& kind : cells) markers.insert(markers.end(), kind.markers.begin(), kind.markers.end());
    Names names = plc.names;
    names.of_dimension[3].clear();
    VtkFile file("PolyData");
    file.begin(names, fmt::format("NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\"",
                                  plc.vertices.size(), cells[0].offsets.size(), cells[1].offsets.size(), cells[2].offsets.size()));
    file.points(plc.vertices);
    file.text("</Points>\n<PointData>\n");
    if (!plc.vertex_markers.empty()) file.array("marker", plc.vertex_markers);
    file.text("</PointData>\n");
    constexpr std::array<std::string_view, 3> kElements{"Verts", "Lines", "Polys"};
    for (std::size_t k = 0; k < cells.size(); ++k) {
        file.text(fmt::format("<{}>\n", kElements[k]));
        file.array("connectivity", cells[k].connectivity);
        file.array("offsets", cells[k].offsets);
        file.text(fmt::format("</{}>\n", kElements[k]));
    }
    file.text("<CellData Scalars=\"marker\">\n");
    file.array("marker", markers);
    file.text("</CellData>\n");
    file.finish(out);
}

}  // namespace wellmesh::io
