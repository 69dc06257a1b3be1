// SPDX-License-Identifier: Apache-2.0
#include "io/plc_building.hpp"

#include <utility>

#include <fmt/format.h>

namespace wellmesh::io {

Vec3 read_point(TextScanner& in, TextPrecision& precision) {
    Vec3 point;
    for (double* const coordinate : {&point.x, &point.y, &point.z}) {
        const std::string_view token = in.next();
        *coordinate = in.to_real(token, "a coordinate");
        precision.note(token, *coordinate);
    }
    return point;
}

Vec3 read_seed(TextScanner& in) {
    Vec3 point;
    for (double* const coordinate : {&point.x, &point.y, &point.z}) *coordinate = in.real("a coordinate");
    return point;
}

std::uint32_t vertex_index(const TextScanner& in, std::int64_t number, std::uint32_t first, std::size_t vertices) {
    const std::int64_t index = number - static_cast<std::int64_t>(first);
    if (number < static_cast<std::int64_t>(first) || static_cast<std::uint64_t>(index) >= vertices) {
        if (vertices == 0) in.fail(fmt::format("vertex {} does not exist: the file has no vertices so far", number));
        in.fail(fmt::format("vertex {} does not exist; valid numbers are {} to {}", number, first, first + vertices - 1));
    }
    return static_cast<std::uint32_t>(index);
}

PlcFacet polygon_facet(std::vector<std::uint32_t> polygon, std::int32_t marker) {
    PlcFacet facet;
    facet.polygons.reserve(1);
    facet.polygons.push_back(std::move(polygon));
    facet.marker = marker;
    return facet;
}

void add_polygon(Plc& plc, std::vector<std::uint32_t> polygon, std::int32_t marker) { plc.facets.push_back(polygon_facet(std::move(polygon), marker)); }

Plc make_surface(const SourceFile& source) {
    Plc plc;
    plc.fill = FillRule::nonzero_winding;
    plc.merge_coplanar = MergeRule::all;
    plc.source_name = source.name;
    return plc;
}

void normalise_zeros(std::vector<Vec3>& points) {
    for (Vec3& p : points) {  // -0.0 + 0.0 is +0.0, and every other sum is its first term
        p.x += 0.0;
        p.y += 0.0;
        p.z += 0.0;
    }
}

}  // namespace wellmesh::io
