// SPDX-License-Identifier: Apache-2.0
// VTK's XML files: .vtu with cells of first order, .vtp with vertices, lines and polygons; all encodings, several pieces. A cell's marker is in the
// array `marker` (`region` for tetrahedra), the part that it belongs to in `entity`; what Gmsh's and MEDIT's files become in meshio's hands is
// understood, too. Field data of pairs (marker, dimension) are names.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/mixed_mesh.hpp"
#include "io/plc_building.hpp"
#include "io/readers.hpp"
#include "io/vtk_xml.hpp"

namespace wellmesh::io {
namespace {

constexpr std::array<const char*, 5> kMarkerArrays{"marker", "gmsh:physical", "medit:ref", "cell_tags", "region"};
constexpr std::array<const char*, 5> kRegionArrays{"region", "gmsh:physical", "medit:ref", "cell_tags", "marker"};
constexpr std::array<const char*, 2> kEntityArrays{"entity", "gmsh:geometrical"};

struct VtkType {
    std::int64_t type;
    const char* name;
    bool volume;
};
constexpr std::array<VtkType, 12> kRefused{{{6, "triangle strip", false},
                                            {11, "voxel", true},
                                            {12, "hexahedron", true},
                                            {13, "wedge", true},
                                            {14, "pyramid", true},
                                            {21, "line of second order", false},
                                            {22, "triangle of second order", false},
                                            {23, "quadrilateral of second order", false},
                                            {24, "tetrahedron of second order", true},
                                            {25, "hexahedron of second order", true},
                                            {26, "wedge of second order", true},
                                            {27, "pyramid of second order", true}}};

class VtkReader {
public:
    VtkReader(const SourceFile& source, const char* type, bool as_surface) : source_(source), xml_(source, type), as_surface_(as_surface) {}

    MixedMesh read(bool poly_data) {
        read_names();
        for (const pugi::xml_node piece : xml_.grid().children("Piece")) {
            first_point_ = out_.points.size();
            read_points(piece);
            poly_data ? read_poly_data(piece) : read_cells(piece);
            read_point_data(piece);
        }
        for (auto& [name, values] : out_.fields) values.resize(out_.points.size(), std::numeric_limits<double>::quiet_NaN());
        out_.relative_rounding = std::max(precision_.relative_rounding(), single_precision_ ? kFloat32Rounding : 0.0);
        return std::move(out_);
    }
    /// Point data `mesh_vertex`, of all pieces.
    [[nodiscard]] const std::vector<std::int64_t>& mesh_vertices() const { return mesh_vertices_; }

private:
    void read_names() {
        for (const pugi::xml_node array : xml_.grid().child("FieldData").children("DataArray")) {
            const std::string name = array.attribute("Name").value();
            const std::string_view type = array.attribute("type").value();
            if (name.empty() || (!type.starts_with("Int") && !type.starts_with("UInt"))) continue;
            const std::vector<std::int64_t> pairs = xml_.integers(array);
            if (pairs.empty() || pairs.size() % 2 != 0) continue;
            for (std::size_t i = 0; i < pairs.size(); i += 2)
                if (pairs[i + 1] >= 0 && pairs[i + 1] <= 3 && fits(pairs[i]))
                    out_.names.of_dimension[static_cast<std::size_t>(pairs[i + 1])].emplace(static_cast<std::int32_t>(pairs[i]), name);
        }
    }

    static bool fits(std::int64_t value) {
        return value >= std::numeric_limits<std::int32_t>::min() && value <= std::numeric_limits<std::int32_t>::max();
    }

    void read_points(pugi::xml_node piece) {
        const std::size_t count = xml_.count(piece, "NumberOfPoints");
        const pugi::xml_node array = VtkXml::find_array(piece.child("Points"), nullptr);
        if (!array) {
            if (count > 0) xml_.fail(piece, fmt::format("the piece has {} points, but no coordinates", count));
            return;
        }
        const std::vector<double> c = xml_.reals(array, &precision_);
        if (c.size() != 3 * count) xml_.fail(array, fmt::format("expected {} coordinates, found {}", 3 * count, c.size()));
        if (out_.points.size() + count > kMostVertices) xml_.fail(piece, "more points than 32-bit numbers hold");
        single_precision_ = single_precision_ || std::string_view(array.attribute("type").value()) == "Float32";
        out_.points.reserve(out_.points.size() + count);
        for (std::size_t i = 0; i < count; ++i) {
            if (!std::isfinite(c[3 * i]) || !std::isfinite(c[3 * i + 1]) || !std::isfinite(c[3 * i + 2]))
                xml_.fail(array, fmt::format("point {} (from 0) is not finite", i));
            out_.points.push_back({c[3 * i], c[3 * i + 1], c[3 * i + 2]});
        }
    }

    /// Cell data of that name; empty if there are none.
    template <std::size_t N>
    std::vector<std::int64_t> cell_data(pugi::xml_node piece, const std::array<const char*, N>& names, std::size_t cells) {
        for (const char* name : names) {
            const pugi::xml_node array = VtkXml::find_array(piece.child("CellData"), name);
            if (!array || array.attribute("NumberOfComponents").as_int(1) != 1) continue;
            std::vector<std::int64_t> values;
            if (std::string_view(array.attribute("type").value()).starts_with("Float")) {
                for (const double value : xml_.reals(array))
                    values.push_back(value == std::trunc(value) && std::abs(value) < 1e9 ? static_cast<std::int64_t>(value) : 0);
            } else {
                values = xml_.integers(array);
            }
            if (values.size() != cells) xml_.fail(array, fmt::format("the array '{}' has {} values for {} cells", name, values.size(), cells));
            for (const std::int64_t value : values)
                if (!fits(value)) xml_.fail(array, fmt::format("the value {} of the array '{}' doesn't fit 32 bits", value, name));
            return values;
        }
        return {};
    }

    struct CellData {
        std::vector<std::int64_t> markers, regions, entities;
        static std::int32_t at(const std::vector<std::int64_t>& values, std::size_t cell) {
            return values.empty() ? 0 : static_cast<std::int32_t>(values[cell]);
        }
    };
    CellData read_cell_data(pugi::xml_node piece, std::size_t cells) {
        return {cell_data(piece, kMarkerArrays, cells), cell_data(piece, kRegionArrays, cells), cell_data(piece, kEntityArrays, cells)};
    }

    /// Connectivity and offsets of a group of cells, the numbers checked.
    std::vector<std::vector<std::uint32_t>> read_connectivity(pugi::xml_node group, std::size_t cells) {
        std::vector<std::vector<std::uint32_t>> out;
        if (cells == 0) return out;
        const pugi::xml_node connectivity = VtkXml::find_array(group, "connectivity"), offsets = VtkXml::find_array(group, "offsets");
        if (!connectivity || !offsets) xml_.fail(group, fmt::format("<{}> has no arrays 'connectivity' and 'offsets'", group.name()));
        const std::vector<std::int64_t> numbers = xml_.integers(connectivity), ends = xml_.integers(offsets);
        if (ends.size() != cells) xml_.fail(offsets, fmt::format("expected the ends of {} cells, found {}", cells, ends.size()));
        const std::size_t points = out_.points.size() - first_point_;
        out.reserve(cells);
        std::int64_t at = 0;
        for (std::size_t c = 0; c < cells; ++c) {
            if (ends[c] < at || static_cast<std::uint64_t>(ends[c]) > numbers.size())
                xml_.fail(offsets, fmt::format("cell {} (from 0) ends at {}, which is out of range", c, ends[c]));
            auto& cell = out.emplace_back();
            cell.reserve(static_cast<std::size_t>(ends[c] - at));
            for (; at < ends[c]; ++at) {
                const std::int64_t number = numbers[static_cast<std::size_t>(at)];
                if (number < 0 || static_cast<std::uint64_t>(number) >= points)
                    xml_.fail(connectivity, fmt::format("cell {} (from 0) uses point {}, but the piece has {} points", c, number, points));
                cell.push_back(static_cast<std::uint32_t>(first_point_ + static_cast<std::size_t>(number)));
            }
        }
        return out;
    }

    void read_cells(pugi::xml_node piece) {
        const std::size_t cells = xml_.count(piece, "NumberOfCells");
        const pugi::xml_node group = piece.child("Cells");
        if (cells == 0) return;
        auto corners = read_connectivity(group, cells);
        const pugi::xml_node types_array = VtkXml::find_array(group, "types");
        if (!types_array) xml_.fail(group, "<Cells> has no array 'types'");
        const std::vector<std::int64_t> types = xml_.integers(types_array);
        if (types.size() != cells) xml_.fail(types_array, fmt::format("expected the types of {} cells, found {}", cells, types.size()));
        const CellData data = read_cell_data(piece, cells);
        for (std::size_t c = 0; c < cells; ++c) add_cell(types_array, c, types[c], std::move(corners[c]), data);
    }

    void add_cell(pugi::xml_node where, std::size_t cell, std::int64_t type, std::vector<std::uint32_t> c, const CellData& data) {
        const std::int32_t marker = CellData::at(data.markers, cell), entity = CellData::at(data.entities, cell);
        const auto need = [&](bool right) {
            if (!right) xml_.fail(where, fmt::format("cell {} (from 0) of VTK's type {} has {} points", cell, type, c.size()));
        };
        switch (type) {
            case 0:
                return;  // empty
            case 1:
            case 2:
                for (const std::uint32_t v : c) out_.vertices.add({v}, marker, entity);
                return;
            case 3:
            case 4:
                need(c.size() >= 2 && (type == 4 || c.size() == 2));
                for (std::size_t i = 1; i < c.size(); ++i) out_.lines.add({c[i - 1], c[i]}, marker, entity);
                return;
            case 5:
                need(c.size() == 3);
                break;
            case 7:
                need(c.size() >= 3);
                break;
            case 8:
                need(c.size() == 4);
                std::swap(c[2], c[3]);  // a pixel's corners come row by row
                break;
            case 9:
                need(c.size() == 4);
                break;
            case 10:
                need(c.size() == 4);
                return out_.tets.add({c[0], c[1], c[2], c[3]}, CellData::at(data.regions, cell), entity);
            default:
                return refuse(where, cell, type);
        }
        if (c.size() == 3) out_.triangles.add({c[0], c[1], c[2]}, marker, entity);
        else out_.polygons.add(std::move(c), marker, entity);
    }

    void refuse(pugi::xml_node where, std::size_t cell, std::int64_t type) const {
        const auto known = std::find_if(kRefused.begin(), kRefused.end(), [&](const VtkType& t) { return t.type == type; });
        if (as_surface_ && known != kRefused.end() && known->volume) return;
        xml_.fail(where, fmt::format("cell {} (from 0) {}; only vertices, lines, triangles, polygons and tetrahedra of first order are read", cell,
                                     known != kRefused.end() ? fmt::format("is a {}", known->name) : fmt::format("has VTK's type {}", type)));
    }

    void read_poly_data(pugi::xml_node piece) {
        const auto count = [&](const char* attribute) { return piece.attribute(attribute) ? xml_.count(piece, attribute) : 0; };
        if (count("NumberOfStrips") > 0) xml_.fail(piece, "triangle strips are not read; save the surface as triangles");
        struct Group {
            const char *attribute, *element;
            std::int64_t type;
        };
        constexpr std::array<Group, 3> kGroups{{{"NumberOfVerts", "Verts", 2}, {"NumberOfLines", "Lines", 4}, {"NumberOfPolys", "Polys", 7}}};
        std::size_t all = 0, cell = 0;
        for (const Group& group : kGroups) all += count(group.attribute);
        const CellData data = read_cell_data(piece, all);
        for (const Group& group : kGroups) {
            const pugi::xml_node element = piece.child(group.element);
            for (auto& corners : read_connectivity(element, count(group.attribute))) add_cell(element, cell++, group.type, std::move(corners), data);
        }
    }

    void read_point_data(pugi::xml_node piece) {
        const std::size_t count = out_.points.size() - first_point_;
        for (const pugi::xml_node array : piece.child("PointData").children("DataArray")) {
            const std::string name = array.attribute("Name").value();
            if (array.attribute("NumberOfComponents").as_int(1) != 1 || std::string_view(array.attribute("type").value()) == "String") continue;
            if (name == "marker") add_vertex_markers(array, count);
            if (name == "mesh_vertex") {
                const std::vector<std::int64_t> numbers = xml_.integers(array);
                mesh_vertices_.insert(mesh_vertices_.end(), numbers.begin(), numbers.end());
            }
            const std::vector<double> values = xml_.reals(array);
            if (values.size() != count) xml_.fail(array, fmt::format("the array '{}' has {} values for {} points", name, values.size(), count));
            auto& field = out_.fields[name];
            field.resize(first_point_, std::numeric_limits<double>::quiet_NaN());
            field.insert(field.end(), values.begin(), values.end());
        }
    }

    void add_vertex_markers(pugi::xml_node array, std::size_t count) {
        if (std::string_view(array.attribute("type").value()).starts_with("Float")) return;
        const std::vector<std::int64_t> markers = xml_.integers(array);
        for (std::size_t v = 0; v < std::min(count, markers.size()); ++v)
            if (markers[v] != 0 && fits(markers[v]))
                out_.vertices.add({static_cast<std::uint32_t>(first_point_ + v)}, static_cast<std::int32_t>(markers[v]), 0);
    }

    const SourceFile& source_;
    VtkXml xml_;
    TextPrecision precision_;
    bool as_surface_, single_precision_ = false;
    std::size_t first_point_ = 0;
    std::vector<std::int64_t> mesh_vertices_;
    MixedMesh out_;
};

/// The constraints of NAME.boundary.vtu, over the vertices of NAME.vtu.
void add_boundary(MixedMesh& mesh, const SourceFile& source) {
    VtkReader reader(source, "UnstructuredGrid", false);
    MixedMesh boundary = reader.read(false);
    const std::vector<std::int64_t>& vertex = reader.mesh_vertices();
    if (vertex.size() != boundary.points.size()) fail_in_file(source, "the file has no point data 'mesh_vertex', one number a point");
    for (std::size_t i = 0; i < vertex.size(); ++i)
        if (vertex[i] < 0 || static_cast<std::uint64_t>(vertex[i]) >= mesh.points.size() ||
            !(mesh.points[static_cast<std::size_t>(vertex[i])] == boundary.points[i]))
            fail_in_file(
                source, fmt::format("point {} (from 0) is not vertex {} of the mesh beside: the two files belong to different meshes", i, vertex[i]));
    const auto move_cells = [&](auto& from, auto& to) {
        for (std::size_t i = 0; i < from.corners.size(); ++i) {
            for (std::uint32_t& v : from.corners[i]) v = static_cast<std::uint32_t>(vertex[v]);
            to.add(std::move(from.corners[i]), from.markers[i], from.entities[i]);
        }
    };
    move_cells(boundary.lines, mesh.lines);
    move_cells(boundary.triangles, mesh.triangles);
    move_cells(boundary.polygons, mesh.polygons);
    for (std::size_t d = 0; d < 4; ++d) mesh.names.of_dimension[d].merge(boundary.names.of_dimension[d]);
}

}  // namespace

MixedMesh read_vtu(const SourceFile& source, bool as_surface) { return VtkReader(source, "UnstructuredGrid", as_surface).read(false); }

TetMesh read_vtu_mesh(const SourceFile& source) {
    MixedMesh mesh = read_vtu(source, false);
    std::filesystem::path beside = source.path;
    beside.replace_extension(".boundary.vtu");
    if (std::filesystem::exists(beside)) add_boundary(mesh, read_source(beside, source.threads));
    return to_tet_mesh(std::move(mesh), source);
}

Plc read_vtu_surface(const SourceFile& source) { return to_plc(read_vtu(source, true), source); }

Plc read_vtp_surface(const SourceFile& source) { return to_plc(VtkReader(source, "PolyData", true).read(true), source); }

}  // namespace wellmesh::io
