// SPDX-License-Identifier: Apache-2.0
// A VTK XML file while it is written: text whose arrays follow appended as raw binary with 64-bit sizes, in the byte order of this machine, which the
// file states. Names are field data, (marker, dimension) each, as in meshio.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/atomic_file.hpp"
#include "wellmesh/names.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh::io {

inline constexpr std::uint8_t kVtkVertex = 1, kVtkLine = 3, kVtkTriangle = 5, kVtkTetra = 10;

/// Text as an attribute of XML.
[[nodiscard]] std::string escaped(std::string_view text);

class VtkFile {
public:
    explicit VtkFile(std::string_view type) : type_(type) {}
    void text(std::string_view text) { text_ += text; }

    template <class T>
    void array(std::string_view name, std::size_t values, std::function<void(OutputFile&)> write, int components = 1) {
        constexpr std::string_view kind = std::is_floating_point_v<T> ? "Float" : std::is_signed_v<T> ? "Int" : "UInt";
        text_ += fmt::format("<DataArray type=\"{}{}\" Name=\"{}\"{} format=\"appended\" offset=\"{}\"/>\n", kind, 8 * sizeof(T), escaped(name),
                             components > 1 ? fmt::format(" NumberOfComponents=\"{}\"", components) : std::string(), offset_);
        offset_ += sizeof(std::uint64_t) + values * sizeof(T);
        arrays_.push_back({values * sizeof(T), std::move(write)});
    }
    /// @param values  must live until finish().
    template <class T>
    void array(std::string_view name, const std::vector<T>& values) {
        array<T>(name, values.size(), [&values](OutputFile& out) { out.bytes(values.data(), values.size() * sizeof(T)); });
    }
    template <class T>
    void array(std::string_view name, std::vector<T>&& values) {
        const std::size_t size = values.size();
        array<T>(name, size, [kept = std::move(values)](OutputFile& out) { out.bytes(kept.data(), kept.size() * sizeof(T)); });
    }
    void points(const std::vector<Vec3>& points) {
        static_assert(sizeof(Vec3) == 3 * sizeof(double), "points are written as they lie in memory");
        array<double>("Points", 3 * points.size(), [&points](OutputFile& out) { out.bytes(points.data(), points.size() * sizeof(Vec3)); }, 3);
    }

    /// Up to <Points>. @param counts  the attributes of <Piece>
    void begin(const Names& names, std::string_view counts);
    /// From </Piece> on, with all arrays.
    void finish(OutputFile& out);

private:
    struct Array {
        std::size_t bytes;
        std::function<void(OutputFile&)> write;
    };
    std::string type_, text_;
    std::vector<Array> arrays_;
    std::size_t offset_ = 0;
};

}  // namespace wellmesh::io
