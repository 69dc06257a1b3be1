// SPDX-License-Identifier: Apache-2.0
// VTK XML unstructured grids: NAME.vtu holds the tetrahedra with region and shape and the points with what they lie on, NAME.boundary.vtu the pieces
// of facets and segments. They are two files because viewers would show a triangle and the face of a tetrahedron in one place.
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/vtk_file.hpp"
#include "io/writers.hpp"
#include "quality/tet_shape.hpp"

namespace wellmesh::io {
namespace {

/// A measure of each tetrahedron, for display: rounded; a flat one has angle 0 and an infinite ratio.
template <class Measure>
void add_measure(VtkFile& file, std::string_view name, const TetMesh& mesh, Measure measure) {
    file.array<double>(name, mesh.tets.size(), [&mesh, measure](OutputFile& out) {
        out.rows(mesh.tets.size(), [&](auto& row, std::size_t t) {
            const auto& [a, b, c, d] = mesh.tets[t];
            const double value = measure(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], mesh.vertices[d]);
            row.bytes(&value, sizeof value);
        });
    });
}

/// What each vertex lies on: dimension, and number from 1 (of a region its id).
void add_carriers(VtkFile& file, const TetMesh& mesh) {
    if (mesh.vertex_carriers.size() != mesh.vertices.size() || mesh.vertices.empty()) return;
    std::vector<std::int8_t> dimensions;
    std::vector<std::int32_t> numbers;
    for (const VertexCarrier& carrier : mesh.vertex_carriers) {
        dimensions.push_back(static_cast<std::int8_t>(carrier.kind));
        numbers.push_back(static_cast<std::int32_t>(carrier.kind == CarrierKind::region ? carrier.id : carrier.id + 1));
    }
    file.array("carrier_dimension", std::move(dimensions));
    file.array("carrier", std::move(numbers));
}

void write_volume(const TetMesh& mesh, OutputFile& out) {
    const std::size_t tets = mesh.tets.size();
    VtkFile file("UnstructuredGrid");
    file.begin(mesh.names, fmt::format("NumberOfPoints=\"{}\" NumberOfCells=\"{}\"", mesh.vertices.size(), tets));
    file.points(mesh.vertices);
    file.text("</Points>\n<PointData>\n");
    if (!mesh.weights.empty()) file.array("weight", mesh.weights);
    if (!mesh.vertex_markers.empty()) file.array("marker", mesh.vertex_markers);
    add_carriers(file, mesh);
    file.text("</PointData>\n<Cells>\n");
    file.array<std::int64_t>("connectivity", 4 * tets, [&mesh](OutputFile& o) {
        for (const auto& tet : mesh.tets) {
            const std::array<std::int64_t, 4> wide{tet[0], tet[1], tet[2], tet[3]};
            o.bytes(wide.data(), sizeof wide);
        }
    });
    file.array<std::int64_t>("offsets", tets, [tets](OutputFile& o) {
        for (std::size_t t = 1; t <= tets; ++t) {
            const auto end = static_cast<std::int64_t>(4 * t);
            o.bytes(&end, sizeof end);
        }
    });
    file.array("types", std::vector<std::uint8_t>(tets, kVtkTetra));
    file.text("</Cells>\n<CellData Scalars=\"region\">\n");
    file.array("region", mesh.tet_regions);
    add_measure(file, "min_dihedral_angle_deg", mesh,
                [](const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& t) { return min_dihedral_deg(p, q, r, t); });
    add_measure(file, "radius_edge_ratio", mesh,
                [](const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& t) { return std::sqrt(radius_edge_squared(p, q, r, t)); });
    file.text("</CellData>\n");
    file.finish(out);
}

/// Cells of all dimensions below 3, over the vertices that they use.
struct BoundaryCells {
    explicit BoundaryCells(const TetMesh& mesh) : number(mesh.vertices.size(), kUnused) {
        const auto marker = [](const std::vector<std::int32_t>& all, std::size_t i) { return all.empty() ? 0 : all[i]; };
        for (std::size_t i = 0; i < mesh.subfaces.size(); ++i) add(kVtkTriangle, mesh.subfaces[i], mesh.subface_markers[i], mesh.subface_facets[i]);
        for (std::size_t i = 0; i < mesh.subsegments.size(); ++i)
            add(kVtkLine, mesh.subsegments[i], marker(mesh.subsegment_markers, i), mesh.subsegment_segments[i]);
        for (std::size_t v = 0; v < mesh.vertex_markers.size(); ++v)
            if (mesh.vertex_markers[v] != 0)
                add(kVtkVertex, std::array{static_cast<std::uint32_t>(v)}, mesh.vertex_markers[v], static_cast<std::int32_t>(v) + 1);
        for (std::size_t v = 0; v < number.size(); ++v) {
            if (number[v] == kUnused) continue;
            number[v] = static_cast<std::int64_t>(vertices.size());
            vertices.push_back(static_cast<std::int64_t>(v));
            points.push_back(mesh.vertices[v]);
        }
        for (std::int64_t& v : connectivity) v = number[static_cast<std::size_t>(v)];
    }
    template <std::size_t N>
    void add(std::uint8_t type, const std::array<std::uint32_t, N>& corners, std::int32_t marker, std::int32_t entity) {
        for (const std::uint32_t v : corners) {
            connectivity.push_back(v);
            number[v] = 0;
        }
        offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
        types.push_back(type);
        dimensions.push_back(static_cast<std::int8_t>(N - 1));
        markers.push_back(marker);
        entities.push_back(entity);
    }

    static constexpr std::int64_t kUnused = -1;
    std::vector<std::int64_t> number, vertices, connectivity, offsets;
    std::vector<Vec3> points;
    std::vector<std::uint8_t> types;
    std::vector<std::int8_t> dimensions;
    std::vector<std::int32_t> markers, entities;
};

void write_boundary(const TetMesh& mesh, OutputFile& out) {
    const BoundaryCells cells(mesh);
    VtkFile file("UnstructuredGrid");
    file.begin(mesh.names, fmt::format("NumberOfPoints=\"{}\" NumberOfCells=\"{}\"", cells.points.size(), cells.types.size()));
    file.points(cells.points);
    file.text("</Points>\n<PointData>\n");
    file.array("mesh_vertex", cells.vertices);
    file.text("</PointData>\n<Cells>\n");
    file.array("connectivity", cells.connectivity);
    file.array("offsets", cells.offsets);
    file.array("types", cells.types);
    file.text("</Cells>\n<CellData Scalars=\"marker\">\n");
    file.array("dimension", cells.dimensions);
    file.array("marker", cells.markers);
    file.array("entity", cells.entities);
    file.text("</CellData>\n");
    file.finish(out);
}

}  // namespace

void write_vtu(const TetMesh& mesh, const std::filesystem::path& path, OutputSet& files) {
    write_volume(mesh, files.add(path));
    write_boundary(mesh, files.add(std::filesystem::path(path).replace_extension(".boundary.vtu")));
}

}  // namespace wellmesh::io
