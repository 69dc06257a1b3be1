// SPDX-License-Identifier: Apache-2.0
// wellmesh mesh: a polyhedral domain in, a certified mesh out.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>

#include "commands.hpp"
#include "flags.hpp"
#include "produce_mesh.hpp"
#include "seed_flags.hpp"
#include "wellmesh/generate.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::cli {

void add_mesh_command(CLI::App& program, Command& selected) {
    CLI::App& command = *program.add_subcommand("mesh", "fill a polyhedral domain with a certified Delaunay mesh");
    const auto job = std::make_shared<MeshJob>();
    job->command = "mesh";
    job->inputs.resize(1);
    command.add_option("INPUT", job->inputs[0], "domain: .poly .smesh .off .stl .obj .ply .mesh .msh .vtp .vtu")->required()->type_name("");
    add_mesh_flags(command, job->options);
    add_background_flag(command, *job);
    const auto seeds = std::make_shared<SeedFlags>();
    add_seed_point_flags(command, *seeds);
    add_job_flags(command, *job);
    command.callback([&selected, job, seeds] {
        selected = [job, seeds](Interrupt& interrupt) {
            Plc plc;
            const auto read = [&] {
                plc = read_plc(job->inputs[0], {.threads = job->options.threads});
                read_background(*job);
                add_seeds(*seeds, plc);
            };
            return produce_mesh(*job, interrupt, read, [&](const RunControl& control) { return generate(plc, job->options, control); });
        };
    });
}

}  // namespace wellmesh::cli
