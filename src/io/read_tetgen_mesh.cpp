// SPDX-License-Identifier: Apache-2.0
// TetGen's mesh files: .node, .ele, and .face and .edge where they stand beside. Boundary markers become the references of
// subfaces and subsegments, the first attribute of a tetrahedron its region. Corners keep the file's order.
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/readers.hpp"
#include "io/tetgen_nodes.hpp"
#include "io/text_rows.hpp"

namespace wellmesh::io {
namespace {

/// Rows "number c1 ... cN [reference]".
template <std::size_t N>
class RowReader {
public:
    RowReader(const SourceFile& source, const NodeNumbering& numbering) : in_(source, kTetgenSyntax), numbering_(numbering) {}

    void read_tets(std::vector<std::array<std::uint32_t, N>>& corners, std::vector<std::int32_t>& regions) {
        const std::size_t count = in_.count("the number of tetrahedra", 2 * (N + 1));
        std::int64_t width = 4, attributes = 0;
        if (!in_.at_end_of_line()) width = in_.to_integer(in_.next_on_line(), "the number of corners (4)");
        if (width != 4) in_.fail(fmt::format("tetrahedra of {} nodes are not supported, only those of 4", width));
        if (!in_.at_end_of_line()) attributes = in_.to_integer(in_.next_on_line(), "the number of attributes");
        read_elements(count, attributes > 0, "an integer region attribute", corners, regions);
    }

    void read_markers(std::vector<std::array<std::uint32_t, N>>& corners, std::vector<std::int32_t>& markers) {
        const std::size_t count = in_.count("the number of faces or edges", 2 * (N + 1));
        std::int64_t marked = 0;
        if (!in_.at_end_of_line()) marked = in_.to_integer(in_.next_on_line(), "the number of boundary markers (0 or 1)");
        read_elements(count, marked != 0, "a boundary marker", corners, markers);
    }

private:
    void read_elements(std::size_t count, bool with_reference, const char* what, std::vector<std::array<std::uint32_t, N>>& corners,
                       std::vector<std::int32_t>& references) {
        in_.skip_line();
        corners.reserve(count);
        references.reserve(count);
        const auto make_room = [&](std::size_t rows) {
            corners.resize(rows);
            references.resize(rows);
        };
        NoTally none;
        read_rows(in_, count, none, make_room, [&](TextScanner& in, std::size_t i, NoTally&) {
            (void)in.integer("the number of the element");
            for (std::uint32_t& corner : corners[i]) corner = read_corner(in);
            references[i] = with_reference ? in.to_reference(in.next_on_line(), what) : 0;
            in.skip_line();  // further attributes, or the tetrahedra on either side of a face
        });
        if (!in_.at_end()) in_.fail_expected(in_.next(), fmt::format("nothing after the {} rows that the header states", count).c_str());
    }

    std::uint32_t read_corner(TextScanner& in) const {
        const std::uint32_t number = vertex_number(in, in.next_on_line());
        if (const auto index = numbering_.as_stated(number)) return *index;
        // In a mesh all files are written by one program, so a list that is out of order is counted only if numbers repeat.
        if (numbering_.repeats())
            if (const auto index = numbering_.as_counted(number)) return *index;
        in.fail(fmt::format("vertex {} does not exist; the .node file has {} points from {} on", number, numbering_.size(), numbering_.first()));
    }

    TextScanner in_;
    const NodeNumbering& numbering_;
};

std::filesystem::path with_extension(std::filesystem::path path, const char* extension) {
    return path.replace_extension(extension);
}

}  // namespace

TetMesh read_tetgen_mesh(const std::filesystem::path& path, unsigned threads) {
    TetMesh mesh;
    TextPrecision precision;
    const SourceFile node_file = read_source(with_extension(path, ".node"), threads);
    TextScanner in(node_file, kTetgenSyntax);
    NodeList nodes = read_node_list(in, precision);
    if (!in.at_end()) in.fail_expected(in.next(), "nothing after the points");
    const NodeNumbering numbering(nodes);
    mesh.vertices = std::move(nodes.points);
    mesh.vertex_markers = std::move(nodes.markers);
    mesh.relative_rounding = precision.relative_rounding();
    RowReader<4>(read_source(with_extension(path, ".ele"), threads), numbering).read_tets(mesh.tets, mesh.tet_regions);
    const auto faces = with_extension(path, ".face"), edges = with_extension(path, ".edge");
    if (std::filesystem::exists(faces)) RowReader<3>(read_source(faces, threads), numbering).read_markers(mesh.subfaces, mesh.subface_facets);
    if (std::filesystem::exists(edges)) RowReader<2>(read_source(edges, threads), numbering).read_markers(mesh.subsegments, mesh.subsegment_segments);
    mesh.subface_markers = mesh.subface_facets;
    mesh.subsegment_markers = mesh.subsegment_segments;
    return mesh;
}

}  // namespace wellmesh::io
