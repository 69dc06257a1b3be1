// SPDX-License-Identifier: Apache-2.0
// Which reader or writer a file's extension names.
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "io/plc_formats.hpp"
#include "io/readers.hpp"
#include "io/writers.hpp"
#include "wellmesh/convert.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh {
namespace {

[[noreturn]] void unknown_format(ErrorCode code, Stage stage, const char* doing, const std::filesystem::path& path, const char* known) {
    throw MeshError(code, stage, fmt::format("cannot {} {}: the extension names no known format; known are {}", doing, path.string(), known),
                    {{EntityKind::file, 0, {}}});
}

[[noreturn]] void bad_output(EntityKind kind, std::uint64_t number, const std::string& what) {
    throw MeshError(ErrorCode::bad_input, Stage::write, fmt::format("cannot write: {} {}", to_string(kind), what), {{kind, number, {}}});
}

void check_finite(const std::vector<Vec3>& vertices) {
    for (std::size_t v = 0; v < vertices.size(); ++v)
        if (!std::isfinite(vertices[v].x) || !std::isfinite(vertices[v].y) || !std::isfinite(vertices[v].z))
            bad_output(EntityKind::vertex, v, fmt::format("{} (from 0) is not finite", v));
}

void check_corner(std::uint32_t vertex, std::size_t vertices, EntityKind kind, std::size_t number) {
    if (vertex >= vertices) bad_output(kind, number, fmt::format("{} (from 0) uses vertex {}, but there are only {}", number, vertex, vertices));
}

void check_writable(const WriteOptions& options) {
    if (options.msh_version != 41 && options.msh_version != 22)
        throw MeshError(ErrorCode::bad_options, Stage::write, fmt::format("msh_version is 41 or 22, not {}", options.msh_version));
}

/// Arrays that disagree would make the writers read beyond their ends.
void check_writable(const TetMesh& mesh) {
    if (mesh.tet_regions.size() != mesh.tets.size() || mesh.subface_facets.size() != mesh.subfaces.size() ||
        mesh.subface_markers.size() != mesh.subfaces.size() || mesh.subsegment_segments.size() != mesh.subsegments.size() ||
        (!mesh.subsegment_markers.empty() && mesh.subsegment_markers.size() != mesh.subsegments.size()) ||
        (!mesh.vertex_markers.empty() && mesh.vertex_markers.size() != mesh.vertices.size()))
        throw MeshError(ErrorCode::bad_input, Stage::write, "cannot write: the mesh's arrays of one kind of element differ in length");
    check_finite(mesh.vertices);
    if (!mesh.weights.empty() && mesh.weights.size() != mesh.vertices.size())
        throw MeshError(ErrorCode::bad_input, Stage::write, "cannot write: the mesh has another number of weights than of vertices");
    for (std::size_t v = 0; v < mesh.weights.size(); ++v)
        if (!std::isfinite(mesh.weights[v])) bad_output(EntityKind::vertex, v, fmt::format("{} (from 0) has a weight that is not finite", v));
    const auto check = [&](const auto& elements, EntityKind kind) {
        for (std::size_t i = 0; i < elements.size(); ++i)
            for (const std::uint32_t v : elements[i]) check_corner(v, mesh.vertices.size(), kind, i);
    };
    check(mesh.tets, EntityKind::tetrahedron);
    check(mesh.subfaces, EntityKind::triangle);
    check(mesh.subsegments, EntityKind::edge);
}

void check_writable(const Plc& plc) {
    if (!plc.vertex_markers.empty() && plc.vertex_markers.size() != plc.vertices.size())
        throw MeshError(ErrorCode::bad_input, Stage::write, "cannot write: the complex has another number of vertex markers than of vertices");
    check_finite(plc.vertices);
    check_finite(plc.hole_seeds);
    for (std::size_t f = 0; f < plc.facets.size(); ++f) {
        check_finite(plc.facets[f].holes);
        for (const auto& polygon : plc.facets[f].polygons)
            for (const std::uint32_t v : polygon) check_corner(v, plc.vertices.size(), EntityKind::facet, f);
    }
    for (std::size_t s = 0; s < plc.segments.size(); ++s)
        for (const std::uint32_t v : plc.segments[s].vertices) check_corner(v, plc.vertices.size(), EntityKind::segment, s);
    for (const RegionSeed& seed : plc.region_seeds) {
        check_finite({seed.point});
        if (!std::isfinite(seed.max_volume)) bad_output(EntityKind::region, 0, "has a volume bound that is not finite");
    }
}

}  // namespace

Plc read_plc(const std::filesystem::path& path, const ReadOptions& options) {
    const std::string extension = io::lower_case_extension(path);
    Plc (*const reader)(const io::SourceFile&) = extension == ".off"     ? io::read_off
                                                 : extension == ".stl"   ? io::read_stl
                                                 : extension == ".obj"   ? io::read_obj
                                                 : extension == ".ply"   ? io::read_ply
                                                 : extension == ".poly"  ? io::read_poly
                                                 : extension == ".smesh" ? io::read_smesh
                                                 : extension == ".mesh"  ? io::read_medit_surface
                                                 : extension == ".msh"   ? io::read_msh_surface
                                                 : extension == ".vtp"   ? io::read_vtp_surface
                                                 : extension == ".vtu"   ? io::read_vtu_surface
                                                                         : nullptr;
    if (reader == nullptr) unknown_format(ErrorCode::cannot_read, Stage::read, "read", path, ".off .stl .obj .ply .poly .smesh .mesh .msh .vtp .vtu");
    return reader(io::read_source(path, options.threads));
}

std::vector<Vec3> read_points(const std::filesystem::path& path, const ReadOptions& options) {
    const std::string extension = io::lower_case_extension(path);
    std::vector<Vec3> (*const reader)(const io::SourceFile&) = extension == ".node"  ? io::read_node_points
                                                               : extension == ".xyz" ? io::read_xyz_points
                                                               : extension == ".ply" ? io::read_ply_points
                                                                                     : nullptr;
    if (reader == nullptr) unknown_format(ErrorCode::cannot_read, Stage::read, "read points from", path, ".node .xyz .ply");
    return reader(io::read_source(path, options.threads));
}

TetMesh read_mesh(const std::filesystem::path& path, const ReadOptions& options) {
    const std::string extension = io::lower_case_extension(path);
    if (extension == ".mesh") return io::read_medit_mesh(io::read_source(path, options.threads));
    if (extension == ".msh") return io::read_msh_mesh(io::read_source(path, options.threads));
    if (extension == ".vtu") return io::read_vtu_mesh(io::read_source(path, options.threads));
    if (extension == ".node" || extension == ".ele") return io::read_tetgen_mesh(path, options.threads);
    unknown_format(ErrorCode::cannot_read, Stage::read, "read a mesh from", path, ".mesh .msh .vtu .node .ele");
}

BackgroundMesh read_background_mesh(const std::filesystem::path& path, const ReadOptions& options) {
    const std::string extension = io::lower_case_extension(path);
    if (extension == ".node" || extension == ".ele" || extension == ".mtr") return io::read_tetgen_background(path, options.threads);
    if (extension != ".msh" && extension != ".vtu") unknown_format(ErrorCode::cannot_read, Stage::read, "read sizes from", path, ".msh .vtu .node .ele .mtr");
    const io::SourceFile source = io::read_source(path, options.threads);
    return io::read_background(source, extension == ".msh" ? io::read_msh(source, false) : io::read_vtu(source, false));
}

std::vector<double> read_weights(const std::filesystem::path& path, std::size_t vertices, const ReadOptions& options) {
    const std::string extension = io::lower_case_extension(path);
    if (extension != ".sol" && extension != ".node") unknown_format(ErrorCode::cannot_read, Stage::read, "read weights from", path, ".sol .node");
    const io::SourceFile source = io::read_source(path, options.threads);
    std::vector<double> weights = extension == ".sol" ? io::read_medit_weights(source) : io::read_node_weights(source);
    if (weights.size() != vertices) io::fail_in_file(source, fmt::format("the file has {} weights, the mesh {} vertices", weights.size(), vertices));
    return weights;
}

std::vector<std::filesystem::path> write_mesh(const TetMesh& mesh, const std::filesystem::path& path, const WriteOptions& options) {
    const std::string extension = io::lower_case_extension(path);
    check_writable(options);
    check_writable(mesh);
    io::OutputSet files(options.stop, options.sync, options.threads);
    if (extension == ".mesh") {
        io::write_medit(mesh, options.references, {}, files.add(path));
        const auto weights = std::filesystem::path(path).replace_extension(".weights.sol");
        if (mesh.weights.empty()) files.drop(weights);
        else io::write_medit_weights(mesh.weights, files.add(weights));
    } else if (extension == ".vtu")
        io::write_vtu(mesh, path, files);
    else if (extension == ".msh")
        (options.msh_version == 41 ? io::write_msh41 : io::write_msh22)(mesh, files.add(path));
    else if (extension == ".inp")
        io::write_abaqus(mesh, files.add(path));
    else if (extension == ".node" || extension == ".ele")
        io::write_tetgen(mesh, path, files);
    else
        unknown_format(ErrorCode::cannot_write, Stage::write, "write", path, ".mesh .vtu .msh .inp .node .ele");
    return files.commit();
}

std::vector<std::filesystem::path> write_plc(const Plc& plc, const std::filesystem::path& path, const WriteOptions& options) {
    const std::string extension = io::lower_case_extension(path);
    const io::PlcFormat* const format = io::find_plc_format(extension);
    if (format == nullptr) unknown_format(ErrorCode::cannot_write, Stage::write, "write a complex to", path, ".poly .smesh .off .obj .ply .stl .mesh .msh .vtp");
    check_writable(options);
    check_writable(plc);
    io::OutputSet files(options.stop, options.sync, options.threads);
    const bool needs_simple = format->most_corners > 0;
    const Plc simple = needs_simple ? with_simple_facets(plc, format->most_corners) : Plc{};
    const Plc& out = needs_simple ? simple : plc;
    io::OutputFile& file = files.add(path);
    if (extension == ".stl") (options.binary_stl ? io::write_binary_stl : io::write_stl)(out, file);
    else if (extension == ".msh") io::write_msh_surface(out, options.msh_version, file);
    else format->write(out, file);
    return files.commit();
}

bool holds_mesh(const std::filesystem::path& path, const ReadOptions& options) {
    const std::string extension = io::lower_case_extension(path);
    if (extension == ".node" || extension == ".ele") return true;
    if (extension == ".mesh") return io::has_medit_tetrahedra(io::read_source(path, options.threads));
    if (extension == ".msh") return !io::read_msh(io::read_source(path, options.threads), true).tets.corners.empty();
    if (extension == ".vtu") return !io::read_vtu(io::read_source(path, options.threads), true).tets.corners.empty();
    return false;
}

void write_trouble_spots(const Diagnosis& diagnosis, const std::filesystem::path& path) {
    if (io::lower_case_extension(path) != ".vtp") unknown_format(ErrorCode::cannot_write, Stage::write, "write trouble spots to", path, ".vtp");
    io::OutputSet files;
    io::write_trouble_spots(diagnosis, files.add(path));
    files.commit();
}

}  // namespace wellmesh
