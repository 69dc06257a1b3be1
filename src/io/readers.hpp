// SPDX-License-Identifier: Apache-2.0
// One reader a format. All throw MeshError{bad_input} with file, line (byte or element for binary data) and token.
#pragma once

#include <vector>

#include "io/mixed_mesh.hpp"
#include "io/source_file.hpp"
#include "wellmesh/io.hpp"
#include "wellmesh/plc.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh::io {

[[nodiscard]] Plc read_off(const SourceFile& source);
[[nodiscard]] Plc read_stl(const SourceFile& source);
[[nodiscard]] Plc read_obj(const SourceFile& source);
[[nodiscard]] Plc read_ply(const SourceFile& source);
[[nodiscard]] Plc read_poly(const SourceFile& source);           ///< .poly
[[nodiscard]] Plc read_smesh(const SourceFile& source);          ///< .smesh
[[nodiscard]] Plc read_medit_surface(const SourceFile& source);  ///< triangles and quadrilaterals of a .mesh
[[nodiscard]] Plc read_msh_surface(const SourceFile& source);
[[nodiscard]] Plc read_vtu_surface(const SourceFile& source);
[[nodiscard]] Plc read_vtp_surface(const SourceFile& source);

[[nodiscard]] std::vector<Vec3> read_node_points(const SourceFile& source);
[[nodiscard]] std::vector<Vec3> read_xyz_points(const SourceFile& source);
[[nodiscard]] std::vector<Vec3> read_ply_points(const SourceFile& source);

[[nodiscard]] TetMesh read_medit_mesh(const SourceFile& source);
[[nodiscard]] bool has_medit_tetrahedra(const SourceFile& source);
[[nodiscard]] TetMesh read_msh_mesh(const SourceFile& source);
[[nodiscard]] TetMesh read_vtu_mesh(const SourceFile& source);  ///< with NAME.boundary.vtu, if it stands beside
/// .node and .ele, and .face and .edge where they exist. @param path  the .node or the .ele file. @param threads  as in SourceFile
[[nodiscard]] TetMesh read_tetgen_mesh(const std::filesystem::path& path, unsigned threads);

/// Sizes of a .mtr file. @param points  how many there must be
[[nodiscard]] std::vector<double> read_mtr(const SourceFile& source, std::size_t points);
/// .node, .ele and .mtr. @param path  any of the three. @param threads  as in SourceFile
[[nodiscard]] BackgroundMesh read_tetgen_background(const std::filesystem::path& path, unsigned threads);
/// @param as_surface  volume cells other than tetrahedra are passed over; else they are errors
[[nodiscard]] MixedMesh read_msh(const SourceFile& source, bool as_surface);
[[nodiscard]] MixedMesh read_vtu(const SourceFile& source, bool as_surface);
[[nodiscard]] BackgroundMesh read_background(const SourceFile& source, MixedMesh mesh);

[[nodiscard]] std::vector<double> read_medit_weights(const SourceFile& source);  ///< .sol
[[nodiscard]] std::vector<double> read_node_weights(const SourceFile& source);   ///< first attribute of a .node

}  // namespace wellmesh::io
