// SPDX-License-Identifier: Apache-2.0
// TetGen's .poly and .smesh: points (or none, then the .node file beside), facets, hole seeds, region seeds. Missing hole and region
// parts mean none. Sizes of the points are read from a .mtr beside, if there is one. What follows the region part is passed over: such files carry notes there.
// A facet that consists of two-vertex polygons alone has no area: it is read as segments with the facet's marker.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/plc_building.hpp"
#include "io/readers.hpp"
#include "io/tetgen_nodes.hpp"
#include "io/text_rows.hpp"

namespace wellmesh::io {
namespace {

constexpr std::size_t kLeastRecordBytes = 2;  // one digit and a line end
constexpr std::size_t kLeastSeedBytes = 8;    // "1 0 0 0\n"

class PolyReader {
public:
    PolyReader(const SourceFile& source, bool one_polygon_a_line)
        : in_(source, kTetgenSyntax), smesh_(one_polygon_a_line), nodes_name_(source.name), nodes_(read_nodes(source)), numbering_(nodes_) {
        plc_.source_name = source.name;
    }

    Plc read() {
        read_facets();
        if (!numbering_.sequential()) resolve_numbers();
        separate_segments();
        if (!in_.at_end()) read_holes();
        if (!in_.at_end()) read_regions();
        plc_.vertices = std::move(nodes_.points);
        plc_.vertex_markers = std::move(nodes_.markers);
        if (nodes_name_ == plc_.source_name) plc_.vertex_lines = std::move(nodes_.lines);  // lines of another file would mislead
        plc_.first_number = numbering_.first_number();
        plc_.relative_rounding = precision_.relative_rounding();
        normalise_zeros(plc_.vertices);
        std::filesystem::path sizes = in_.source().path;
        sizes.replace_extension(".mtr");
        if (std::filesystem::exists(sizes)) plc_.vertex_sizes = read_mtr(read_source(sizes, in_.source().threads), plc_.vertices.size());
        return std::move(plc_);
    }

private:
    NodeList read_nodes(const SourceFile& source) {
        NodeList nodes = read_node_list(in_, precision_);
        if (!nodes.points.empty()) return nodes;
        std::filesystem::path beside = source.path;
        beside.replace_extension(".node");
        const SourceFile node_file = read_source(beside, source.threads);
        TextScanner node_scanner(node_file, kTetgenSyntax);
        nodes = read_node_list(node_scanner, precision_);
        if (!node_scanner.at_end()) node_scanner.fail_expected(node_scanner.next(), "nothing after the points");
        nodes_name_ = node_file.name;
        return nodes;
    }

    void read_facets() {
        const std::size_t facets = in_.count("the number of facets", kLeastRecordBytes);
        if (!in_.at_end_of_line()) has_markers_ = in_.to_integer(in_.next_on_line(), "the number of boundary markers of facets (0 or 1)") != 0;
        in_.skip_line();
        plc_.facets.reserve(facets);
        plc_.facet_lines.reserve(facets);
        const auto make_room = [&](std::size_t rows) {
            plc_.facets.resize(rows);
            plc_.facet_lines.resize(rows);
        };
        NoTally none;
        read_rows(in_, facets, none, make_room, [&](TextScanner& in, std::size_t f, NoTally&) {
            if (smesh_)
                std::tie(plc_.facets[f], plc_.facet_lines[f]) = read_smesh_facet(in);
            else
                std::tie(plc_.facets[f], plc_.facet_lines[f]) = read_poly_facet(in);
        });
    }

    /// @return with the line that it begins on
    [[nodiscard]] std::pair<PlcFacet, std::uint32_t> read_smesh_facet(TextScanner& in) const {
        PlcFacet facet;
        std::uint32_t line = 0;
        facet.polygons.push_back(read_polygon(in, &line));
        if (has_markers_ && !in.at_end_of_line()) facet.marker = in.to_reference(in.next_on_line(), "a boundary marker");
        // A file without markers may have that column all the same, as TetGen allows; more than it is a wrong count.
        if (!has_markers_ && !in.at_end_of_line()) (void)in.to_real(in.next_on_line(), "a boundary marker");
        expect_line_end(in, "the polygon");
        return {std::move(facet), line};
    }

    [[nodiscard]] std::pair<PlcFacet, std::uint32_t> read_poly_facet(TextScanner& in) const {
        PlcFacet facet;
        const std::size_t polygons = in.count("the number of polygons of a facet", kLeastRecordBytes);
        const std::uint32_t line = in.line32();
        std::size_t holes = 0;
        if (!in.at_end_of_line()) holes = in.to_count(in.next_on_line(), "the number of holes of a facet", kLeastSeedBytes);
        if (!in.at_end_of_line()) {
            const std::int32_t marker = in.to_reference(in.next_on_line(), "a boundary marker");
            if (has_markers_) facet.marker = marker;
        }
        expect_line_end(in, "the facet's counts and marker");
        facet.polygons.reserve(polygons);
        for (std::size_t p = 0; p < polygons; ++p) {
            facet.polygons.push_back(read_polygon(in, nullptr));
            expect_line_end(in, "the polygon");
        }
        facet.holes.reserve(holes);
        for (std::size_t h = 0; h < holes; ++h) facet.holes.push_back(read_numbered_seed(in));
        return {std::move(facet), line};
    }

    /// Corners may continue over lines. @param line  where to note the one it begins on; may be null
    std::vector<std::uint32_t> read_polygon(TextScanner& in, std::uint32_t* line) const {
        const std::size_t corners = in.count("the number of vertices of a polygon", kLeastRecordBytes);
        if (line != nullptr) *line = in.line32();
        std::vector<std::uint32_t> polygon(corners);
        for (std::uint32_t& corner : polygon) {
            const std::string_view token = in.next();
            if (numbering_.sequential())
                corner = vertex_index(in, in.to_integer(token, "a vertex number"), numbering_.first(), numbering_.size());
            else
                corner = vertex_number(in, token);
        }
        return polygon;
    }

    static void expect_line_end(TextScanner& in, const char* what) {
        if (!in.at_end_of_line()) in.fail_expected(in.next_on_line(), fmt::format("the line to end after {}", what).c_str());
    }

    /// The file's numbers to indices: as the list states them if all used ones exist, else as TetGen counts.
    void resolve_numbers() {
        using Lookup = std::optional<std::uint32_t> (NodeNumbering::*)(std::uint32_t) const;
        const auto first_unknown = [&](Lookup lookup) -> std::optional<std::pair<std::size_t, std::uint32_t>> {
            for (std::size_t f = 0; f < plc_.facets.size(); ++f)
                for (const auto& polygon : plc_.facets[f].polygons)
                    for (const std::uint32_t number : polygon)
                        if (!(numbering_.*lookup)(number)) return std::pair{f, number};
            return std::nullopt;
        };
        // Facets that use a number given twice may mean either vertex: guessing would mesh another domain without a word.
        if (numbering_.repeats())
            fail_at_line(in_.source(), numbering_.irregular_line(), fmt::format("the list of points repeats numbers: the first out of order is {}:{}; number the points one after the other", nodes_name_, numbering_.irregular_line()));
        Lookup lookup = &NodeNumbering::as_stated;
        if (first_unknown(lookup)) {
            lookup = &NodeNumbering::as_counted;
            if (const auto unknown = first_unknown(lookup))
                fail_at_line(in_.source(), plc_.facet_lines[unknown->first],
                             fmt::format("vertex {} is used, but the list of points lacks that number (first out of order: {}:{})", unknown->second, nodes_name_,
                                         numbering_.irregular_line()));
        }
        for (PlcFacet& facet : plc_.facets)
            for (auto& polygon : facet.polygons)
                for (std::uint32_t& number : polygon) number = *(numbering_.*lookup)(number);
    }

    void separate_segments() {
        std::size_t kept = 0;
        for (std::size_t f = 0; f < plc_.facets.size(); ++f) {
            PlcFacet& facet = plc_.facets[f];
            const bool no_area = !facet.polygons.empty() && facet.holes.empty() &&
                                 std::all_of(facet.polygons.begin(), facet.polygons.end(), [](const auto& p) { return p.size() == 2; });
            if (no_area) {
                for (const auto& polygon : facet.polygons) plc_.segments.push_back({{polygon[0], polygon[1]}, facet.marker});
                continue;
            }
            if (kept != f) {
                plc_.facets[kept] = std::move(facet);
                plc_.facet_lines[kept] = plc_.facet_lines[f];
            }
            ++kept;
        }
        plc_.facets.resize(kept);
        plc_.facet_lines.resize(kept);
    }

    static Vec3 read_numbered_seed(TextScanner& in) {
        (void)in.integer("the number of a hole or region");
        return read_seed(in);
    }

    void read_holes() {
        const std::size_t holes = in_.count("the number of holes", kLeastSeedBytes);
        plc_.hole_seeds.reserve(holes);
        in_.skip_line();
        for (std::size_t h = 0; h < holes; ++h) {
            plc_.hole_seeds.push_back(read_numbered_seed(in_));
            in_.skip_line();
        }
    }

    void read_regions() {
        const std::size_t regions = in_.count("the number of regions", kLeastSeedBytes);
        plc_.region_seeds.reserve(regions);
        in_.skip_line();
        for (std::size_t r = 0; r < regions; ++r) {
            RegionSeed seed;
            seed.point = read_numbered_seed(in_);
            seed.id = in_.to_reference(in_.next_on_line(), "an integer region attribute");
            if (!in_.at_end_of_line()) seed.max_volume = in_.to_real(in_.next_on_line(), "a volume bound");
            plc_.region_seeds.push_back(seed);
            in_.skip_line();
        }
    }

    TextScanner in_;
    bool smesh_;
    std::string nodes_name_;  // file that lists the points
    TextPrecision precision_;
    Plc plc_;
    NodeList nodes_;
    NodeNumbering numbering_;
    bool has_markers_ = false;
};

}  // namespace

Plc read_poly(const SourceFile& source) {
    return PolyReader(source, false).read();
}

Plc read_smesh(const SourceFile& source) {
    return PolyReader(source, true).read();
}

}  // namespace wellmesh::io
