// SPDX-License-Identifier: Apache-2.0
// MEDIT .mesh, text: keywords in any order, each with a count and rows of fixed width; 'End' or the end of the file closes it.
// Keywords that concern neither the mesh nor its surface are passed over by their width; unknown ones are errors, because a file with
// sections of unknown width cannot be read reliably. Tetrahedra keep the corner order of the file. As a complex, Edges are segments, references markers,
// and Corners and RequiredVertices that nothing else uses are points; the other Required sections and Ridges name what is kept anyway.
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/mixed_mesh.hpp"
#include "io/number_parsing.hpp"
#include "io/plc_building.hpp"
#include "io/readers.hpp"
#include "io/text_rows.hpp"

namespace wellmesh::io {
namespace {

/// Corner numbers (from 0) are checked in the end, because sections come in any order. This is the last one of the largest.
struct LargestCorner {
    std::uint32_t corner = 0;
    std::uint64_t line = 0;
    void join(const LargestCorner& later) {
        if (later.corner >= corner) *this = later;
    }
};

template <std::size_t N>
struct Elements {
    std::vector<std::array<std::uint32_t, N>> corners;
    std::vector<std::int32_t> references;
    std::vector<std::uint32_t> lines;
    bool given = false;
    LargestCorner largest;
};

struct PassedOver {
    std::string_view keyword;
    std::size_t width;  // numbers a row
};
/// With a count and rows. Widths are those of dimension 3.
constexpr std::array<PassedOver, 28> kPassedOver{{{"Corners", 1},
                                                  {"RequiredVertices", 1},
                                                  {"Ridges", 1},
                                                  {"RequiredEdges", 1},
                                                  {"RequiredTriangles", 1},
                                                  {"RequiredQuadrilaterals", 1},
                                                  {"RequiredTetrahedra", 1},
                                                  {"ParallelEdges", 1},
                                                  {"ParallelTriangles", 1},
                                                  {"ParallelVertices", 1},
                                                  {"Normals", 3},
                                                  {"NormalAtVertices", 2},
                                                  {"NormalAtTriangleVertices", 3},
                                                  {"NormalAtQuadrilateralVertices", 3},
                                                  {"Tangents", 3},
                                                  {"TangentAtVertices", 2},
                                                  {"TangentAtEdges", 3},
                                                  {"SubDomainFromMesh", 3},
                                                  {"SubDomainFromGeom", 3},
                                                  {"VertexOnGeometricVertex", 2},
                                                  {"VertexOnGeometricEdge", 3},
                                                  {"VertexOnGeometricTriangle", 4},
                                                  {"VertexOnGeometricQuadrilateral", 4},
                                                  {"EdgeOnGeometricEdge", 2},
                                                  {"TriangleOnGeometricTriangle", 2},
                                                  {"TriangleOnGeometricQuadrilateral", 2},
                                                  {"QuadrilateralOnGeometricTriangle", 2},
                                                  {"QuadrilateralOnGeometricQuadrilateral", 2}}};
/// Without a count.
constexpr std::array<PassedOver, 3> kSingleRows{{{"AngleOfCornerBound", 1}, {"BoundingBox", 6}, {"Identifier", 1}}};
/// Cells that are no tetrahedra: numbers a row.
constexpr std::array<PassedOver, 5> kOtherCells{{{"Hexahedra", 9}, {"Hexaedra", 9}, {"Prisms", 7}, {"Pentahedra", 7}, {"Pyramids", 6}}};

class MeditReader {
public:
    explicit MeditReader(const SourceFile& source, bool as_surface) : in_(source, {}), as_surface_(as_surface) {}

    void read() {
        if (const std::string_view word = in_.next(); word != "MeshVersionFormatted") in_.fail_expected(word, "'MeshVersionFormatted'");
        if (const std::int64_t version = in_.integer("the version of the format"); version < 1 || version > 4)
            in_.fail(fmt::format("version {} of the format is unknown; known are 1 to 4", version));
        for (std::string_view word = in_.next(); !word.empty() && word != "End"; word = in_.next()) read_section(word);
        if (!dimension_known_) in_.fail("the file has no 'Dimension'");
        if (!vertices_given_) in_.fail("the file has no 'Vertices'");
        check(edges_);
        check(triangles_);
        check(quadrilaterals_);
        check(tets_);
    }

    Plc take_surface() {
        Plc plc = make_surface(in_.source());
        if (!triangles_.given && !quadrilaterals_.given) in_.fail("the file has neither 'Triangles' nor 'Quadrilaterals': it holds no surface");
        plc.vertices = std::move(vertices_);
        plc.vertex_lines = std::move(vertex_lines_);
        plc.first_number = 1;
        plc.relative_rounding = precision_.relative_rounding();
        plc.facets.reserve(triangles_.corners.size() + quadrilaterals_.corners.size());
        add_facets(plc, triangles_);
        add_facets(plc, quadrilaterals_);
        for (std::size_t i = 0; i < edges_.corners.size(); ++i) plc.segments.push_back({edges_.corners[i], edges_.references[i]});
        if (!plc.segments.empty() || !is_oriented_closed_surface(plc.facets)) plc.fill = FillRule::bounded_cells;
        add_required_vertices(plc);
        plc.vertex_markers = vertex_references();
        normalise_zeros(plc.vertices);
        return plc;
    }

    TetMesh take_mesh() {
        if (!tets_.given) in_.fail("the file has no 'Tetrahedra'");
        if (!quadrilaterals_.corners.empty()) in_.fail("the file has Quadrilaterals; a tetrahedral mesh has triangles alone");
        TetMesh mesh;
        mesh.vertices = std::move(vertices_);
        mesh.relative_rounding = precision_.relative_rounding();
        mesh.tets = std::move(tets_.corners);
        mesh.tet_regions = std::move(tets_.references);
        mesh.subfaces = std::move(triangles_.corners);
        mesh.subface_facets = triangles_.references;
        mesh.subface_markers = std::move(triangles_.references);
        mesh.subsegments = std::move(edges_.corners);
        mesh.subsegment_segments = edges_.references;
        mesh.subsegment_markers = std::move(edges_.references);
        mesh.vertex_markers = vertex_references();
        return mesh;
    }

private:
    /// Empty if all are 0.
    std::vector<std::int32_t> vertex_references() {
        if (std::all_of(vertex_references_.begin(), vertex_references_.end(), [](std::int32_t r) { return r == 0; })) return {};
        return std::move(vertex_references_);
    }

    /// Vertices of faces and edges are kept anyway; others that are required become points of the complex.
    void add_required_vertices(Plc& plc) const {
        std::vector<char> used(plc.vertices.size(), 0);
        for (const PlcFacet& facet : plc.facets)
            for (const std::uint32_t v : facet.polygons.front()) used[v] = 1;
        for (const PlcSegment& segment : plc.segments)
            for (const std::uint32_t v : segment.vertices) used[v] = 1;
        for (const auto& [number, line] : required_vertices_) {
            if (number < 1 || static_cast<std::uint64_t>(number) > plc.vertices.size())
                fail_at_line(in_.source(), line, fmt::format("vertex {} does not exist; the file has {} vertices", number, plc.vertices.size()));
            const auto v = static_cast<std::uint32_t>(number - 1);
            if (std::exchange(used[v], 1) != 0) continue;
            add_polygon(plc, {v}, 0);
            plc.facet_lines.push_back(static_cast<std::uint32_t>(line));
        }
    }

    void read_required_vertices() {
        const std::size_t count = in_.count("the number of entries", 2);
        for (std::size_t i = 0; i < count; ++i) {
            const std::int64_t number = in_.integer("a vertex number");
            required_vertices_.emplace_back(number, in_.line32());
        }
    }

    void read_section(std::string_view word) {
        if (word == "Dimension") {
            if (const std::int64_t dimension = in_.integer("the dimension"); dimension != 3)
                in_.fail(fmt::format("the dimension is {}, only 3 is supported", dimension));
            dimension_known_ = true;
            return;
        }
        if (!dimension_known_) in_.fail_expected(word, "'Dimension' before the first section");
        if (word == "Vertices") return read_vertices();
        if (as_surface_ && (word == "Corners" || word == "RequiredVertices")) return read_required_vertices();
        if (word == "Edges") return read_elements(edges_, word, true);
        if (word == "Triangles") return read_elements(triangles_, word, true);
        if (word == "Quadrilaterals") return read_elements(quadrilaterals_, word, true);
        if (word == "Tetrahedra") return read_elements(tets_, word, !as_surface_);
        for (const PassedOver& section : kPassedOver)
            if (section.keyword == word) return pass_rows(in_.count("the number of entries", 2 * section.width), section.width);
        for (const PassedOver& section : kSingleRows)
            if (section.keyword == word) return pass_rows(1, section.width);
        for (const PassedOver& section : kOtherCells)
            if (section.keyword == word) return read_other_cells(section);
        in_.fail_expected(word, "a MEDIT keyword or 'End'");
    }

    void read_vertices() {
        if (std::exchange(vertices_given_, true)) in_.fail("the section 'Vertices' is given twice");
        constexpr std::size_t kLeastVertexBytes = 8;  // "0 0 0 0\n"
        const std::size_t count = in_.count("the number of vertices", kLeastVertexBytes);
        if (count > kMostVertices) in_.fail("more vertices than 32-bit numbers hold");
        vertices_.reserve(count);
        vertex_references_.reserve(count);
        if (as_surface_) vertex_lines_.reserve(count);
        const auto make_room = [&](std::size_t rows) {
            vertices_.resize(rows);
            vertex_references_.resize(rows);
            if (as_surface_) vertex_lines_.resize(rows);
        };
        read_rows(in_, count, precision_, make_room, [&](TextScanner& in, std::size_t v, TextPrecision& precision) {
            vertices_[v] = read_point(in, precision);
            if (as_surface_) vertex_lines_[v] = in.line32();
            vertex_references_[v] = in.integer32("a reference");
        });
    }

    template <std::size_t N>
    void read_elements(Elements<N>& elements, std::string_view keyword, bool keep) {
        if (std::exchange(elements.given, true)) in_.fail(fmt::format("the section '{}' is given twice", keyword));
        const std::size_t count = in_.count("the number of elements", 2 * (N + 1));
        if (!keep) return pass_rows(count, N + 1);
        elements.corners.reserve(count);
        elements.references.reserve(count);
        if (as_surface_) elements.lines.reserve(count);
        const auto make_room = [&](std::size_t rows) {
            elements.corners.resize(rows);
            elements.references.resize(rows);
            if (as_surface_) elements.lines.resize(rows);
        };
        read_rows(in_, count, elements.largest, make_room, [&](TextScanner& in, std::size_t i, LargestCorner& largest) {
            for (std::uint32_t& corner : elements.corners[i]) {
                const std::int64_t number = in.integer("a vertex number");
                if (number < 1 || number > static_cast<std::int64_t>(kMostVertices))
                    in.fail(fmt::format("vertex {} does not exist; numbers count from 1", number));
                corner = static_cast<std::uint32_t>(number - 1);
                largest.join({corner, in.line()});
            }
            if (as_surface_) elements.lines[i] = in.line32();
            elements.references[i] = in.integer32("a reference");
        });
    }

    template <std::size_t N>
    void check(const Elements<N>& elements) const {
        if (!elements.corners.empty() && elements.largest.corner >= vertices_.size())
            fail_at_line(in_.source(), elements.largest.line,
                         fmt::format("vertex {} does not exist; the file has {} vertices", std::uint64_t{elements.largest.corner} + 1, vertices_.size()));
    }

    void read_other_cells(const PassedOver& cell) {
        const std::size_t count = in_.count("the number of elements", 2 * cell.width);
        if (count > 0 && !as_surface_) in_.fail(fmt::format("the file has {} {}; only tetrahedra can be read", count, cell.keyword));
        pass_rows(count, cell.width);
    }

    void pass_rows(std::size_t rows, std::size_t width) {
        NoTally none;
        read_rows(in_, rows, none, [](std::size_t) {}, [&](TextScanner& in, std::size_t, NoTally&) {
            for (std::size_t k = 0; k < width; ++k) {
                const std::string_view token = in.next();
                // Enough to notice a keyword where the count promises more rows; the values do not matter.
                if (token.empty() || token.find_first_of("0123456789") == std::string_view::npos) in.fail_expected(token, "a number");
            }
        });
    }

    template <std::size_t N>
    static void add_facets(Plc& plc, const Elements<N>& elements) {
        for (std::size_t i = 0; i < elements.corners.size(); ++i) {
            add_polygon(plc, {elements.corners[i].begin(), elements.corners[i].end()}, elements.references[i]);
            plc.facet_lines.push_back(elements.lines[i]);
        }
    }

    TextScanner in_;
    TextPrecision precision_;
    bool as_surface_, dimension_known_ = false, vertices_given_ = false;
    std::vector<Vec3> vertices_;
    std::vector<std::int32_t> vertex_references_;
    std::vector<std::uint32_t> vertex_lines_;
    std::vector<std::pair<std::int64_t, std::uint64_t>> required_vertices_;  // number and line
    Elements<2> edges_;
    Elements<3> triangles_;
    Elements<4> quadrilaterals_, tets_;
};

}  // namespace

bool has_medit_tetrahedra(const SourceFile& source) {
    TextScanner in(source, {});
    for (std::string_view word = in.next(); !word.empty(); word = in.next())
        if (word == "Tetrahedra") return in.integer("the number of elements") > 0;
    return false;
}

Plc read_medit_surface(const SourceFile& source) {
    MeditReader reader(source, true);
    reader.read();
    return reader.take_surface();
}

TetMesh read_medit_mesh(const SourceFile& source) {
    MeditReader reader(source, false);
    reader.read();
    return reader.take_mesh();
}

}  // namespace wellmesh::io
