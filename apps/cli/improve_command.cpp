// SPDX-License-Identifier: Apache-2.0
// wellmesh improve: better angles for a mesh that any tool made.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>

#include "commands.hpp"
#include "flags.hpp"
#include "produce_mesh.hpp"
#include "wellmesh/improve.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::cli {

void add_improve_command(CLI::App& program, Command& selected) {
    CLI::App& command = *program.add_subcommand("improve", "raise the smallest dihedral angle of a mesh that any tool made; Delaunay and certified afterwards");
    const auto job = std::make_shared<MeshJob>();
    job->command = "improve";
    job->inputs.resize(2);
    command.add_option("MESH", job->inputs[0], "tetrahedral mesh of any tool: .mesh (ASCII) .msh .vtu .node/.ele")->required()->type_name("");
    command.add_option("--plc", job->inputs[1], "the domain that the mesh fills: .poly .smesh .off .stl .obj .ply .mesh .msh .vtp .vtu")->required()->type_name("FILE");
    add_goal_flags(command, job->options);
    add_seed_flag(command, job->options);
    add_threads_flag(command, job->options.threads);
    add_limit_flags(command, job->options);
    add_background_flag(command, *job);
    add_job_flags(command, *job);
    command.callback([&selected, job] {
        selected = [job](Interrupt& interrupt) {
            TetMesh mesh;
            Plc plc;
            const auto read = [&] {
                mesh = read_mesh(job->inputs[0], {.threads = job->options.threads});
                plc = read_plc(job->inputs[1], {.threads = job->options.threads});
                read_background(*job);
            };
            return produce_mesh(*job, interrupt, read, [&](const RunControl& control) { return improve(mesh, plc, job->options, control); });
        };
    });
}

}  // namespace wellmesh::cli
