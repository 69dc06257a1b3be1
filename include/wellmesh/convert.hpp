// SPDX-License-Identifier: Apache-2.0
// From one format to another, and what gets lost on the way.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "wellmesh/io.hpp"
#include "wellmesh/plc.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh {

/// The same complex with facets that simple formats can state: one polygon of 3 to `most_corners` corners each. Other facets (several polygons,
/// holes, more corners) become the triangles that cover them, turned as the largest polygon; segments and points within them stay as such.
/// @throws MeshError{bad_input}  a facet whose edges cross, or that encloses no area.
[[nodiscard]] Plc with_simple_facets(const Plc& plc, std::size_t most_corners);

/// What a file of the format that `path` names can't carry of this, a sentence each; empty if it carries everything.
[[nodiscard]] std::vector<std::string> not_carried(const Plc& plc, const std::filesystem::path& path, const WriteOptions& options = {});
[[nodiscard]] std::vector<std::string> not_carried(const TetMesh& mesh, const std::filesystem::path& path, const WriteOptions& options = {});

}  // namespace wellmesh
