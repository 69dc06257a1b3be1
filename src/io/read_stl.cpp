// SPDX-License-Identifier: Apache-2.0
// STL, text and binary. A file is binary iff its size is 84 + 50 n for the n that it states: binary headers may well begin
// with "solid". Vertices that are equal bit by bit (after -0.0 -> 0.0) become one. Normals are not read as numbers: they are
// redundant, and many files hold "nan" there.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "io/byte_order.hpp"
#include "io/mixed_mesh.hpp"
#include "io/plc_building.hpp"
#include "io/readers.hpp"

namespace wellmesh::io {
namespace {

constexpr std::size_t kHeaderBytes = 84;    // 80 of text, 4 of count
constexpr std::size_t kTriangleBytes = 50;  // 12 floats, 2 bytes of attribute

class VertexMerger {
public:
    explicit VertexMerger(std::vector<Vec3>& vertices) : vertices_(vertices) {}
    void reserve(std::size_t n) { numbers_.reserve(n); }
    std::uint32_t number_of(Vec3 p) {
        p = {p.x + 0.0, p.y + 0.0, p.z + 0.0};  // -0.0 becomes +0.0
        const auto [at, is_new] = numbers_.try_emplace(p, static_cast<std::uint32_t>(vertices_.size()));
        if (is_new && vertices_.size() >= kMostVertices)
            throw MeshError(ErrorCode::bad_input, Stage::read, "more vertices than 32-bit numbers hold");
        if (is_new) vertices_.push_back(p);
        return at->second;
    }

private:
    struct Hash {
        std::size_t operator()(const Vec3& p) const noexcept {
            std::uint64_t h = 0;
            for (const double c : {p.x, p.y, p.z}) {
                h = (h ^ std::bit_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15ULL;  // golden ratio, odd
                h ^= h >> 32;
            }
            return h;
        }
    };
    std::vector<Vec3>& vertices_;
    std::unordered_map<Vec3, std::uint32_t, Hash> numbers_;  // only looked up: its order never shows
};

std::string lower(std::string_view word) {
    std::string out(word);
    for (char& c : out)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return out;
}

bool is_word(std::string_view token, std::string_view word) {
    return token == word || (token.size() == word.size() && lower(token) == word);
}

void expect_word(TextScanner& in, const char* word) {
    const std::string_view token = in.next();
    if (!is_word(token, word)) in.fail_expected(token, fmt::format("'{}'", word).c_str());
}

class TextStl {
public:
    explicit TextStl(const SourceFile& source)
        : in_(source, {.hash_comments = false}), plc_(make_surface(source)), merger_(plc_.vertices) {}

    Plc read() {
        std::int32_t solids = 0;
        for (std::string_view token = in_.next(); !token.empty(); token = in_.next()) {
            if (!is_word(token, "solid")) in_.fail_expected(token, solids == 0 ? "'solid'" : "'solid' or the end of the file");
            const std::string_view name = in_.rest_of_line();  // anything
            read_solid(++solids);
            if (!name.empty()) plc_.names.of_dimension[2].emplace(solids, name);
        }
        if (!resolve_generated_names(plc_) && solids == 1) {
            for (PlcFacet& facet : plc_.facets) facet.marker = 0;
            plc_.names = {};
        }
        plc_.relative_rounding = precision_.relative_rounding();
        return std::move(plc_);
    }

private:
    void read_solid(std::int32_t marker) {
        bool after_loop = false;
        while (true) {
            // Some writers leave out 'endfacet', and some glue the name to 'endsolid'.
            std::string_view token = in_.next();
            if (after_loop && is_word(token, "endfacet")) token = in_.next();
            if (lower(token.substr(0, 8)) == "endsolid") break;
            if (!is_word(token, "facet")) in_.fail_expected(token, after_loop ? "'endfacet', 'facet' or 'endsolid'" : "'facet' or 'endsolid'");
            read_facet(marker);
            after_loop = true;
        }
        in_.skip_line();
    }

    void read_facet(std::int32_t marker) {
        plc_.facet_lines.push_back(in_.line32());
        expect_word(in_, "normal");
        for (int i = 0; i < 3; ++i)
            if (in_.next().empty()) in_.fail_expected({}, "a normal");
        expect_word(in_, "outer");
        expect_word(in_, "loop");
        std::vector<std::uint32_t> polygon;
        polygon.reserve(3);
        while (true) {
            const std::string_view token = in_.next();
            if (is_word(token, "endloop")) break;
            if (!is_word(token, "vertex")) in_.fail_expected(token, "'vertex' or 'endloop'");
            const Vec3 point = read_point(in_, precision_);
            polygon.push_back(merger_.number_of(point));
            if (plc_.vertex_lines.size() < plc_.vertices.size()) plc_.vertex_lines.push_back(in_.line32());
        }
        add_polygon(plc_, std::move(polygon), marker);
    }

    TextScanner in_;
    TextPrecision precision_;
    Plc plc_;
    VertexMerger merger_;
};

Plc read_binary(const SourceFile& source, std::size_t triangles) {
    Plc plc = make_surface(source);
    plc.relative_rounding = kFloat32Rounding;
    plc.facets.reserve(triangles);
    VertexMerger merger(plc.vertices);
    merger.reserve(triangles / 2 + 2);  // a closed surface has half as many vertices
    for (std::size_t t = 0; t < triangles; ++t) {
        const std::size_t at = kHeaderBytes + t * kTriangleBytes + 12;  // after the normal
        std::vector<std::uint32_t> polygon(3);
        for (std::size_t corner = 0; corner < 3; ++corner) {
            double c[3];
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t byte = at + 12 * corner + 4 * k;
                c[k] = static_cast<double>(load<float>(source.bytes, byte, std::endian::little));
                if (!std::isfinite(c[k])) fail_at_byte(source, byte, fmt::format("triangle {}: coordinate {} is not finite", t + 1, c[k]));
            }
            polygon[corner] = merger.number_of({c[0], c[1], c[2]});
        }
        add_polygon(plc, std::move(polygon), 0);
    }
    return plc;
}

}  // namespace

Plc read_stl(const SourceFile& source) {
    const std::size_t size = source.bytes.size();
    const std::uint64_t stated = size >= kHeaderBytes ? load<std::uint32_t>(source.bytes, kHeaderBytes - 4, std::endian::little) : 0;
    const std::uint64_t expected = kHeaderBytes + kTriangleBytes * stated;
    if (size >= kHeaderBytes && size == expected) return read_binary(source, stated);
    const bool text = is_word(TextScanner(source, {.hash_comments = false}).next(), "solid") && source.bytes.find('\0') == std::string::npos;
    if (text) return TextStl(source).read();
    if (size < kHeaderBytes)
        fail_in_file(source,
                     fmt::format("neither text STL (no 'solid' at its start) nor binary STL ({} bytes, at least {} needed)", size, kHeaderBytes));
    fail_at_byte(source, kHeaderBytes - 4,
                 fmt::format("binary STL states {} triangles, that is {} bytes, but the file has {}", stated, expected, size));
}

}  // namespace wellmesh::io
