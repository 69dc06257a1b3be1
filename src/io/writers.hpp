// SPDX-License-Identifier: Apache-2.0
// One writer a format. They fill files that the caller commits. Output depends on the mesh alone: no date, no locale.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "io/atomic_file.hpp"
#include "wellmesh/io.hpp"
#include "wellmesh/diagnosis.hpp"
#include "wellmesh/plc.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh::io {

/// @param required  vertices listed as RequiredVertices
void write_medit(const TetMesh& mesh, References references, const std::vector<std::uint32_t>& required, OutputFile& out);
/// MEDIT's solution format: one scalar a vertex.
void write_medit_weights(const std::vector<double>& weights, OutputFile& out);
/// Adds NAME.vtu and NAME.boundary.vtu.
void write_vtu(const TetMesh& mesh, const std::filesystem::path& path, OutputSet& files);
void write_abaqus(const TetMesh& mesh, OutputFile& out);
void write_msh41(const TetMesh& mesh, OutputFile& out);
void write_msh22(const TetMesh& mesh, OutputFile& out);
/// Adds .node, .ele, .face and .edge, named after `path`.
void write_tetgen(const TetMesh& mesh, const std::filesystem::path& path, OutputSet& files);
void write_poly(const Plc& plc, OutputFile& out);
void write_smesh(const Plc& plc, OutputFile& out);
void write_off(const Plc& plc, OutputFile& out);
void write_obj(const Plc& plc, OutputFile& out);
void write_ply(const Plc& plc, OutputFile& out);
void write_stl(const Plc& plc, OutputFile& out);         ///< text; facets are triangles
void write_binary_stl(const Plc& plc, OutputFile& out);  ///< float32; facets are triangles
void write_medit_surface(const Plc& plc, OutputFile& out);             ///< facets are triangles
void write_msh_surface(const Plc& plc, int version, OutputFile& out);  ///< facets are triangles
void write_vtp(const Plc& plc, OutputFile& out);
/// Where defects are, as .vtp.
void write_trouble_spots(const Diagnosis& diagnosis, OutputFile& out);

}  // namespace wellmesh::io
