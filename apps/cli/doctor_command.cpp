// SPDX-License-Identifier: Apache-2.0
// wellmesh doctor: everything that is wrong with an input, and what it consists of; and a repaired copy.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "commands.hpp"
#include "exit_status.hpp"
#include "flags.hpp"
#include "json_report.hpp"
#include "output_file.hpp"
#include "render_report.hpp"
#include "seed_flags.hpp"
#include "wellmesh/diagnosis.hpp"
#include "wellmesh/io.hpp"
#include "wellmesh/repair.hpp"

namespace wellmesh::cli {

namespace {

struct DoctorCommand {
    std::string input, json, vtp, repaired;
    bool all = false;
    RepairOptions repair;
    std::optional<double> near;
    MeshOptions options;
    SeedFlags seeds;
};

void require_consistent(const DoctorCommand& arguments) {
    require_valid(arguments.options);
    const auto fail = [](const std::string& what) { throw MeshError(ErrorCode::bad_options, Stage::read, what); };
    if (arguments.near && !(*arguments.near >= 0 && std::isfinite(*arguments.near))) fail(fmt::format("--near {}: a distance of 0 or more is wanted", *arguments.near));
    if (arguments.repaired.empty() && (arguments.repair.tolerance || arguments.repair.drop_inner_facets)) fail("--tolerance and --union belong to --repair OUT");
    if (!arguments.vtp.empty() && !arguments.vtp.ends_with(".vtp")) fail(fmt::format("--vtp {}: the name must end in .vtp", arguments.vtp));
    std::vector<std::string> others{arguments.input};
    for (const std::string* output : {&arguments.repaired, &arguments.vtp}) {
        if (output->empty()) continue;
        for (const std::string& other : others)
            if (resolved(*output) == resolved(other)) fail(fmt::format("writing {} would replace {}", *output, other));
        require_writable(*output);
        others.push_back(*output);
    }
    require_report("--json", arguments.json, others);
}

/// A .poly means every bounded cell, so that cavities of a surface would be filled.
void require_expressible(const DoctorCommand& arguments, const Plc& plc, const Diagnosis& diagnosis) {
    if (plc.fill != FillRule::nonzero_winding || !arguments.repaired.ends_with(".poly")) return;
    for (const CellSummary& cell : diagnosis.cells)
        if (std::isfinite(cell.volume) && !cell.filled)
            throw MeshError(ErrorCode::bad_options, Stage::write,
                            fmt::format("--repair {}: the surface encloses a cavity, and a .poly would mean it to be filled; write a surface file", arguments.repaired));
}

struct Repaired {
    RepairResult result;
    bool written = false;
    Diagnosis left;  ///< of the file as it was written
};

/// Copies of a facet are winding numbers in surface files; elsewhere they are repetitions, and count twice where areas are compared.
Plc with_facets_once(Plc plc) {
    std::set<std::vector<std::uint32_t>> known;
    std::erase_if(plc.facets, [&](const PlcFacet& facet) {
        std::vector<std::uint32_t> corners;
        for (const auto& polygon : facet.polygons) corners.insert(corners.end(), polygon.begin(), polygon.end());
        std::sort(corners.begin(), corners.end());
        return !known.insert(corners).second;
    });
    return plc;
}

Repaired write_repaired(const DoctorCommand& arguments, const Plc& plc, Interrupt& interrupt) {
    Repaired repaired;
    const Interrupt::Cooperative cooperative(interrupt);
    RepairOptions options = arguments.repair;
    options.coplanar_tolerance = arguments.options.coplanar_tolerance;
    repaired.result = repair(plc, options, interrupt.token());
    if (!repaired.result.resolved || repaired.result.max_displacement > 2 * repaired.result.tolerance) return repaired;
    require_expressible(arguments, plc, repaired.result.diagnosis);
    const bool is_surface = plc.fill == FillRule::nonzero_winding && !arguments.repaired.ends_with(".poly") && !arguments.repaired.ends_with(".smesh");
    write_plc(is_surface ? repaired.result.plc : with_facets_once(repaired.result.plc), arguments.repaired);
    repaired.written = true;
    repaired.left = diagnose(read_plc(arguments.repaired), arguments.options);
    return repaired;
}

std::string render_repair(const DoctorCommand& arguments, const Repaired& repaired, std::size_t most_of_a_kind) {
    const RepairResult& r = repaired.result;
    std::string text = fmt::format("Repair within {:.3g}\n  {}\n", r.tolerance, r.summary);
    if (!repaired.written) return text + fmt::format("  {} was not written\n", arguments.repaired);
    if (!repaired.left.has_errors()) return text + fmt::format("{} is a valid complex: {} vertices, {} facets, {} cells\n", arguments.repaired, repaired.left.vertices,
                                                               repaired.left.facets, repaired.left.cells.size());
    Diagnosis errors = repaired.left;
    std::erase_if(errors.defects, [](const Defect& d) { return d.severity != Severity::error; });
    return text + fmt::format("Errors left in {}: a repair closes no gap wider than its tolerance and invents no facet\n", arguments.repaired) + render_diagnosis(errors, most_of_a_kind);
}

int run(const DoctorCommand& arguments, Interrupt& interrupt) {
    require_consistent(arguments);
    Plc plc = read_plc(arguments.input);
    add_seeds(arguments.seeds, plc);
    const Diagnosis diagnosis = examine(plc, {.near = arguments.near, .coplanar_tolerance = arguments.options.coplanar_tolerance});
    std::optional<Repaired> repaired;
    if (!arguments.repaired.empty()) repaired = write_repaired(arguments, plc, interrupt);
    const bool sound = repaired ? repaired->written && !repaired->left.has_errors() : !diagnosis.has_errors();
    const int status = sound ? kGoalsMet : kBadInput;
    constexpr std::size_t kMostOfAKind = 20;
    const std::size_t most = arguments.all ? std::numeric_limits<std::size_t>::max() : kMostOfAKind;
    const Interrupt::Cooperative cooperative(interrupt);  // a file once begun is finished
    if (!arguments.vtp.empty()) write_trouble_spots(diagnosis, arguments.vtp);
    if (!arguments.json.empty()) {
        Json json = json_header("doctor", arguments.input);
        json["exit_status"] = status;
        json.update(to_json(diagnosis));
        if (repaired) {
            json["repair"] = to_json(repaired->result);
            json["repair"]["output"] = repaired->written ? Json(arguments.repaired) : Json();
            json["repair"]["left"] = repaired->written ? to_json(repaired->left) : Json();
        }
        write_json(arguments.json, json);
    }
    print_report(render_diagnosis(diagnosis, most) + (repaired ? render_repair(arguments, *repaired, most) : std::string()), arguments.json);
    return status;
}

}  // namespace

void add_doctor_command(CLI::App& program, Command& selected) {
    CLI::App& command = *program.add_subcommand("doctor", "list everything that is wrong with an input, and repair it");
    auto arguments = std::make_shared<DoctorCommand>();
    command.add_option("INPUT", arguments->input, "domain: .poly .smesh .off .stl .obj .ply .mesh .msh .vtp .vtu")->required()->type_name("");
    command.add_option("--near", arguments->near, "list features without a common vertex that are closer; default 1e-4 of the diagonal, 0: none")->type_name("LENGTH");
    command.add_flag("--all", arguments->all, "print every defect, not the first ones of each kind");
    command.add_option("--vtp", arguments->vtp, "write the trouble spots as points, lines and triangles, for ParaView")->type_name("FILE");
    command.add_option("--repair", arguments->repaired, "write a repaired copy: merged, oriented, cut where facets meet")->type_name("FILE");
    command.add_option("--tolerance", arguments->repair.tolerance, "what is closer is joined; nothing ends twice as far off. Default: the file's rounding, or 1e-8 of the diagonal")
        ->type_name("LENGTH");
    command.add_flag("--union", arguments->repair.drop_inner_facets, "leave out facets inside of solids that overlap or touch");
    add_coplanar_tolerance_flag(command, arguments->options);
    add_seed_point_flags(command, arguments->seeds);
    add_json_flag(command, arguments->json);
    command.callback([&selected, arguments] { selected = [arguments](Interrupt& interrupt) { return run(*arguments, interrupt); }; });
}

}  // namespace wellmesh::cli
