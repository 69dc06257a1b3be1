// SPDX-License-Identifier: Apache-2.0
// Surfaces as .off, .obj, .stl and .ply. Facets are single polygons (with_simple_facets()). A facet marker is a group of an .obj and a solid of an .stl;
// the names of those are the markers' names.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/vec3_math.hpp"
#include "io/mixed_mesh.hpp"
#include "io/writers.hpp"

namespace wellmesh::io {
namespace {

constexpr std::size_t kLeastCorners = 3;  // fewer: a point of the complex, which these formats lack

bool is_face(const PlcFacet& facet) { return facet.polygons.front().size() >= kLeastCorners; }

std::size_t face_count(const Plc& plc) { return static_cast<std::size_t>(std::count_if(plc.facets.begin(), plc.facets.end(), is_face)); }

void write_vertex_line(OutputFile& out, const Vec3& p) {
    out.point(p);
    out.character('\n');
}

/// Numbers of facets by marker, each in their order.
std::map<std::int32_t, std::vector<std::size_t>> faces_by_marker(const Plc& plc) {
    std::map<std::int32_t, std::vector<std::size_t>> faces;
    for (std::size_t f = 0; f < plc.facets.size(); ++f)
        if (is_face(plc.facets[f])) faces[plc.facets[f].marker].push_back(f);
    return faces;
}

/// A name on one line.
std::string name_of(const Plc& plc, std::size_t dimension, std::int32_t marker) {
    const std::string* stated = plc.names.find(dimension, marker);
    std::string name = stated != nullptr ? *stated : generated_name(dimension, marker);
    for (char& c : name)
        if (c == '\n' || c == '\r') c = ' ';
    return name;
}

template <class Corners>
void write_corners(OutputFile& out, const Corners& corners, std::uint32_t first) {
    for (const std::uint32_t v : corners) {
        out.character(' ');
        out.integer(std::int64_t{v} + first);
    }
    out.character('\n');
}

Vec3 triangle_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 n = cross(b - a, c - a);
    const double length = norm(n);
    return length > 0 && std::isfinite(length) ? Vec3{n.x / length, n.y / length, n.z / length} : Vec3{};
}

template <class T>
void write_little_endian(OutputFile& out, T value) {
    auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if constexpr (std::endian::native != std::endian::little) std::reverse(raw.begin(), raw.end());
    out.bytes(raw.data(), raw.size());
}

}  // namespace

void write_off(const Plc& plc, OutputFile& out) {
    out.text(fmt::format("OFF\n{} {} 0\n", plc.vertices.size(), face_count(plc)));
    for (const Vec3& p : plc.vertices) write_vertex_line(out, p);
    for (const PlcFacet& facet : plc.facets) {
        if (!is_face(facet)) continue;
        out.integer(static_cast<std::int64_t>(facet.polygons.front().size()));
        write_corners(out, facet.polygons.front(), 0);
    }
}

void write_ply(const Plc& plc, OutputFile& out) {
    out.text(fmt::format("ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n", plc.vertices.size()));
    out.text(fmt::format("element face {}\nproperty list int int vertex_indices\nend_header\n", face_count(plc)));
    for (const Vec3& p : plc.vertices) write_vertex_line(out, p);
    for (const PlcFacet& facet : plc.facets) {
        if (!is_face(facet)) continue;
        out.integer(static_cast<std::int64_t>(facet.polygons.front().size()));
        write_corners(out, facet.polygons.front(), 0);
    }
}

void write_obj(const Plc& plc, OutputFile& out) {
    for (const Vec3& p : plc.vertices) {
        out.text("v ");
        write_vertex_line(out, p);
    }
    const auto faces = faces_by_marker(plc);
    std::map<std::int32_t, std::vector<std::size_t>> segments;
    for (std::size_t s = 0; s < plc.segments.size(); ++s) segments[plc.segments[s].marker].push_back(s);
    const auto plain = [](const auto& groups) { return groups.empty() || (groups.size() == 1 && groups.begin()->first == 0); };
    const bool grouped = !plain(faces) || !plain(segments);
    for (const auto& [marker, numbers] : faces) {
        if (grouped) out.text(fmt::format("g {}\n", name_of(plc, 2, marker)));
        for (const std::size_t f : numbers) {
            out.character('f');
            write_corners(out, plc.facets[f].polygons.front(), 1);
        }
    }
    for (const auto& [marker, numbers] : segments) {
        if (grouped) out.text(fmt::format("g {}\n", name_of(plc, 1, marker)));
        for (const std::size_t s : numbers) {
            out.character('l');
            write_corners(out, plc.segments[s].vertices, 1);
        }
    }
}

void write_stl(const Plc& plc, OutputFile& out) {
    for (const auto& [marker, numbers] : faces_by_marker(plc)) {
        const std::string name = name_of(plc, 2, marker);
        out.text(fmt::format("solid {}\n", name));
        for (const std::size_t f : numbers) {
            const auto& c = plc.facets[f].polygons.front();
            out.text("facet normal ");
            write_vertex_line(out, triangle_normal(plc.vertices[c[0]], plc.vertices[c[1]], plc.vertices[c[2]]));
            out.text("outer loop\n");
            for (const std::uint32_t v : c) {
                out.text("vertex ");
                write_vertex_line(out, plc.vertices[v]);
            }
            out.text("endloop\nendfacet\n");
        }
        out.text(fmt::format("endsolid {}\n", name));
    }
}

void write_binary_stl(const Plc& plc, OutputFile& out) {
    constexpr std::size_t kTitleBytes = 80;
    std::string title = "triangles";  // not "solid": that is how text begins
    title.resize(kTitleBytes, ' ');
    out.text(title);
    write_little_endian(out, static_cast<std::uint32_t>(face_count(plc)));
    const auto write_vector = [&](const Vec3& p) {
        for (const double c : {p.x, p.y, p.z}) write_little_endian(out, static_cast<float>(c));
    };
    for (const PlcFacet& facet : plc.facets) {
        if (!is_face(facet)) continue;
        const auto& c = facet.polygons.front();
        write_vector(triangle_normal(plc.vertices[c[0]], plc.vertices[c[1]], plc.vertices[c[2]]));
        for (const std::uint32_t v : c) write_vector(plc.vertices[v]);
        write_little_endian(out, std::uint16_t{0});
    }
}

}  // namespace wellmesh::io
