// SPDX-License-Identifier: Apache-2.0
// What the commands that make a mesh have in common: progress, files, reports, exit status.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "interrupt.hpp"
#include "wellmesh/io.hpp"
#include "wellmesh/options.hpp"
#include "wellmesh/result.hpp"
#include "wellmesh/run_control.hpp"

namespace CLI {
class App;
}

namespace wellmesh::cli {

struct MeshJob {
    std::string command;              ///< name in reports
    std::vector<std::string> inputs;  ///< files that are read, the one that reports name first
    std::vector<std::string> outputs;
    std::string background;           ///< a mesh with sizes; empty: none
    std::string exemptions;           ///< file for the tetrahedra that acute angles force below the goals; empty: none
    std::string json;
    bool quiet = false;
    MeshOptions options{};
    WriteOptions write{};
};

/// -o, --msh-version, --exemptions, --json and --quiet.
void add_job_flags(CLI::App& command, MeshJob& job);

/// --background.
void add_background_flag(CLI::App& command, MeshJob& job);
/// Reads it, if there is one. @throws MeshError
void read_background(MeshJob& job);

/// Have all goals been met, with no claim refuted?
[[nodiscard]] bool goals_met(const MeshResult& result);

/// Checks options and files, then reads, makes the mesh, writes it and reports.
/// @param read  reads the inputs; a signal ends the program meanwhile. @return the exit status. @throws MeshError
int produce_mesh(const MeshJob& job, Interrupt& interrupt, const std::function<void()>& read, const std::function<MeshResult(const RunControl&)>& make);

}  // namespace wellmesh::cli
