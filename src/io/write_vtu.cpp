// SPDX-License-Identifier: Apache-2.0
// VTK XML unstructured grid: tetrahedra with region and shape, points with their weights if there are any, appended as raw binary with 64-bit sizes,
// in the byte order of
// this machine (which the file states). VTK has no notion of conforming constraints, so subfaces and subsegments are left out.
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "io/writers.hpp"
#include "quality/tet_shape.hpp"

namespace wellmesh::io {
namespace {

constexpr std::uint8_t kVtkTetra = 10;

/// Names arrays in the header, in the order and with the sizes in which the data follow.
class AppendedArrays {
public:
    std::string tag(std::string_view type, std::string_view name, std::size_t bytes, std::string_view components = "") {
        const std::string text =
            fmt::format("<DataArray type=\"{}\" Name=\"{}\"{} format=\"appended\" offset=\"{}\"/>\n", type, name, components, offset_);
        offset_ += sizeof(std::uint64_t) + bytes;
        return text;
    }

private:
    std::size_t offset_ = 0;
};

void write_size(OutputFile& out, std::size_t bytes) {
    const std::uint64_t size = bytes;
    out.bytes(&size, sizeof size);
}

template <class T>
void write_array(OutputFile& out, const std::vector<T>& values) {
    write_size(out, values.size() * sizeof(T));
    out.bytes(values.data(), values.size() * sizeof(T));
}

/// A measure of each tetrahedron, for display: rounded; a flat one has angle 0 and an infinite ratio.
template <class Measure>
void write_measure(OutputFile& out, const TetMesh& mesh, Measure measure) {
    write_size(out, mesh.tets.size() * sizeof(double));
    for (const auto& [a, b, c, d] : mesh.tets) {
        const double value = measure(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], mesh.vertices[d]);
        out.bytes(&value, sizeof value);
    }
}

void write_header(OutputFile& out, std::size_t points, std::size_t tets, bool weighted) {
    AppendedArrays arrays;
    out.text("<?xml version=\"1.0\"?>\n");
    out.text(fmt::format("<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{}\" header_type=\"UInt64\">\n",
                         std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian"));
    out.text(fmt::format("<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n", points, tets));
    out.text(arrays.tag("Float64", "Points", points * sizeof(Vec3), " NumberOfComponents=\"3\""));
    out.text("</Points>\n");
    if (weighted) out.text("<PointData>\n" + arrays.tag("Float64", "weight", points * sizeof(double)) + "</PointData>\n");
    out.text("<Cells>\n");
    out.text(arrays.tag("Int64", "connectivity", 4 * tets * sizeof(std::int64_t)));
    out.text(arrays.tag("Int64", "offsets", tets * sizeof(std::int64_t)));
    out.text(arrays.tag("UInt8", "types", tets));
    out.text("</Cells>\n<CellData Scalars=\"region\">\n");
    out.text(arrays.tag("Int32", "region", tets * sizeof(std::int32_t)));
    out.text(arrays.tag("Float64", "min_dihedral_angle_deg", tets * sizeof(double)));
    out.text(arrays.tag("Float64", "radius_edge_ratio", tets * sizeof(double)));
    out.text("</CellData>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_");
}

}  // namespace

void write_vtu(const TetMesh& mesh, OutputFile& out) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double), "points are written as they lie in memory");
    const std::size_t tets = mesh.tets.size();
    write_header(out, mesh.vertices.size(), tets, !mesh.weights.empty());
    write_array(out, mesh.vertices);
    if (!mesh.weights.empty()) write_array(out, mesh.weights);
    write_size(out, 4 * tets * sizeof(std::int64_t));
    for (const auto& tet : mesh.tets) {
        const std::array<std::int64_t, 4> wide{tet[0], tet[1], tet[2], tet[3]};
        out.bytes(wide.data(), sizeof wide);
    }
    write_size(out, tets * sizeof(std::int64_t));
    for (std::size_t t = 1; t <= tets; ++t) {
        const auto end = static_cast<std::int64_t>(4 * t);
        out.bytes(&end, sizeof end);
    }
    write_array(out, std::vector<std::uint8_t>(tets, kVtkTetra));
    write_array(out, mesh.tet_regions);
    write_measure(out, mesh, [](const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& t) { return min_dihedral_deg(p, q, r, t); });
    write_measure(out, mesh, [](const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& t) { return std::sqrt(radius_edge_squared(p, q, r, t)); });
    out.text("\n</AppendedData>\n</VTKFile>\n");
}

}  // namespace wellmesh::io
