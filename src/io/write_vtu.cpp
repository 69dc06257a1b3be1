// SPDX-License-Identifier: Apache-2.0
// VTK XML unstructured grid: tetrahedra with region and shape, appended as raw binary with 64-bit sizes, in the byte order of
// this machine (which the file states). VTK has no notion of conforming constraints, so subfaces and subsegments are left out.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/vec3_math.hpp"
#include "io/writers.hpp"

namespace wellmesh::io {
namespace {

constexpr std::uint8_t kVtkTetra = 10;

struct Shape {
    double min_dihedral_angle_deg = 0, radius_edge_ratio = 0;
};

/// For display: rounded, and infinite or nan where a tetrahedron is flat.
Shape shape_of(const std::array<Vec3, 4>& p) {
    constexpr std::array<std::array<std::size_t, 4>, 6> kEdges{{{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}}};
    double sine = 0, cosine = -1, shortest = 0;  // of the smallest angle so far, up to a common positive factor
    for (std::size_t i = 0; i < kEdges.size(); ++i) {
        const auto [a, b, c, d] = kEdges[i];
        const Vec3 edge = p[b] - p[a], n1 = cross(edge, p[c] - p[a]), n2 = cross(edge, p[d] - p[a]);
        const double y = norm(cross(n1, n2)), x = dot(n1, n2);
        if (i == 0 || y * cosine < x * sine) {  // angles in [0, pi]: the smaller has the larger cotangent
            sine = y;
            cosine = x;
        }
        const double squared_length = squared_norm(edge);
        if (i == 0 || squared_length < shortest) shortest = squared_length;
    }
    const Vec3 u = p[1] - p[0], v = p[2] - p[0], w = p[3] - p[0];
    const Vec3 numerator = squared_norm(u) * cross(v, w) + squared_norm(v) * cross(w, u) + squared_norm(w) * cross(u, v);
    const double circumradius = norm(numerator) / (2 * std::abs(determinant(u, v, w)));
    return {std::atan2(sine, cosine) * (180 / std::numbers::pi), circumradius / std::sqrt(shortest)};
}

/// Names arrays in the header, in the order and with the sizes in which the data follow.
class AppendedArrays {
public:
    std::string tag(std::string_view type, std::string_view name, std::size_t bytes, int components = 1) {
        const std::string text = fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n", type,
                                             name, components, offset_);
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

void write_header(OutputFile& out, std::size_t points, std::size_t tets) {
    AppendedArrays arrays;
    out.text("<?xml version=\"1.0\"?>\n");
    out.text(fmt::format("<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{}\" header_type=\"UInt64\">\n",
                         std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian"));
    out.text(fmt::format("<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n", points, tets));
    out.text(arrays.tag("Float64", "Points", points * sizeof(Vec3), 3));
    out.text("</Points>\n<Cells>\n");
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
    write_header(out, mesh.vertices.size(), tets);
    write_array(out, mesh.vertices);
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
    std::vector<double> ratios(tets);
    write_size(out, tets * sizeof(double));
    for (std::size_t t = 0; t < tets; ++t) {
        const auto& tet = mesh.tets[t];
        const Shape shape = shape_of({mesh.vertices[tet[0]], mesh.vertices[tet[1]], mesh.vertices[tet[2]], mesh.vertices[tet[3]]});
        out.bytes(&shape.min_dihedral_angle_deg, sizeof(double));
        ratios[t] = shape.radius_edge_ratio;
    }
    write_array(out, ratios);
    out.text("\n</AppendedData>\n</VTKFile>\n");
}

}  // namespace wellmesh::io
