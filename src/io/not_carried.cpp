// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/plc_formats.hpp"
#include "io/source_file.hpp"
#include "io/writers.hpp"
#include "wellmesh/convert.hpp"

namespace wellmesh {
namespace {

constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
constexpr bool kYes = true, kNo = false;

//                                                                  facet          segment          vertex            names of              bounded
//                                                   corners        marker  segm.  marker   points  marker   seeds   facets segm. vertices  cells
constexpr std::array<io::PlcFormat, 9> kFormats{{{".poly", 0, io::write_poly, kYes, kYes, kYes, kYes, kYes, kYes, kNo, kNo, kNo, kYes},
                                                 {".smesh", kAny, io::write_smesh, kYes, kYes, kYes, kYes, kYes, kYes, kNo, kNo, kNo, kYes},
                                                 {".off", kAny, io::write_off, kNo, kNo, kNo, kNo, kNo, kNo, kNo, kNo, kNo, kNo},
                                                 {".obj", kAny, io::write_obj, kYes, kYes, kYes, kNo, kNo, kNo, kYes, kYes, kNo, kNo},
                                                 {".ply", kAny, io::write_ply, kNo, kNo, kNo, kNo, kNo, kNo, kNo, kNo, kNo, kNo},
                                                 {".stl", 3, nullptr, kYes, kNo, kNo, kNo, kNo, kNo, kYes, kNo, kNo, kNo},
                                                 {".mesh", 3, io::write_medit_surface, kYes, kYes, kYes, kYes, kYes, kNo, kNo, kNo, kNo, kYes},
                                                 {".msh", 3, nullptr, kYes, kYes, kYes, kNo, kYes, kNo, kYes, kYes, kYes, kYes},
                                                 {".vtp", kAny, io::write_vtp, kYes, kYes, kYes, kYes, kYes, kNo, kYes, kYes, kYes, kYes}}};

bool any_marked(const std::vector<std::int32_t>& markers) {
    return std::any_of(markers.begin(), markers.end(), [](std::int32_t m) { return m != 0; });
}

class Losses {
public:
    explicit Losses(std::string extension) : extension_(std::move(extension)) {}
    void add(bool lost, const std::string& what) {
        if (lost) out_.push_back(fmt::format("{} can't carry {}", extension_, what));
    }
    void count(std::size_t number, const char* what) { add(number > 0, fmt::format("{} {}", number, what)); }
    void say(const std::string& sentence) { out_.push_back(sentence); }
    std::vector<std::string> take() { return std::move(out_); }

private:
    std::string extension_;
    std::vector<std::string> out_;
};

}  // namespace

const io::PlcFormat* io::find_plc_format(std::string_view extension) {
    const auto at = std::find_if(kFormats.begin(), kFormats.end(), [&](const PlcFormat& format) { return format.extension == extension; });
    return at == kFormats.end() ? nullptr : &*at;
}

std::vector<std::string> not_carried(const Plc& plc, const std::filesystem::path& path, const WriteOptions& options) {
    const std::string extension = io::lower_case_extension(path);
    const io::PlcFormat* const format = io::find_plc_format(extension);
    Losses losses(extension);
    if (format == nullptr) return losses.take();
    std::size_t complicated = 0, cornered = 0, points = 0;
    for (const PlcFacet& facet : plc.facets) {
        const bool point = facet.polygons.size() == 1 && facet.polygons[0].size() == 1;
        points += point;
        if (format->most_corners == 0 || point) continue;
        if (facet.polygons.size() != 1 || !facet.holes.empty()) ++complicated;
        else if (facet.polygons[0].size() > format->most_corners) ++cornered;
    }
    if (complicated > 0) losses.say(fmt::format("{} facets of several polygons or with holes were triangulated", complicated));
    if (cornered > 0) losses.say(fmt::format("{} facets of more than {} corners were triangulated", cornered, format->most_corners));
    std::set<std::int32_t> facet_markers, segment_markers;
    for (const PlcFacet& facet : plc.facets) facet_markers.insert(facet.marker);
    for (const PlcSegment& segment : plc.segments) segment_markers.insert(segment.marker);
    const auto marked = [](const std::set<std::int32_t>& markers) { return markers.size() > 1 || (!markers.empty() && *markers.begin() != 0); };
    const bool single = extension == ".stl" && options.binary_stl;
    if (single) losses.say("coordinates are rounded to the 24 bits of binary .stl");
    if (!format->facet_markers || single) losses.add(marked(facet_markers), fmt::format("the {} markers of facets", facet_markers.size()));
    if (!format->segments) losses.count(plc.segments.size(), "segments");
    else if (!format->segment_markers) losses.add(marked(segment_markers), "markers of segments");
    if (!format->points) losses.count(points, "points of the complex");
    if (!format->vertex_markers) losses.add(any_marked(plc.vertex_markers), "markers of vertices");
    if (!format->seeds) {
        losses.count(plc.hole_seeds.size(), "hole seeds");
        losses.count(plc.region_seeds.size(), "region seeds");
    }
    if (!format->facet_names || single) losses.count(plc.names.of_dimension[2].size(), "names of facets");
    if (!format->segment_names) losses.count(plc.names.of_dimension[1].size(), "names of segments");
    if (!format->vertex_names) losses.count(plc.names.of_dimension[0].size(), "names of vertices");
    losses.count(plc.names.of_dimension[3].size(), "names of regions");
    losses.add(std::any_of(plc.vertex_sizes.begin(), plc.vertex_sizes.end(), [](double h) { return h > 0; }), "sizes of vertices (they stay in the .mtr file)");
    if (plc.fill == FillRule::nonzero_winding && format->bounded_cells && extension != ".mesh" && extension != ".msh" && extension != ".vtp")
        losses.say(fmt::format("{} fills every bounded cell, this surface those whose winding number is not zero: cavities need hole seeds", extension));
    if (plc.fill == FillRule::bounded_cells && !format->bounded_cells)
        losses.say(fmt::format("{} is a surface that must be closed and is filled by its winding number, this complex fills every bounded cell", extension));
    return losses.take();
}

std::vector<std::string> not_carried(const TetMesh& mesh, const std::filesystem::path& path, const WriteOptions& options) {
    const std::string extension = io::lower_case_extension(path);
    Losses losses(extension);
    const bool names = extension == ".msh" || extension == ".vtu" || extension == ".inp";
    if (!names) {
        constexpr std::array<const char*, 4> kWhat{"names of vertices", "names of segments", "names of facets", "names of regions"};
        for (std::size_t d = 0; d < kWhat.size(); ++d) losses.count(mesh.names.of_dimension[d].size(), kWhat[d]);
    }
    if (extension == ".inp") {
        losses.add(!mesh.weights.empty(), "weights");
        losses.add(any_marked(mesh.subsegment_markers), "segments but as sets of their nodes");
    }
    if (extension == ".mesh" && any_marked(mesh.subface_markers) && mesh.subface_markers != mesh.subface_facets)
        losses.say(fmt::format("references of .mesh are {} here, not {} (--references)", options.references == References::entity ? "numbers of facets" : "markers",
                               options.references == References::entity ? "markers" : "numbers of facets"));
    return losses.take();
}

}  // namespace wellmesh
