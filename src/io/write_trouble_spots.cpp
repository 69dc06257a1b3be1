// SPDX-License-Identifier: Apache-2.0
// A diagnosis as VTK XML polygonal data: points, lines and triangles where something is wrong, with numbers to colour them by. Text, so that the file can be
// read without a viewer, too; such files are small.
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "io/writers.hpp"

namespace wellmesh::io {
namespace {

/// Cells of one dimension: VTK wants vertices first, then lines, then polygons.
struct Spots {
    std::vector<std::vector<Vec3>> corners;
    std::vector<std::size_t> defect;
};

std::array<Spots, 3> spots_of(const Diagnosis& diagnosis) {
    std::array<Spots, 3> spots;
    const auto add = [&](std::vector<Vec3> corners, std::size_t defect) {
        Spots& of_size = spots.at(corners.size() - 1);
        of_size.corners.push_back(std::move(corners));
        of_size.defect.push_back(defect);
    };
    for (std::size_t d = 0; d < diagnosis.defects.size(); ++d) {
        const Defect& defect = diagnosis.defects[d];
        if (!defect.points.empty() && defect.points.size() <= 3) {
            add(defect.points, d);
            continue;
        }
        const bool is_edge = defect.kind == DefectKind::acute_dihedral_angle || defect.kind == DefectKind::open_edge;
        if (is_edge && defect.elements.size() > 1 && defect.elements[0].where && defect.elements[1].where) {
            add({*defect.elements[0].where, *defect.elements[1].where}, d);
            continue;
        }
        for (const ElementRef& e : defect.elements)
            if (e.where) add({*e.where}, d);
    }
    return spots;
}

template <class Value>
void write_cell_array(OutputFile& out, const std::array<Spots, 3>& spots, std::string_view type, std::string_view name, Value&& value) {
    out.text(fmt::format("<DataArray type=\"{}\" Name=\"{}\" format=\"ascii\">\n", type, name));
    for (const Spots& of_size : spots)
        for (const std::size_t d : of_size.defect) {
            value(d);
            out.character('\n');
        }
    out.text("</DataArray>\n");
}

void write_cells(OutputFile& out, const Spots& spots, std::string_view name, std::size_t& next_point) {
    out.text(fmt::format("<{}>\n<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n", name));
    for (const auto& corners : spots.corners) {
        for (std::size_t i = 0; i < corners.size(); ++i) {
            out.integer(static_cast<std::int64_t>(next_point++));
            out.character(' ');
        }
        out.character('\n');
    }
    out.text("</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n");
    std::size_t end = 0;
    for (const auto& corners : spots.corners) {
        out.integer(static_cast<std::int64_t>(end += corners.size()));
        out.character('\n');
    }
    out.text(fmt::format("</DataArray>\n</{}>\n", name));
}

}  // namespace

void write_trouble_spots(const Diagnosis& diagnosis, OutputFile& out) {
    const std::array<Spots, 3> spots = spots_of(diagnosis);
    std::size_t points = 0;
    for (std::size_t size = 1; size <= 3; ++size) points += size * spots.at(size - 1).corners.size();
    out.text("<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PolyData>\n");
    out.text(fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n", points,
                         spots[0].corners.size(), spots[1].corners.size(), spots[2].corners.size()));
    out.text("<CellData Scalars=\"severity\">\n");
    const auto& defects = diagnosis.defects;
    write_cell_array(out, spots, "Int32", "severity", [&](std::size_t d) { out.integer(static_cast<std::int64_t>(defects[d].severity)); });
    write_cell_array(out, spots, "Int32", "kind", [&](std::size_t d) { out.integer(static_cast<std::int64_t>(defects[d].kind)); });
    write_cell_array(out, spots, "Int64", "defect", [&](std::size_t d) { out.integer(static_cast<std::int64_t>(d)); });
    write_cell_array(out, spots, "Float64", "value", [&](std::size_t d) { out.real(defects[d].value); });
    out.text("</CellData>\n<Points>\n<DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"ascii\">\n");
    for (const Spots& of_size : spots)
        for (const auto& corners : of_size.corners)
            for (const Vec3& p : corners) {
                for (const double x : {p.x, p.y, p.z}) {
                    out.real(x);
                    out.character(' ');
                }
                out.character('\n');
            }
    out.text("</DataArray>\n</Points>\n");
    std::size_t next = 0;
    write_cells(out, spots[0], "Verts", next);
    write_cells(out, spots[1], "Lines", next);
    write_cells(out, spots[2], "Polys", next);
    out.text("</Piece>\n</PolyData>\n</VTKFile>\n");
}

}  // namespace wellmesh::io
