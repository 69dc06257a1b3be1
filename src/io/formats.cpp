// SPDX-License-Identifier: Apache-2.0
// Which reader or writer a file's extension names.
#include <string>

#include <fmt/format.h>

#include "io/readers.hpp"
#include "io/writers.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh {
namespace {

[[noreturn]] void unknown_format(ErrorCode code, Stage stage, const char* doing, const std::filesystem::path& path, const char* known) {
    throw MeshError(code, stage, fmt::format("cannot {} {}: the extension names no known format; known are {}", doing, path.string(), known),
                    {{EntityKind::file, 0, {}}});
}

/// A mesh whose parallel arrays disagree would make writers read beyond their ends.
void check_lengths(const TetMesh& mesh) {
    if (mesh.tet_regions.size() != mesh.tets.size() || mesh.subface_facets.size() != mesh.subfaces.size() ||
        mesh.subface_markers.size() != mesh.subfaces.size() || mesh.subsegment_segments.size() != mesh.subsegments.size())
        throw MeshError(ErrorCode::bad_input, Stage::write, "the mesh's arrays of one kind of element differ in length");
    const auto check = [&](const auto& elements, EntityKind kind) {
        for (std::size_t i = 0; i < elements.size(); ++i)
            for (const std::uint32_t v : elements[i])
                if (v >= mesh.vertices.size())
                    throw MeshError(ErrorCode::bad_input, Stage::write,
                                    fmt::format("{} {} of the mesh uses vertex {}, but there are only {}", to_string(kind), i, v, mesh.vertices.size()),
                                    {{kind, i, {}}});
    };
    check(mesh.tets, EntityKind::tetrahedron);
    check(mesh.subfaces, EntityKind::triangle);
    check(mesh.subsegments, EntityKind::edge);
}

}  // namespace

Plc read_plc(const std::filesystem::path& path) {
    const std::string extension = io::lower_case_extension(path);
    Plc (*const reader)(const io::SourceFile&) = extension == ".off"     ? io::read_off
                                                 : extension == ".stl"   ? io::read_stl
                                                 : extension == ".poly"  ? io::read_poly
                                                 : extension == ".smesh" ? io::read_smesh
                                                                         : nullptr;
    if (reader == nullptr) unknown_format(ErrorCode::cannot_read, Stage::read, "read", path, ".off .stl .obj .ply .poly .smesh .mesh");
    return reader(io::read_source(path));
}

std::vector<std::filesystem::path> write_mesh(const TetMesh& mesh, const std::filesystem::path& path, const WriteOptions&) {
    const std::string extension = io::lower_case_extension(path);
    check_lengths(mesh);
    io::OutputSet files;
    if (extension == ".mesh")
        io::write_medit(mesh, files.add(path));
    else
        unknown_format(ErrorCode::cannot_write, Stage::write, "write", path, ".mesh .vtu .msh .node .ele");
    return files.commit();
}

}  // namespace wellmesh
