// SPDX-License-Identifier: Apache-2.0
// The same small surface as text or bytes of every format that is read, made by code that shares nothing with the readers and writers.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <unistd.h>

#include <fmt/format.h>

#include "core/rng.hpp"
#include "io/source_file.hpp"
#include "wellmesh/plc.hpp"

namespace wellmesh::testing {

inline io::SourceFile source_of(std::string bytes, const char* name = "sample") {
    return {name, name, std::move(bytes)};
}

using Polygons = std::vector<std::vector<std::uint32_t>>;

struct Surface {
    std::vector<Vec3> vertices;
    Polygons polygons;
};

/// A box with quadrilateral sides and coordinates that need every digit; `as_float` rounds them to float32 numbers.
inline Surface sample_surface(bool as_float = false) {
    Surface s;
    for (std::uint64_t v = 0; v < 8; ++v) {
        std::array<double, 3> c{};
        for (std::uint64_t k = 0; k < 3; ++k) {
            c[k] = ((v >> k & 1) != 0 ? 7.0 : -3.0) + unit_double(mix64(17, 3 * v + k));
            if (as_float) c[k] = static_cast<double>(static_cast<float>(c[k]));
        }
        s.vertices.push_back({c[0], c[1], c[2]});
    }
    s.polygons = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    return s;
}

inline Surface triangulated(const Surface& s) {
    Surface t{s.vertices, {}};
    for (const auto& p : s.polygons)
        for (std::size_t i = 2; i < p.size(); ++i) t.polygons.push_back({p[0], p[i - 1], p[i]});
    return t;
}

inline std::string off_text(const Surface& s) {
    std::string out = fmt::format("OFF\n{} {} 0\n", s.vertices.size(), s.polygons.size());
    for (const Vec3& p : s.vertices) out += fmt::format("{} {} {}\n", p.x, p.y, p.z);
    for (const auto& p : s.polygons) out += fmt::format("{} {}\n", p.size(), fmt::join(p, " "));
    return out;
}

inline std::string obj_text(const Surface& s) {
    std::string out = "# a comment\nmtllib none.mtl\n";
    for (const Vec3& p : s.vertices) out += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
    for (const auto& p : s.polygons) {
        out += "f";
        for (const auto v : p) out += fmt::format(" {}", v + 1);
        out += "\n";
    }
    return out;
}

inline std::string stl_text(const Surface& s) {
    std::string out = "solid sample of a box\n";
    for (const auto& p : s.polygons) {
        out += "  facet normal 0 0 0\n    outer loop\n";
        for (const auto v : p) out += fmt::format("      vertex {} {} {}\n", s.vertices[v].x, s.vertices[v].y, s.vertices[v].z);
        out += "    endloop\n  endfacet\n";
    }
    return out + "endsolid sample of a box\n";
}

template <class T>
void append_number(std::string& out, T value, bool little) {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), &value, sizeof(T));
    if (little != (std::endian::native == std::endian::little))
        for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(raw[i], raw[sizeof(T) - 1 - i]);
    out.append(raw.data(), raw.size());
}

inline std::string stl_binary(const Surface& s) {
    std::string out = "solid is what binary files may begin with too";
    out.resize(80, ' ');
    append_number(out, static_cast<std::uint32_t>(s.polygons.size()), true);
    for (const auto& p : s.polygons) {
        for (int i = 0; i < 3; ++i) append_number(out, 0.0F, true);
        for (const auto v : p)
            for (const double c : {s.vertices[v].x, s.vertices[v].y, s.vertices[v].z}) append_number(out, static_cast<float>(c), true);
        append_number(out, std::uint16_t{0xffff}, true);
    }
    return out;
}

/// @param format  "ascii", "binary_little_endian" or "binary_big_endian"
inline std::string ply_bytes(const Surface& s, std::string_view format, bool as_double) {
    const bool text = format == "ascii", little = format == "binary_little_endian";
    std::string out =
        fmt::format("ply\nformat {} 1.0\ncomment a comment\nelement camera 1\nproperty int id\nelement vertex {}\n", format, s.vertices.size());
    const char* type = as_double ? "double" : "float";
    out += fmt::format("property uchar red\nproperty {0} z\nproperty {0} x\nproperty list uchar short rings\nproperty {0} y\n", type);
    out += fmt::format("element face {}\nproperty uint16 flags\nproperty list uchar int vertex_indices\nend_header\n", s.polygons.size());
    const auto real = [&](double c) { as_double ? append_number(out, c, little) : append_number(out, static_cast<float>(c), little); };
    if (text)
        out += "7\n";
    else
        append_number(out, std::int32_t{7}, little);
    for (const Vec3& p : s.vertices) {
        if (text) {
            out += fmt::format("255 {} {} 2 -1 300 {}\n", p.z, p.x, p.y);
            continue;
        }
        append_number(out, std::uint8_t{255}, little);
        real(p.z);
        real(p.x);
        append_number(out, std::uint8_t{2}, little);
        append_number(out, std::int16_t{-1}, little);
        append_number(out, std::int16_t{300}, little);
        real(p.y);
    }
    for (const auto& p : s.polygons) {
        if (text) {
            out += fmt::format("9 {} {}\n", p.size(), fmt::join(p, " "));
            continue;
        }
        append_number(out, std::uint16_t{9}, little);
        append_number(out, static_cast<std::uint8_t>(p.size()), little);
        for (const auto v : p) append_number(out, static_cast<std::int32_t>(v), little);
    }
    return out;
}

inline std::string medit_text(const Surface& s) {
    std::string out = fmt::format("MeshVersionFormatted 2\nDimension\n3\n\nVertices\n{}\n", s.vertices.size());
    for (const Vec3& p : s.vertices) out += fmt::format("{} {} {} 0\n", p.x, p.y, p.z);
    out += "Corners\n2\n1\n2\n";
    for (const std::size_t n : {std::size_t{3}, std::size_t{4}}) {
        std::size_t count = 0;
        std::string rows;
        for (const auto& p : s.polygons) {
            if (p.size() != n) continue;
            ++count;
            for (const auto v : p) rows += fmt::format("{} ", v + 1);
            rows += "5\n";
        }
        if (count > 0) out += fmt::format("{}\n{}\n{}", n == 3 ? "Triangles" : "Quadrilaterals", count, rows);
    }
    return out + "RequiredVertices\n1\n8\nEnd\n";
}

inline std::string poly_text(const Surface& s, bool smesh, std::uint32_t first = 1) {
    std::string out = fmt::format("# part 1\n{} 3 0 0\n", s.vertices.size());
    for (std::size_t v = 0; v < s.vertices.size(); ++v)
        out += fmt::format("{} {} {} {}\n", v + first, s.vertices[v].x, s.vertices[v].y, s.vertices[v].z);
    out += fmt::format("{} 1\n", s.polygons.size());
    for (std::size_t f = 0; f < s.polygons.size(); ++f) {
        if (!smesh) out += fmt::format("1 0 {}\n", f + 10);
        out += fmt::format("{}", s.polygons[f].size());
        for (const auto v : s.polygons[f]) out += fmt::format(" {}", v + first);
        out += smesh ? fmt::format(" {}\n", f + 10) : "\n";
    }
    return out + "1\n1 100 100 100\n1\n1 0.5 0.5 0.5 3 0.25\n";
}

/// A directory that is removed with everything in it.
class TemporaryDirectory {
public:
    TemporaryDirectory() {
        std::string pattern = (std::filesystem::temp_directory_path() / "wellmesh-test-XXXXXX").string();
        path_ = ::mkdtemp(pattern.data()) == nullptr ? std::filesystem::path() : std::filesystem::path(pattern);
    }
    TemporaryDirectory(const TemporaryDirectory&) = delete;
    TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
    ~TemporaryDirectory() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    [[nodiscard]] std::filesystem::path operator/(std::string_view name) const { return path_ / name; }
    [[nodiscard]] std::vector<std::string> files() const {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(path_)) names.push_back(entry.path().filename().string());
        std::sort(names.begin(), names.end());
        return names;
    }
    std::filesystem::path write(std::string_view name, std::string_view bytes) const {
        std::ofstream(path_ / name, std::ios::binary) << bytes;
        return path_ / name;
    }
    [[nodiscard]] static std::string read(const std::filesystem::path& path) {
        std::ifstream in(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }

private:
    std::filesystem::path path_;
};

}  // namespace wellmesh::testing
