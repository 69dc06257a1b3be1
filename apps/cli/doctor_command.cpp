// SPDX-License-Identifier: Apache-2.0
// wellmesh doctor: everything that is wrong with an input, and what it consists of.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <fmt/format.h>
#include <memory>
#include <optional>

#include "commands.hpp"
#include "exit_status.hpp"
#include "flags.hpp"
#include "json_report.hpp"
#include "render_report.hpp"
#include "seed_flags.hpp"
#include "wellmesh/diagnosis.hpp"
#include "wellmesh/io.hpp"
#include "wellmesh/repair.hpp"

namespace wellmesh::cli {

namespace {

struct DoctorCommand {
    std::string input, json, repaired;
    std::optional<double> tolerance;
    MeshOptions options;
    SeedFlags seeds;
};

int run(const DoctorCommand& arguments, Interrupt& interrupt) {
    require_valid(arguments.options);
    require_report("--json", arguments.json, {arguments.input});
    Plc plc = read_plc(arguments.input);
    add_seeds(arguments.seeds, plc);
    if (!arguments.repaired.empty()) {
        RepairOptions options;
        options.tolerance = arguments.tolerance;
        RepairResult r = repair(plc, options);
        write_plc(r.plc, arguments.repaired);
        fmt::print("{}\nrounds {}\n{}", r.summary, r.rounds, render_diagnosis(r.diagnosis));
        return r.diagnosis.has_errors() ? kBadInput : kGoalsMet;
    }
    const Diagnosis diagnosis = diagnose(plc, arguments.options);
    const int status = diagnosis.has_errors() ? kBadInput : kGoalsMet;
    if (!arguments.json.empty()) {
        Json json = json_header("doctor", arguments.input);
        json["exit_status"] = status;
        json.update(to_json(diagnosis));
        const Interrupt::Cooperative cooperative(interrupt);  // a file once begun is finished
        write_json(arguments.json, json);
    }
    print_report(render_diagnosis(diagnosis), arguments.json);
    return status;
}

}  // namespace

void add_doctor_command(CLI::App& program, Command& selected) {
    CLI::App& command = *program.add_subcommand("doctor", "list everything that is wrong with an input");
    auto arguments = std::make_shared<DoctorCommand>();
    command.add_option("INPUT", arguments->input, "domain: .poly .smesh .off .stl .obj .ply .mesh .msh .vtp .vtu")->required()->type_name("");
    command.add_option("--repair", arguments->repaired, "write a repaired copy");
    command.add_option("--tolerance", arguments->tolerance, "join what is closer, input units");
    add_coplanar_tolerance_flag(command, arguments->options);
    add_seed_point_flags(command, arguments->seeds);
    add_json_flag(command, arguments->json);
    command.callback([&selected, arguments] { selected = [arguments](Interrupt& interrupt) { return run(*arguments, interrupt); }; });
}

}  // namespace wellmesh::cli
