// SPDX-License-Identifier: Apache-2.0
// Wavefront OBJ: v, f (i, i/t, i/t/n, i//n, negative numbers count back from the latest vertex), l as segments; a marker for
// each combination of o, g and usemtl that has elements, if there is more than one. Other statements of the format do not
// concern the shape and are passed over; unknown ones are errors, because the file is then probably no OBJ.
#include <algorithm>
#include <array>
#include <cstdint>
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

namespace wellmesh::io {
namespace {

constexpr std::array<std::string_view, 33> kPassedOverWords{
    "vt", "vn", "vp", "p", "s", "mg", "mtllib", "maplib", "usemap", "bevel", "c_interp", "d_interp", "lod",
    "shadow_obj", "trace_obj", "ctech", "stech", "cstype", "deg", "bmat", "step", "curv", "curv2", "surf", "parm",
    "trim", "hole", "scrv", "sp", "end", "con", "call", "csh"};

class ObjReader {
public:
    explicit ObjReader(const SourceFile& source) : in_(source, {.backslash_continues = true}), plc_(make_surface(source)) {}

    Plc read() {
        for (std::string_view word = in_.next(); !word.empty(); word = in_.next()) read_statement(word);
        if (plc_.vertices.empty()) in_.fail("expected 'v' statements, but the file ends without any");
        check_forward_references();
        name_markers();
        if (!resolve_generated_names(plc_) && groups_.size() <= 1) {
            for (PlcFacet& facet : plc_.facets) facet.marker = 0;
            for (PlcSegment& segment : plc_.segments) segment.marker = 0;
            plc_.names = {};
        }
        plc_.first_number = 1;
        plc_.relative_rounding = precision_.relative_rounding();
        normalise_zeros(plc_.vertices);
        return std::move(plc_);
    }

private:
    void read_statement(std::string_view word) {
        if (word == "v") {
            read_vertex();
        } else if (word == "f" || word == "fo") {  // fo: the name that an early version of the format used
            const std::uint32_t line = in_.line32();
            read_corners();
            plc_.facet_lines.push_back(line);
            add_polygon(plc_, corners_, current_marker());
        } else if (word == "l") {
            read_corners();
            for (std::size_t i = 1; i < corners_.size(); ++i) plc_.segments.push_back({{corners_[i - 1], corners_[i]}, current_marker()});
        } else if (word == "o" || word == "g" || word == "usemtl") {
            names_[word == "o" ? 0U : word == "g" ? 1U : 2U] = std::string(in_.rest_of_line());
            marker_known_ = false;
        } else if (std::find(kPassedOverWords.begin(), kPassedOverWords.end(), word) != kPassedOverWords.end()) {
            while (!in_.next_on_line().empty()) {}  // not skip_line(): the statement may continue on the next line
        } else {
            in_.fail_expected(word, "an OBJ statement (v, vt, vn, f, l, o, g, ...)");
        }
    }

    void read_vertex() {
        if (plc_.vertices.size() >= kMostVertices) in_.fail("more vertices than 32-bit numbers hold");
        plc_.vertex_lines.push_back(in_.line32());
        Vec3 point;
        for (double* const coordinate : {&point.x, &point.y, &point.z}) {
            const std::string_view token = in_.next_on_line();
            *coordinate = in_.to_real(token, "a coordinate");
            precision_.note(token, *coordinate);
        }
        plc_.vertices.push_back(point);
        for (std::string_view token = in_.next_on_line(); !token.empty(); token = in_.next_on_line())
            (void)in_.to_real(token, "a weight or colour");
    }

    void read_corners() {
        corners_.clear();
        for (std::string_view token = in_.next_on_line(); !token.empty(); token = in_.next_on_line()) corners_.push_back(read_corner(token));
    }

    std::uint32_t read_corner(std::string_view token) {
        const std::size_t slash = token.find('/');
        const std::int64_t number = in_.to_integer(token.substr(0, slash), "a vertex number");
        if (slash != std::string_view::npos) check_texture_and_normal(token.substr(slash + 1), token);
        const auto so_far = static_cast<std::int64_t>(plc_.vertices.size());
        if (number == 0) in_.fail("vertex 0 does not exist: OBJ counts from 1, or back from -1");
        if (number < -so_far) in_.fail(fmt::format("vertex {} does not exist: only {} vertices stand before it", number, so_far));
        if (number > static_cast<std::int64_t>(kMostVertices)) in_.fail(fmt::format("vertex {} does not exist", number));
        const std::int64_t index = number < 0 ? so_far + number : number - 1;
        if (index >= so_far && (!forward_ || index > static_cast<std::int64_t>(forward_->first)))
            forward_ = {static_cast<std::uint32_t>(index), in_.line()};
        return static_cast<std::uint32_t>(index);
    }

    void check_texture_and_normal(std::string_view rest, std::string_view token) const {
        const std::size_t slash = rest.find('/');
        for (const std::string_view part : {rest.substr(0, slash), slash == std::string_view::npos ? std::string_view{} : rest.substr(slash + 1)})
            if (!part.empty() && part.find_first_not_of("+-0123456789") != std::string_view::npos)
                in_.fail_expected(token, "vertex/texture/normal numbers");
    }

    /// Vertices may follow the faces that use them, so the largest such number is checked at the end.
    void check_forward_references() const {
        if (forward_ && forward_->first >= plc_.vertices.size())
            fail_at_line(
                in_.source(), forward_->second,
                fmt::format("vertex {} does not exist; valid numbers are 1 to {}", std::uint64_t{forward_->first} + 1, plc_.vertices.size()));
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
    TextPrecision precision_;
    Plc plc_;
    std::vector<std::uint32_t> corners_;
    std::optional<std::pair<std::uint32_t, std::uint64_t>> forward_;  // largest forward reference and its line
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
