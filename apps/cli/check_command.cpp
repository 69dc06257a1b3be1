// SPDX-License-Identifier: Apache-2.0
// wellmesh check: proves or refutes what a mesh, of any tool, should be.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <optional>

#include "commands.hpp"
#include "exit_status.hpp"
#include "flags.hpp"
#include "json_report.hpp"
#include "render_report.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::cli {

namespace {

struct CheckCommand {
    std::string mesh, plc, weights, exempt, json;
    bool quiet = false;
    CertifyOptions options;
};

int run(const CheckCommand& arguments, Interrupt& interrupt) {
    require_valid(arguments.options);
    require_report("--json", arguments.json, {arguments.mesh, arguments.plc, arguments.weights, arguments.exempt});
    const ReadOptions read{.threads = arguments.options.threads};
    TetMesh mesh = read_mesh(arguments.mesh, read);
    if (!arguments.weights.empty()) mesh.weights = read_weights(arguments.weights, mesh.vertices.size(), read);
    std::optional<Plc> plc;
    if (!arguments.plc.empty()) plc = read_plc(arguments.plc, read);
    CertifyOptions options = arguments.options;
    if (!arguments.exempt.empty()) options.exempt = read_exemptions(arguments.exempt, mesh.tets.size());
    const Certificate certificate = certify(mesh, options, plc ? &*plc : nullptr);
    const int status = certificate.proven() ? kGoalsMet : kGoalsUnmet;

    if (!arguments.json.empty()) {
        Json json = json_header("check", arguments.mesh);
        json["plc"] = arguments.plc.empty() ? Json(nullptr) : Json(arguments.plc);
        json["weights"] = arguments.weights.empty() ? Json(nullptr) : Json(arguments.weights);
        json["exempt"] = arguments.exempt.empty() ? Json(nullptr) : Json(arguments.exempt);
        json["options"] = to_json(arguments.options);
        json["exit_status"] = status;
        json["vertices"] = mesh.vertices.size();
        json["tets"] = mesh.tets.size();
        json["certificate"] = to_json(certificate);
        const Interrupt::Cooperative cooperative(interrupt);  // a file once begun is finished
        write_json(arguments.json, json);
    }
    if (!arguments.quiet)
        print_report(render_claims(certificate) + '\n' + render_shape(certificate) + '\n' + render_regions(certificate), arguments.json);
    return status;
}

}  // namespace

void add_check_command(CLI::App& program, Command& selected) {
    CLI::App& command = *program.add_subcommand("check", "prove or refute, by exact arithmetic, what a mesh should be");
    auto arguments = std::make_shared<CheckCommand>();
    command.add_option("MESH", arguments->mesh, "tetrahedral mesh of any tool: .mesh (ASCII) .msh .vtu .node/.ele")->required()->type_name("");
    command.add_option("--plc", arguments->plc, "the domain that the mesh claims to fill (default: claims about it are not checked)")->type_name("FILE");
    command.add_option("--weights", arguments->weights, "the vertices' weights, .sol or .node: the mesh claims to be weighted Delaunay (default: Delaunay)")
        ->type_name("FILE");
    command.add_option("--exempt", arguments->exempt, "tetrahedra that need not keep the bounds on shape, a number from 1 a line: what --exemptions wrote (default: none)")
        ->type_name("FILE");
    add_certify_flags(command, arguments->options);
    add_threads_flag(command, arguments->options.threads);
    add_json_flag(command, arguments->json);
    command.add_flag("--quiet", arguments->quiet, "no report; the exit status says it: 0 no claim refuted, 1 otherwise");
    command.callback([&selected, arguments] { selected = [arguments](Interrupt& interrupt) { return run(*arguments, interrupt); }; });
}

}  // namespace wellmesh::cli
