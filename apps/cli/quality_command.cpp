// SPDX-License-Identifier: Apache-2.0
// wellmesh quality: shape statistics of a mesh.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>

#include "commands.hpp"
#include "exit_status.hpp"
#include "flags.hpp"
#include "json_report.hpp"
#include "render_report.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::cli {

namespace {

struct QualityCommand {
    std::string mesh, json;
};

int run(const QualityCommand& arguments, Interrupt& interrupt) {
    require_report("--json", arguments.json, {arguments.mesh});
    const TetMesh mesh = read_mesh(arguments.mesh);
    Certificate certificate;
    measure_shape(mesh, certificate);
    if (!arguments.json.empty()) {
        Json json = json_header("quality", arguments.mesh);
        json["vertices"] = mesh.vertices.size();
        json["tets"] = mesh.tets.size();
        json["all"] = to_json(certificate.all);
        json["interior"] = to_json(certificate.interior);
        json["boundary"] = to_json(certificate.boundary);
        const Interrupt::Cooperative cooperative(interrupt);  // a file once begun is finished
        write_json(arguments.json, json);
    }
    print_report(render_shape(certificate) + '\n' + render_histogram(certificate.all), arguments.json);
    return kGoalsMet;
}

}  // namespace

void add_quality_command(CLI::App& program, Command& selected) {
    CLI::App& command = *program.add_subcommand("quality", "shape statistics of a mesh, with a histogram of dihedral angles");
    auto arguments = std::make_shared<QualityCommand>();
    command.add_option("MESH", arguments->mesh, "tetrahedral mesh of any tool: .mesh (ASCII), .node/.ele")->required()->type_name("");
    add_json_flag(command, arguments->json);
    command.callback([&selected, arguments] { selected = [arguments](Interrupt& interrupt) { return run(*arguments, interrupt); }; });
}

}  // namespace wellmesh::cli
