// SPDX-License-Identifier: Apache-2.0
// Flag <-> option field. No default of its own: what --help prints is read from the structs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "wellmesh/certificate.hpp"
#include "wellmesh/io.hpp"
#include "wellmesh/options.hpp"

namespace CLI {
class App;
class Option;
}

namespace wellmesh::cli {

/// Extension in lower case, with its dot.
[[nodiscard]] std::string lower_extension(const std::filesystem::path& path);

struct GoalFlags {
    const CLI::Option *radius_edge = nullptr, *dihedral = nullptr;
};
/// Size and shape.
GoalFlags add_goal_flags(CLI::App& command, MeshOptions& options);
void add_seed_flag(CLI::App& command, MeshOptions& options);
void add_threads_flag(CLI::App& command, unsigned& threads);  ///< --threads
void add_seeding_flag(CLI::App& command, MeshOptions& options);
/// Coplanar tolerance, time and vertices.
void add_limit_flags(CLI::App& command, MeshOptions& options);
/// All of these, and what concerns meshes made from scratch.
void add_mesh_flags(CLI::App& command, MeshOptions& options);
void add_coplanar_tolerance_flag(CLI::App& command, MeshOptions& options);
void add_write_flags(CLI::App& command, WriteOptions& options);
void add_certify_flags(CLI::App& command, CertifyOptions& options);
void add_json_flag(CLI::App& command, std::string& path);
void add_output_flag(CLI::App& command, std::vector<std::string>& paths, const std::string& what);

/// @throws CLI::ValidationError{flag} that names the strategies.
[[nodiscard]] SliverStrategy read_strategy(const std::string& text, const std::string& flag);

/// @throws MeshError{bad_options} that lists every value out of its range.
void require_valid(const MeshOptions& options);
void require_valid(const CertifyOptions& options);
void require_valid(const WriteOptions& options);

/// @throws MeshError{bad_options} for an unknown extension, a file named twice, or one that would replace an input file;
///         MeshError{cannot_write} for what can be known to fail.
void require_mesh_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);

/// The part of it that concerns no format. @param problems  found already, listed with the others
void require_outputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs, std::vector<std::string> problems = {});

/// @throws MeshError{bad_options} if the report of this flag would replace one of `others`, MeshError{cannot_write} for what can be known
///         to fail. An empty name is no report.
void require_report(const std::string& flag, const std::string& report, const std::vector<std::string>& others);

}  // namespace wellmesh::cli
