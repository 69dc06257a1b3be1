// SPDX-License-Identifier: Apache-2.0
// OFF: [ST][C][N]OFF, counts (on the header line or below), vertices, faces with colours after them.
// Numbers after a vertex's coordinates (normal, colour, texture) and after a face's vertices (colour) are checked, not used.
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/plc_building.hpp"
#include "io/readers.hpp"
#include "io/text_rows.hpp"

namespace wellmesh::io {
namespace {

constexpr std::size_t kLeastVertexBytes = 6;  // "0 0 0\n"
constexpr std::size_t kLeastFaceBytes = 2;    // "0\n"

void read_header(TextScanner& in) {
    const std::string_view token = in.next();
    std::string_view kind = token;
    if (kind.starts_with("ST")) kind.remove_prefix(2);
    if (kind.starts_with("C")) kind.remove_prefix(1);
    if (kind.starts_with("N")) kind.remove_prefix(1);
    if (kind == "4OFF" || kind == "nOFF" || kind == "4nOFF")
        in.fail(fmt::format("{}: only points of three coordinates are supported", quoted_token(token)));
    if (kind != "OFF") in.fail_expected(token, "the word OFF (or COFF, NOFF, STOFF)");
    if (in.at_end()) in.fail("expected the numbers of vertices and faces, but the file ends");
}

void pass_numbers_on_line(TextScanner& in, const char* what) {
    for (std::string_view token = in.next_on_line(); !token.empty(); token = in.next_on_line()) (void)in.to_real(token, what);
}

}  // namespace

Plc read_off(const SourceFile& source) {
    TextScanner in(source, {});
    read_header(in);
    Plc plc = make_surface(source);
    const std::string_view vertices_token = in.next();
    if (vertices_token == "BINARY") in.fail("binary OFF is not supported; save it as text");
    const std::string_view faces_token = in.next_on_line();
    const std::size_t vertices = in.to_count(vertices_token, "the number of vertices", kLeastVertexBytes);
    if (vertices > kMostVertices) in.fail("more vertices than 32-bit numbers hold");
    const std::size_t faces = in.to_count(faces_token, "the number of faces", kLeastFaceBytes);
    if (!in.at_end_of_line()) (void)in.to_integer(in.next_on_line(), "the number of edges");  // always unused, often 0 or absent
    if (!in.at_end_of_line()) in.fail_expected(in.next_on_line(), "the end of the line after the counts");

    TextPrecision precision;
    plc.vertices.reserve(vertices);
    plc.vertex_lines.reserve(vertices);
    const auto room_for_vertices = [&](std::size_t rows) {
        plc.vertices.resize(rows);
        plc.vertex_lines.resize(rows);
    };
    read_rows(in, vertices, precision, room_for_vertices, [&](TextScanner& row, std::size_t v, TextPrecision& noted) {
        plc.vertices[v] = read_point(row, noted);
        plc.vertex_lines[v] = row.line32();
        pass_numbers_on_line(row, "a normal, colour or texture coordinate");
    });
    plc.facets.reserve(faces);
    plc.facet_lines.reserve(faces);
    const auto room_for_faces = [&](std::size_t rows) {
        plc.facets.resize(rows);
        plc.facet_lines.resize(rows);
    };
    NoTally none;
    read_rows(in, faces, none, room_for_faces, [&](TextScanner& row, std::size_t f, NoTally&) {
        const std::size_t corners = row.count("the number of vertices of a face", 2);
        plc.facet_lines[f] = row.line32();
        std::vector<std::uint32_t> polygon(corners);
        for (std::uint32_t& corner : polygon) corner = vertex_index(row, row.integer("a vertex number"), 0, vertices);
        plc.facets[f] = polygon_facet(std::move(polygon), 0);
        pass_numbers_on_line(row, "a colour");
    });
    if (!in.at_end()) in.fail_expected(in.next(), fmt::format("nothing after the {} faces that the header states", faces).c_str());
    plc.relative_rounding = precision.relative_rounding();
    normalise_zeros(plc.vertices);
    return plc;
}

}  // namespace wellmesh::io
