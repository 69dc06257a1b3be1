// SPDX-License-Identifier: Apache-2.0
// One writer a format. They fill files that the caller commits. Output depends on the mesh alone: no date, no locale.
#pragma once

#include <filesystem>
#include <vector>

#include "io/atomic_file.hpp"
#include "wellmesh/plc.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh::io {

void write_medit(const TetMesh& mesh, OutputFile& out);
/// MEDIT's solution format: one scalar a vertex.
void write_medit_weights(const std::vector<double>& weights, OutputFile& out);
void write_vtu(const TetMesh& mesh, OutputFile& out);
void write_msh41(const TetMesh& mesh, OutputFile& out);
void write_msh22(const TetMesh& mesh, OutputFile& out);
/// Adds .node, .ele, .face and .edge, named after `path`.
void write_tetgen(const TetMesh& mesh, const std::filesystem::path& path, OutputSet& files);
void write_poly(const Plc& plc, OutputFile& out);

}  // namespace wellmesh::io
