// SPDX-License-Identifier: Apache-2.0
// A PLC as TetGen's .poly and .smesh (facets of one polygon each), counted as its source was. Segments become facets of one two-vertex polygon. The format always
// means "every bounded cell without a hole seed": a complex whose fill rule is another loses that rule.
#include <cstdint>

#include "io/writers.hpp"

namespace wellmesh::io {
namespace {

void write_coordinates(OutputFile& out, const Vec3& p) {
    for (const double coordinate : {p.x, p.y, p.z}) {
        out.character(' ');
        out.real(coordinate);
    }
}

void write_facet_head(OutputFile& out, std::size_t polygons, std::size_t holes, std::int32_t marker) {
    out.integer(static_cast<std::int64_t>(polygons));
    out.character(' ');
    out.integer(static_cast<std::int64_t>(holes));
    out.character(' ');
    out.integer(marker);
    out.character('\n');
}

template <class Corners>
void write_polygon(OutputFile& out, const Corners& corners, std::uint32_t first_number) {
    out.integer(static_cast<std::int64_t>(corners.size()));
    for (const std::uint32_t v : corners) {
        out.character(' ');
        out.integer(std::int64_t{v} + first_number);
    }
    out.character('\n');
}

/// Part 1.
void write_points(const Plc& plc, OutputFile& out) {
    const bool marked = !plc.vertex_markers.empty();
    out.integer(static_cast<std::int64_t>(plc.vertices.size()));
    out.text(marked ? " 3 0 1\n" : " 3 0 0\n");
    for (std::size_t v = 0; v < plc.vertices.size(); ++v) {
        out.integer(static_cast<std::int64_t>(v) + plc.first_number);
        write_coordinates(out, plc.vertices[v]);
        if (marked) {
            out.character(' ');
            out.integer(plc.vertex_markers[v]);
        }
        out.character('\n');
    }
    out.integer(static_cast<std::int64_t>(plc.facets.size() + plc.segments.size()));
    out.text(" 1\n");
}

/// Parts 3 and 4.
void write_seeds(const Plc& plc, OutputFile& out) {
    out.integer(static_cast<std::int64_t>(plc.hole_seeds.size()));
    out.character('\n');
    for (std::size_t h = 0; h < plc.hole_seeds.size(); ++h) {
        out.integer(static_cast<std::int64_t>(h) + 1);
        write_coordinates(out, plc.hole_seeds[h]);
        out.character('\n');
    }
    out.integer(static_cast<std::int64_t>(plc.region_seeds.size()));
    out.character('\n');
    for (std::size_t r = 0; r < plc.region_seeds.size(); ++r) {
        const RegionSeed& seed = plc.region_seeds[r];
        out.integer(static_cast<std::int64_t>(r) + 1);
        write_coordinates(out, seed.point);
        out.character(' ');
        out.integer(seed.id);
        out.character(' ');
        out.real(seed.max_volume > 0 ? seed.max_volume : -1);
        out.character('\n');
    }
}

}  // namespace

void write_poly(const Plc& plc, OutputFile& out) {
    write_points(plc, out);
    for (const PlcFacet& facet : plc.facets) {
        write_facet_head(out, facet.polygons.size(), facet.holes.size(), facet.marker);
        for (const auto& polygon : facet.polygons) write_polygon(out, polygon, plc.first_number);
        for (std::size_t h = 0; h < facet.holes.size(); ++h) {
            out.integer(static_cast<std::int64_t>(h) + 1);
            write_coordinates(out, facet.holes[h]);
            out.character('\n');
        }
    }
    for (const PlcSegment& segment : plc.segments) {
        write_facet_head(out, 1, 0, segment.marker);
        write_polygon(out, segment.vertices, plc.first_number);
    }
    write_seeds(plc, out);
}

void write_smesh(const Plc& plc, OutputFile& out) {
    write_points(plc, out);
    const auto write_facet = [&](const auto& corners, std::int32_t marker) {
        out.integer(static_cast<std::int64_t>(corners.size()));
        for (const std::uint32_t v : corners) {
            out.character(' ');
            out.integer(std::int64_t{v} + plc.first_number);
        }
        out.character(' ');
        out.integer(marker);
        out.character('\n');
    };
    for (const PlcFacet& facet : plc.facets) write_facet(facet.polygons.front(), facet.marker);
    for (const PlcSegment& segment : plc.segments) write_facet(segment.vertices, segment.marker);
    write_seeds(plc, out);
}

}  // namespace wellmesh::io
