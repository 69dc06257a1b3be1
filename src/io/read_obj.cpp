// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ: v, f (i, i/t, i/t/n, i//n, negative numbers count back from the latest vertex), l as segments; a marker for
// each combination of o, g and usemtl that has elements, if there is more than one. Other statements of the format do not
// concern the shape and are passed over; unknown ones are errors, because the file is then probably no OBJ.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/mixed_mesh.hpp"
#include "io/plc_building.hpp"
#include "io/readers.hpp"
#include "io/text_rows.hpp"

namespace wellmesh::io {
namespace {

constexpr std::array<std::string_view, 33> kPassedOverWords{
    "vt", "vn", "vp", "p", "s", "mg", "mtllib", "maplib", "usemap", "bevel", "c_interp", "d_interp", "lod",
    "shadow_obj", "trace_obj", "ctech", "stech", "cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "parm",
    "trim", "hole", "scrv", "sp", "end", "con", "call", "csh"};

struct ObjVertices {
    std::vector<Vec3> points;
    std::vector<std::uint32_t> lines;
    TextPrecision precision;
    void join(ObjVertices&& later) {
        points.insert(points.end(), later.points.begin(), later.points.end());
        lines.insert(lines.end(), later.lines.begin(), later.lines.end());
        precision.join(later.precision);
    }
};

/// The first of the largest vertex numbers (from 0) that are used before the vertex stands in the file, and its line.
struct ForwardReference {
    std::optional<std::uint32_t> vertex;
    std::uint64_t line = 0;
    void join(const ForwardReference& later) {
        if (later.vertex && (!vertex || *later.vertex > *vertex)) *this = later;
    }
};

struct ObjFacets {
    std::vector<PlcFacet> facets;
    std::vector<std::uint32_t> lines;
    ForwardReference forward;
    void join(ObjFacets&& later) {
        facets.insert(facets.end(), std::make_move_iterator(later.facets.begin()), std::make_move_iterator(later.facets.end()));
        lines.insert(lines.end(), later.lines.begin(), later.lines.end());
        forward.join(later.forward);
    }
};

bool is_passed_over(std::string_view word) { return std::find(kPassedOverWords.begin(), kPassedOverWords.end(), word) != kPassedOverWords.end(); }

bool is_facet(std::string_view word) { return word == "f" || word == "fo"; }  // fo: the name that an early version of the format used

class ObjReader {
public:
    explicit ObjReader(const SourceFile& source) : in_(source, {.backslash_continues = true}), plc_(make_surface(source)) {}

    Plc read() {
        for (TextScanner::Place begin = in_.place();; begin = in_.place()) {
            const std::string_view word = in_.next();
            if (word.empty()) break;
            if (word == "v") {
                in_.move_to(begin);
                read_vertices();
            } else if (is_facet(word)) {
                in_.move_to(begin);
                read_facets();
            } else if (is_passed_over(word)) {
                in_.move_to(begin);
                pass_over();
            } else {
                read_statement(word);
            }
        }
        plc_.vertices = std::move(vertices_.points);
        plc_.vertex_lines = std::move(vertices_.lines);
        plc_.facets = std::move(facets_.facets);
        plc_.facet_lines = std::move(facets_.lines);
        if (plc_.vertices.empty()) in_.fail("expected 'v' statements, but the file ends without any");
        check_forward_references();
        name_markers();
        if (!resolve_generated_names(plc_) && groups_.size() <= 1) {
            for (PlcFacet& facet : plc_.facets) facet.marker = 0;
            for (PlcSegment& segment : plc_.segments) segment.marker = 0;
            plc_.names = {};
        }
        plc_.first_number = 1;
        plc_.relative_rounding = vertices_.precision.relative_rounding();
        normalise_zeros(plc_.vertices);
        return std::move(plc_);
    }

private:
    /// Reads statements whose words `wanted` wants, for as long as they follow each other. @param read  read(in, tally), behind the word
    template <class Tally, class Read>
    void read_run(Tally& tally, bool (*wanted)(std::string_view), const Read& read) {
        constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();
        read_rows_while(in_, kAll, tally, [](std::size_t) {}, [&](TextScanner& in, std::size_t i, Tally& to) {
            const TextScanner::Place begin = in.place();
            if (!wanted(in.next())) {
                in.move_to(begin);
                return false;
            }
            read(in, i, to);
            return true;
        });
    }

    void read_vertices() {
        const std::size_t before = vertices_.points.size();
        read_run(vertices_, [](std::string_view word) { return word == "v"; }, [&](TextScanner& in, std::size_t i, ObjVertices& to) {
            if (before + i >= kMostVertices) in.fail("more vertices than 32-bit numbers hold");
            to.lines.push_back(in.line32());
            Vec3 point;
            for (double* const coordinate : {&point.x, &point.y, &point.z}) {
                const std::string_view token = in.next_on_line();
                *coordinate = in.to_real(token, "a coordinate");
                to.precision.note(token, *coordinate);
            }
            to.points.push_back(point);
            for (std::string_view token = in.next_on_line(); !token.empty(); token = in.next_on_line()) (void)in.to_real(token, "a weight or colour");
        });
    }

    void read_facets() {
        const std::int32_t marker = current_marker();
        read_run(facets_, is_facet, [&](TextScanner& in, std::size_t, ObjFacets& to) {
            to.lines.push_back(in.line32());
            to.facets.push_back(polygon_facet(read_corners(in, to.forward), marker));
        });
    }

    void pass_over() {
        NoTally none;
        read_run(none, is_passed_over, [](TextScanner& in, std::size_t, NoTally&) {
            while (!in.next_on_line().empty()) {}  // not skip_line(): the statement may continue on the next line
        });
    }

    void read_statement(std::string_view word) {
        if (word == "l") {
            const std::vector<std::uint32_t> corners = read_corners(in_, facets_.forward);
            for (std::size_t i = 1; i < corners.size(); ++i) plc_.segments.push_back({{corners[i - 1], corners[i]}, current_marker()});
        } else if (word == "o" || word == "g" || word == "usemtl") {
            names_[word == "o" ? 0U : word == "g" ? 1U : 2U] = std::string(in_.rest_of_line());
            marker_known_ = false;
        } else {
            in_.fail_expected(word, "an OBJ statement (v, vt, vn, f, l, o, g, ...)");
        }
    }

    std::vector<std::uint32_t> read_corners(TextScanner& in, ForwardReference& forward) const {
        std::vector<std::uint32_t> corners;
        corners.reserve(4);  // rarely more
        for (std::string_view token = in.next_on_line(); !token.empty(); token = in.next_on_line()) corners.push_back(read_corner(in, token, forward));
        return corners;
    }

    std::uint32_t read_corner(const TextScanner& in, std::string_view token, ForwardReference& forward) const {
        const std::size_t slash = token.find('/');
        const std::int64_t number = in.to_integer(token.substr(0, slash), "a vertex number");
        if (slash != std::string_view::npos) check_texture_and_normal(in, token.substr(slash + 1), token);
        const auto so_far = static_cast<std::int64_t>(vertices_.points.size());
        if (number == 0) in.fail("vertex 0 does not exist: OBJ counts from 1, or back from -1");
        if (number < -so_far) in.fail(fmt::format("vertex {} does not exist: only {} vertices stand before it", number, so_far));
        if (number > static_cast<std::int64_t>(kMostVertices)) in.fail(fmt::format("vertex {} does not exist", number));
        const auto index = static_cast<std::uint32_t>(number < 0 ? so_far + number : number - 1);
        if (index >= so_far) forward.join({index, in.line()});
        return index;
    }

    static void check_texture_and_normal(const TextScanner& in, std::string_view rest, std::string_view token) {
        const std::size_t slash = rest.find('/');
        for (const std::string_view part : {rest.substr(0, slash), slash == std::string_view::npos ? std::string_view{} : rest.substr(slash + 1)})
            if (!part.empty() && part.find_first_not_of("+-0123456789") != std::string_view::npos)
                in.fail_expected(token, "vertex/texture/normal numbers");
    }

    /// Vertices may follow the faces that use them, so the largest such number is checked at the end.
    void check_forward_references() const {
        const ForwardReference& forward = facets_.forward;
        if (forward.vertex && *forward.vertex >= plc_.vertices.size())
            fail_at_line(in_.source(), forward.line,
                         fmt::format("vertex {} does not exist; valid numbers are 1 to {}", std::uint64_t{*forward.vertex} + 1, plc_.vertices.size()));
    }

    std::int32_t current_marker() {
        if (!marker_known_) {
            std::string key;  // names hold no line end, so the key is unambiguous
            for (const std::string& name : names_) key += name + '\n';
            const auto [at, is_new] = groups_.try_emplace(std::move(key), static_cast<std::int32_t>(groups_.size() + 1));
            if (is_new) group_names_.push_back(names_);
            marker_ = at->second;
            marker_known_ = true;
        }
        return marker_;
    }

    /// A combination is named after those of its parts (object, group, material) that differ somewhere in the file.
    void name_markers() {
        std::array<bool, 3> differs{groups_.size() == 1, groups_.size() == 1, groups_.size() == 1};
        for (const auto& names : group_names_)
            for (std::size_t k = 0; k < 3; ++k) differs[k] = differs[k] || names[k] != group_names_.front()[k];
        std::array<std::vector<std::int32_t>, 3> used;  // dimension 1 and 2
        for (const PlcSegment& segment : plc_.segments) used[1].push_back(segment.marker);
        for (const PlcFacet& facet : plc_.facets) used[2].push_back(facet.marker);
        for (std::size_t dimension = 1; dimension <= 2; ++dimension)
            for (const std::int32_t marker : used[dimension]) {
                const auto& names = group_names_[static_cast<std::size_t>(marker) - 1];
                std::string name;
                for (std::size_t k = 0; k < 3; ++k)
                    if (differs[k] && !names[k].empty()) name += (name.empty() ? "" : "/") + names[k];
                if (!name.empty()) plc_.names.of_dimension[dimension].emplace(marker, std::move(name));
            }
    }

    TextScanner in_;
    Plc plc_;  // vertices and facets in the end
    ObjVertices vertices_;
    ObjFacets facets_;
    std::array<std::string, 3> names_;                                // of the current object, group, material
    std::unordered_map<std::string, std::int32_t> groups_;            // only looked up
    std::vector<std::array<std::string, 3>> group_names_;             // by marker - 1
    std::int32_t marker_ = 0;
    bool marker_known_ = false;
};

}  // namespace

Plc read_obj(const SourceFile& source) {
    return ObjReader(source).read();
}

}  // namespace wellmesh::io
