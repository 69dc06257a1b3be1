// SPDX-License-Identifier: Apache-2.0
// Meshes as other programs write them: binary .msh in either byte order, .vtu in all encodings. Shares nothing with the readers and writers.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <zlib.h>

#include "sample_files.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh::testing {

/// Gmsh's binary format 4.1: each region a volume, in a physical group of its number + 1000; all subfaces surface 5 in group 7, the whole in two node
/// blocks, the first of which has parameters. With a field "h" of node data. Node tags are 10, 20, 30, ...
inline std::string msh_binary(const TetMesh& mesh, bool little) {
    std::string out = "$MeshFormat\n4.1 1 8\n";
    const auto integer = [&](std::int64_t v) { append_number(out, static_cast<std::int32_t>(v), little); };
    const auto size = [&](std::uint64_t v) { append_number(out, v, little); };
    const auto real = [&](double v) { append_number(out, v, little); };
    integer(1);
    out += "\n$EndMeshFormat\n$PhysicalNames\n1\n2 7 \"the hull\"\n$EndPhysicalNames\n$Entities\n";
    std::vector<std::int32_t> regions = mesh.tet_regions;
    std::sort(regions.begin(), regions.end());
    regions.erase(std::unique(regions.begin(), regions.end()), regions.end());
    for (const std::size_t n : {std::size_t{0}, std::size_t{0}, std::size_t{1}, regions.size()}) size(n);
    const auto entity = [&](std::int64_t tag, std::int64_t group) {
        integer(tag);
        for (int i = 0; i < 6; ++i) real(i);
        size(1);
        integer(group);
        size(1);
        integer(-99);
    };
    entity(5, -7);  // a reversed surface of the group
    for (const std::int32_t r : regions) entity(r, r + 1000);
    out += "\n$EndEntities\n$Nodes\n";
    const std::size_t n = mesh.vertices.size(), half = n / 2;
    for (const std::size_t v : {std::size_t{2}, n, std::size_t{10}, 10 * n}) size(v);
    for (int block = 0; block < 2; ++block) {
        const std::size_t first = block == 0 ? 0 : half, last = block == 0 ? half : n;
        integer(2 + block);
        integer(5);
        integer(block == 0 ? 1 : 0);
        size(last - first);
        for (std::size_t v = first; v < last; ++v) size(10 * v + 10);
        for (std::size_t v = first; v < last; ++v) {
            for (const double c : {mesh.vertices[v].x, mesh.vertices[v].y, mesh.vertices[v].z}) real(c);
            if (block == 0) real(0.25), real(0.5);
        }
    }
    out += "\n$EndNodes\n$Elements\n";
    for (const std::size_t v : {1 + regions.size(), mesh.subfaces.size() + mesh.tets.size(), std::size_t{1}, mesh.tets.size()}) size(v);
    std::uint64_t number = 0;
    const auto element = [&](const auto& corners) {
        size(++number);
        for (const std::uint32_t v : corners) size(10 * std::uint64_t{v} + 10);
    };
    for (const int v : {2, 5, 2}) integer(v);
    size(mesh.subfaces.size());
    for (const auto& face : mesh.subfaces) element(face);
    for (const std::int32_t r : regions) {
        for (const std::int32_t v : {3, r, 4}) integer(v);
        size(static_cast<std::uint64_t>(std::count(mesh.tet_regions.begin(), mesh.tet_regions.end(), r)));
        for (std::size_t t = 0; t < mesh.tets.size(); ++t)
            if (mesh.tet_regions[t] == r) element(mesh.tets[t]);
    }
    out += fmt::format("\n$EndElements\n$NodeData\n1\n\"h\"\n1\n0.0\n3\n0\n1\n{}\n", n);
    for (std::size_t v = 0; v < n; ++v) {
        integer(static_cast<std::int64_t>(10 * v + 10));
        real(static_cast<double>(v) + 1);
    }
    return out + "\n$EndNodeData\n";
}

inline std::string base64(std::string_view bytes) {
    constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        for (std::size_t k = 0; k < 4; ++k) out += k <= bytes.size() - i ? kAlphabet[group >> (18 - 6 * k) & 63U] : '=';
    }
    return out;
}

struct VtuStyle {
    bool ascii = false, base64 = false, appended = false, compressed = false, little = true, wide_header = false;
};

/// A .vtu of the tetrahedra and subfaces with cell data `region` and point data `h`, in two pieces of which the first is empty.
inline std::string vtu_text(const TetMesh& mesh, VtuStyle style) {
    std::string appended;
    const auto array = [&]<class T>(const char* type, const char* name, const std::vector<T>& values, int components = 1) {
        std::string head = fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" ", type, name, components);
        if (style.ascii) {
            std::vector<double> plain(values.begin(), values.end());
            return head + fmt::format("format=\"ascii\">\n{}\n</DataArray>\n", fmt::join(plain, " "));
        }
        std::string bytes, header, data;
        for (const T v : values) append_number(bytes, v, style.little);
        const auto count = [&](std::uint64_t v) {
            style.wide_header ? append_number(header, v, style.little) : append_number(header, static_cast<std::uint32_t>(v), style.little);
        };
        if (style.compressed) {
            constexpr std::size_t kBlock = 256;  // so that there are several
            std::string blocks;
            std::vector<std::size_t> sizes;
            for (std::size_t at = 0; at < bytes.size(); at += kBlock) {
                const std::string part = bytes.substr(at, kBlock);
                uLongf size = compressBound(part.size());
                std::string packed(size, '\0');
                compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(part.data()), part.size());
                sizes.push_back(size);
                blocks += packed.substr(0, size);
            }
            count(sizes.size());
            count(kBlock);
            count(bytes.size() % kBlock);
            for (const std::size_t size : sizes) count(size);
            data = style.base64 ? testing::base64(header) + testing::base64(blocks) : header + blocks;
        } else {
            count(bytes.size());
            data = style.base64 ? testing::base64(header + bytes) : header + bytes;
        }
        if (!style.appended) return head + fmt::format("format=\"binary\">\n  {}\n</DataArray>\n", data);
        const std::size_t offset = appended.size();
        appended += data;
        return head + fmt::format("format=\"appended\" offset=\"{}\"/>\n", offset);
    };
    std::vector<double> coordinates, field;
    std::vector<std::int64_t> connectivity, offsets;
    std::vector<std::uint8_t> types;
    std::vector<std::int32_t> regions = mesh.tet_regions;
    for (const Vec3& p : mesh.vertices) coordinates.insert(coordinates.end(), {p.x, p.y, p.z});
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) field.push_back(static_cast<double>(v) + 0.5);
    for (const auto& t : mesh.tets)
        connectivity.insert(connectivity.end(), t.begin(), t.end()), offsets.push_back(static_cast<std::int64_t>(connectivity.size())),
            types.push_back(10);
    for (const auto& f : mesh.subfaces)
        connectivity.insert(connectivity.end(), f.begin(), f.end()), offsets.push_back(static_cast<std::int64_t>(connectivity.size())),
            types.push_back(5);
    regions.insert(regions.end(), mesh.subface_markers.begin(), mesh.subface_markers.end());
    std::string out = fmt::format(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"{}\" header_type=\"{}\"{}>\n<UnstructuredGrid>\n",
        style.little ? "LittleEndian" : "BigEndian", style.wide_header ? "UInt64" : "UInt32",
        style.compressed ? " compressor=\"vtkZLibDataCompressor\"" : "");
    out +=
        "<FieldData><DataArray type=\"Int32\" Name=\"left &amp; right\" NumberOfTuples=\"4\" format=\"ascii\">20 3 100 2</DataArray></FieldData>\n";
    out += "<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\"><Points/><Cells/></Piece>\n";
    out += fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<PointData>\n", mesh.vertices.size(), types.size());
    out += array("Float64", "h", field) + "</PointData><CellData>\n" + array("Int32", "region", regions) + "</CellData>\n<Points>\n" +
           array("Float64", "Points", coordinates, 3);
    out +=
        "</Points>\n<Cells>\n" + array("Int64", "connectivity", connectivity) + array("Int64", "offsets", offsets) + array("UInt8", "types", types);
    out += "</Cells>\n</Piece>\n</UnstructuredGrid>\n";
    if (style.appended) out += fmt::format("<AppendedData encoding=\"{}\">\n _", style.base64 ? "base64" : "raw") + appended + "\n</AppendedData>\n";
    return out + "</VTKFile>\n";
}

}  // namespace wellmesh::testing
