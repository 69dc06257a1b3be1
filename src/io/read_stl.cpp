// SPDX-License-Identifier: Apache-2.0
// STL, text and binary. A file is binary iff its size is 84 + 50 n for the n that it states: binary headers may well begin
// with "solid". Vertices that are equal bit by bit (after -0.0 -> 0.0) become one. Normals are not read as numbers: they are
// redundant, and many files hold "nan" there.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/byte_order.hpp"
#include "io/mixed_mesh.hpp"
#include "io/plc_building.hpp"
#include "io/readers.hpp"
#include "io/text_rows.hpp"

namespace wellmesh::io {
namespace {

constexpr std::size_t kHeaderBytes = 84;    // 80 of text, 4 of count
constexpr std::size_t kTriangleBytes = 50;  // 12 floats, 2 bytes of attribute

/// Numbers for points, in the order in which they come first; equal ones have one. A table of numbers alone: in the nodes of std::unordered_map look-ups took
/// most of the time that reading did.
class VertexMerger {
public:
    explicit VertexMerger(std::vector<Vec3>& vertices) : vertices_(vertices) {}
    /// Makes room for `n` different ones.
    void reserve(std::size_t n) {
        if (const std::size_t size = std::bit_ceil(2 * n); size > slots_.size()) rehash(size);
    }
    std::uint32_t number_of(Vec3 p) {
        p = {p.x + 0.0, p.y + 0.0, p.z + 0.0};  // -0.0 becomes +0.0
        if (2 * vertices_.size() >= slots_.size()) rehash(std::max<std::size_t>(2 * slots_.size(), 16));
        std::uint32_t& slot = slot_of(p);
        if (slot != kFree) return slot;
        if (vertices_.size() >= kMostVertices) throw MeshError(ErrorCode::bad_input, Stage::read, "more vertices than 32-bit numbers hold");
        slot = static_cast<std::uint32_t>(vertices_.size());
        vertices_.push_back(p);
        return slot;
    }

private:
    static constexpr std::uint32_t kFree = 0xffffffff;

    static std::size_t hash(const Vec3& p) noexcept {
        std::uint64_t h = 0;
        for (const double c : {p.x, p.y, p.z}) {
            h = (h ^ std::bit_cast<std::uint64_t>(c)) * 0x9e3779b97f4a7c15ULL;  // golden ratio, odd
            h ^= h >> 32;
        }
        return h;
    }
    /// The one that holds the point's number, or the free one where it belongs.
    std::uint32_t& slot_of(const Vec3& p) {
        std::size_t i = hash(p) & (slots_.size() - 1);
        while (slots_[i] != kFree && !(vertices_[slots_[i]] == p)) i = (i + 1) & (slots_.size() - 1);
        return slots_[i];
    }
    void rehash(std::size_t size) {
        slots_.assign(size, kFree);
        for (std::size_t v = 0; v < vertices_.size(); ++v) slot_of(vertices_[v]) = static_cast<std::uint32_t>(v);
    }

    std::vector<Vec3>& vertices_;
    std::vector<std::uint32_t> slots_;  // a power of two of them, half of them free at least
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

/// Facets as they stand in the file: points that are equal have yet to become one vertex.
struct StlFacets {
    std::vector<Vec3> points;
    std::vector<std::uint32_t> point_lines, facet_lines;
    std::vector<std::size_t> ends;  // of each facet's points
    TextPrecision precision;
};

class TextStl {
public:
    explicit TextStl(const SourceFile& source)
        : in_(source, {.hash_comments = false}), plc_(make_surface(source)), merger_(plc_.vertices) {}

    Plc read() {
        for (std::string_view token = in_.next(); !token.empty(); token = in_.next()) {
            if (!is_word(token, "solid")) in_.fail_expected(token, solids_ == 0 ? "'solid'" : "'solid' or the end of the file");
            const std::string_view name = in_.rest_of_line();  // anything
            ++solids_;
            read_solid();
            if (!name.empty()) plc_.names.of_dimension[2].emplace(solids_, name);
        }
        if (!resolve_generated_names(plc_) && solids_ == 1) {
            for (PlcFacet& facet : plc_.facets) facet.marker = 0;
            plc_.names = {};
        }
        plc_.relative_rounding = precision_.relative_rounding();
        return std::move(plc_);
    }

private:
    /// Tally that merges the vertices of what has been joined to it.
    struct Facets {
        TextStl* reader = nullptr;
        StlFacets rows{};
        void join(Facets&& later) { reader->merge(later.rows); }
    };

    void read_solid() {
        constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
        Facets facets{this};
        read_rows_while(in_, kAll, facets, [](std::size_t) {}, [](TextScanner& in, std::size_t i, Facets& to) {
            const TextScanner::Place begin = in.place();
            // Some writers leave out 'endfacet', and some glue the name to 'endsolid'.
            std::string_view token = in.next();
            if (i > 0 && is_word(token, "endfacet")) token = in.next();
            if (lower(token.substr(0, 8)) == "endsolid") {
                in.move_to(begin);
                return false;
            }
            if (!is_word(token, "facet")) in.fail_expected(token, i > 0 ? "'endfacet', 'facet' or 'endsolid'" : "'facet' or 'endsolid'");
            read_facet(in, to.rows);
            if (to.reader != nullptr) to.reader->merge(to.rows);
            return true;
        });
        if (is_word(in_.next(), "endfacet")) (void)in_.next();
        in_.skip_line();
    }

    static void read_facet(TextScanner& in, StlFacets& to) {
        to.facet_lines.push_back(in.line32());
        expect_word(in, "normal");
        for (int i = 0; i < 3; ++i)
            if (in.next().empty()) in.fail_expected({}, "a normal");
        expect_word(in, "outer");
        expect_word(in, "loop");
        while (true) {
            const std::string_view token = in.next();
            if (is_word(token, "endloop")) break;
            if (!is_word(token, "vertex")) in.fail_expected(token, "'vertex' or 'endloop'");
            to.points.push_back(read_point(in, to.precision));
            to.point_lines.push_back(in.line32());
        }
        to.ends.push_back(to.points.size());
    }

    /// Takes the facets over.
    void merge(StlFacets& rows) {
        std::size_t p = 0;
        for (std::size_t f = 0; f < rows.ends.size(); ++f) {
            std::vector<std::uint32_t> polygon;
            polygon.reserve(rows.ends[f] - p);
            for (; p < rows.ends[f]; ++p) {
                polygon.push_back(merger_.number_of(rows.points[p]));
                if (plc_.vertex_lines.size() < plc_.vertices.size()) plc_.vertex_lines.push_back(rows.point_lines[p]);
            }
            plc_.facet_lines.push_back(rows.facet_lines[f]);
            add_polygon(plc_, std::move(polygon), solids_);
        }
        precision_.join(rows.precision);
        rows.points.clear();
        rows.point_lines.clear();
        rows.facet_lines.clear();
        rows.ends.clear();
    }

    TextScanner in_;
    TextPrecision precision_;
    Plc plc_;
    VertexMerger merger_;
    std::int32_t solids_ = 0;
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
