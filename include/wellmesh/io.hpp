// SPDX-License-Identifier: Apache-2.0
// Files. Formats go by extension; errors name file, line and token. Writers write a temporary file and rename it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <stop_token>
#include <vector>

#include "wellmesh/background_mesh.hpp"
#include "wellmesh/diagnosis.hpp"
#include "wellmesh/error.hpp"
#include "wellmesh/exemption.hpp"
#include "wellmesh/plc.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh {

struct ReadOptions {
    unsigned threads = 0;  ///< that parse text, the caller's among them; 0: as many as the machine has cores. Never changes what is read, nor the errors
};

/// Reads .off .stl .obj .ply .poly .smesh (a .node beside them as they ask; sizes of vertices from a .mtr beside .poly and .smesh), or points, edges and
/// faces of a .mesh, .msh, .vtp or .vtu.
/// @throws MeshError  cannot_read, bad_input (file, line, token).
[[nodiscard]] Plc read_plc(const std::filesystem::path& path, const ReadOptions& options = {});

/// Reads points only: .node .xyz .ply.
[[nodiscard]] std::vector<Vec3> read_points(const std::filesystem::path& path, const ReadOptions& options = {});

/// Reads a tetrahedral mesh: MEDIT .mesh (ASCII), Gmsh .msh (2.x, 4.1), .vtu (with NAME.boundary.vtu where it stands beside), .node/.ele.
[[nodiscard]] TetMesh read_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// Reads a mesh with target edge lengths at its vertices: TetGen's .node, .ele and .mtr (any of the three names them), $NodeData of a .msh or point
/// data of a .vtu, one number a vertex. Of several fields one named `size`, `target_size` or `h` is taken, else the only one.
/// @throws MeshError  cannot_read, bad_input (file, line, token; no such field, a vertex without a size, a size below 0).
[[nodiscard]] BackgroundMesh read_background_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// Reads the weights of a mesh's vertices: MEDIT's solution format (.sol, one scalar a vertex), or the attribute of a .node.
/// @param vertices  how many there must be. @throws MeshError  cannot_read, bad_input (file, line, token).
[[nodiscard]] std::vector<double> read_weights(const std::filesystem::path& path, std::size_t vertices, const ReadOptions& options = {});

/// What the references of a MEDIT .mesh say.
enum class References {
    entity,  ///< the number, from 1, of the input vertex, segment or facet; 0 for vertices that are not the input's
    marker   ///< the input's marker of it
};

/// Which flavour of a format to write where there are several.
struct WriteOptions {
    int msh_version = 41;    ///< 41 or 22
    References references = References::entity;
    bool binary_stl = false;
    bool sync = false;       ///< force the data to the disk before a file appears under its name
    unsigned threads = 0;    ///< that format, the caller's among them; 0: as many as the machine has cores. Never changes the files
    std::stop_token stop{};  ///< polled while writing; when requested: MeshError{cancelled}, and no file is left
};

/// Writes .mesh, .vtu (and NAME.boundary.vtu), .msh, .inp, or .node/.ele/.face/.edge (named after the .node or .ele path). Where the mesh has weights they are a point field of
/// a .vtu, node data of a .msh, the attribute of a .node, and beside a .mesh a .sol file (docs/conventions.md).
/// @return the files written. @throws MeshError  cannot_write; then no file is left half written.
std::vector<std::filesystem::path> write_mesh(const TetMesh& mesh, const std::filesystem::path& path, const WriteOptions& options = {});

/// Writes a complex as .poly .smesh .off .obj .ply .stl .mesh .msh .vtp. What the format can't state (not_carried(), convert.hpp) is left out; facets of
/// several polygons or with holes become triangles where it has none, polygons of more than three corners where it has but triangles.
/// @return the files written. @throws MeshError  cannot_write; bad_input: a facet that can't be triangulated.
std::vector<std::filesystem::path> write_plc(const Plc& plc, const std::filesystem::path& path, const WriteOptions& options = {});

/// Writes a line for each: number of the tetrahedron, from 1, kind and number of the input feature, its angle [deg], and where it is. Lines that begin
/// with # are comments. @return the file written. @throws MeshError  cannot_write.
std::vector<std::filesystem::path> write_exemptions(const std::vector<Exemption>& exemptions, const std::filesystem::path& path, const WriteOptions& options = {});
/// Reads such a file, of any tool: the first number of each line counts. @param tets  how many the mesh has.
/// @return numbers from 0, ascending, for CertifyOptions::exempt. @throws MeshError  cannot_read, bad_input (file, line, token).
[[nodiscard]] std::vector<std::uint64_t> read_exemptions(const std::filesystem::path& path, std::size_t tets);

/// Whether a file is a tetrahedral mesh: a .node or .ele, or a .mesh, .msh or .vtu with tetrahedra. @throws as read_mesh
[[nodiscard]] bool holds_mesh(const std::filesystem::path& path, const ReadOptions& options = {});

/// Writes where the defects of `diagnosis` are as .vtp (VTK polygonal data): points, lines and triangles with the cell data severity (0 note, 1 warning,
/// 2 error), kind (position in DefectKind), defect (position in the list) and value. @throws MeshError  cannot_write.
void write_trouble_spots(const Diagnosis& diagnosis, const std::filesystem::path& path);

}  // namespace wellmesh
