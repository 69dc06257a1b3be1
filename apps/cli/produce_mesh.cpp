// SPDX-License-Identifier: Apache-2.0
#include "produce_mesh.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/resource.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <memory>
#include <new>

#include "commands.hpp"
#include "exit_status.hpp"
#include "flags.hpp"
#include "json_report.hpp"
#include "progress_line.hpp"
#include "render_report.hpp"

namespace wellmesh::cli {

namespace {

std::uint64_t peak_memory_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;  // Linux counts KiB
}

constexpr std::size_t kMostCells = 20;  // of the text; JSON has all

std::string render(const MeshResult& result, const std::vector<StageTime>& stages, const std::vector<std::filesystem::path>& files) {
    std::string text = fmt::format("{} vertices, {} tetrahedra: {}\n\n", result.mesh.vertices.size(), result.mesh.tets.size(),
                                   to_string(result.termination));
    for (const std::string& part : {render_goals(result.goals), render_claims(result.certificate),
                                    result.invariants ? render_invariants(*result.invariants) : std::string(), render_shape(result.certificate),
                                    render_regions(result.certificate), render_cells(result.statistics.cells, kMostCells), render_stages(stages)})
        if (!part.empty()) text += part + '\n';
    // Whoever checks the file against its input must allow what the input's own rounding did.
    const CertifyOptions defaults;
    const MeshStatistics& s = result.statistics;
    if (s.certificate_tolerance > defaults.tolerance || s.certificate_flat_angle_rad > defaults.flat_angle_rad)
        text += fmt::format("note: the input's rounding shows in the mesh: check it with --tolerance {:.4g} --flat-angle {:.4g}\n", s.certificate_tolerance, s.certificate_flat_angle_rad);
    if (s.given) text += render_given(*s.given);
    if (!result.exemptions.empty()) text += render_exemptions(result);
    if (s.weighted_vertices > 0)
        text += fmt::format("note: the mesh is weighted Delaunay: {} of {} vertices have a weight; check it with --weights\n", s.weighted_vertices,
                            result.mesh.vertices.size());
    for (const std::string& note : result.statistics.notes) text += "note: " + note + '\n';
    for (const auto& file : files) text += "wrote " + file.string() + '\n';
    return text;
}

std::vector<std::string> files_named(const std::vector<std::filesystem::path>& files) {
    std::vector<std::string> names;
    for (const auto& file : files) names.push_back(file.string());
    return names;
}

Json header(const MeshJob& job) {
    Json json = json_header(job.command, job.inputs[0]);
    if (job.inputs.size() > 1) json["plc"] = job.inputs[1];
    json["options"] = to_json(job.options);
    json["options"]["background"] = job.background.empty() ? Json(nullptr) : Json(job.background);
    return json;
}

Json report(const MeshJob& job, const MeshResult& result, const std::vector<StageTime>& stages,
            const std::vector<std::filesystem::path>& files, int status) {
    Json json = header(job);
    json["exit_status"] = status;
    json["termination"] = to_string(result.termination);
    json["vertices"] = result.mesh.vertices.size();
    json["tets"] = result.mesh.tets.size();
    json["goals"] = to_json(result.goals);
    json["certificate"] = to_json(result.certificate);
    json["exemptions"] = to_json(result.exemptions);
    if (result.invariants) json["invariants"] = to_json(*result.invariants);
    json["statistics"] = to_json(result.statistics);
    json["timings"] = to_json(stages);
    json["peak_memory_bytes"] = peak_memory_bytes();
    json["files"] = Json::array();
    for (const auto& file : files) json["files"].push_back(file.string());
    return json;
}

int run(const MeshJob& job, Interrupt& interrupt, const std::function<void()>& read, const std::function<MeshResult(const RunControl&)>& make) {
    std::vector<StageTime> stages(1);
    const Stopwatch reading;
    read();
    stages[0] = {.stage = Stage::read, .seconds = reading.seconds()};

    const Interrupt::Cooperative cooperative(interrupt);
    const MeshResult result = [&] {
        ProgressLine line(!job.quiet);
        RunControl control;
        control.stop = interrupt.token();
        if (line.enabled()) control.on_progress = [&line](const Progress& progress) { line.show(progress); };
        return make(control);
    }();
    if (interrupt.requested()) throw MeshError(ErrorCode::cancelled, Stage::write, "interrupted; nothing written");
    stages.insert(stages.end(), result.statistics.stages.begin(), result.statistics.stages.end());

    const Stopwatch writing;
    std::vector<std::filesystem::path> files;
    WriteOptions write = job.write;
    write.stop = interrupt.token();
    write.threads = job.options.threads;
    for (const std::string& output : job.outputs) {
        if (interrupt.requested()) throw MeshError(ErrorCode::cancelled, Stage::write, fmt::format("interrupted in stage write, before {} was written", output));
        const auto written = write_mesh(result.mesh, output, write);
        files.insert(files.end(), written.begin(), written.end());
    }
    if (!job.exemptions.empty()) {
        const auto written = write_exemptions(result.exemptions, job.exemptions, write);
        files.insert(files.end(), written.begin(), written.end());
    }
    if (!files.empty()) stages.push_back({.stage = Stage::write, .seconds = writing.seconds()});

    const int status = goals_met(result) ? kGoalsMet : kGoalsUnmet;
    try {
        if (!job.json.empty()) write_json(job.json, report(job, result, stages, files, status));
    } catch (const MeshError& e) {
        if (files.empty()) throw;
        throw MeshError(e.code(), e.stage(), fmt::format("{}; the mesh is written: {}", e.what(), fmt::join(files_named(files), " ")), e.offenders());
    }
    if (!job.quiet) print_report(render(result, stages, files), job.json);
    return status;
}

}  // namespace

void add_job_flags(CLI::App& command, MeshJob& job) {
    add_output_flag(command, job.outputs, "mesh to write: .mesh .vtu .msh .inp .node/.ele, by extension; may be given several times");
    add_write_flags(command, job.write);
    command.add_option("--exemptions", job.exemptions, "write the tetrahedra that the input's acute angles or too narrow gaps keep below the goals: number, feature, angle, a line each")
        ->type_name("FILE");
    add_json_flag(command, job.json);
    command.add_flag("--quiet", job.quiet, "no report and no progress line; errors still go to standard error");
}

void add_background_flag(CLI::App& command, MeshJob& job) {
    command.add_option("--background", job.background, "target edge lengths at the vertices of a mesh: .node/.ele with .mtr, .msh, .vtu (default: none)")->type_name("FILE");
}

void read_background(MeshJob& job) {
    if (job.background.empty()) return;
    job.options.size.background = std::make_shared<const BackgroundMesh>(read_background_mesh(job.background, {.threads = job.options.threads}));
}

bool goals_met(const MeshResult& result) {
    return result.termination == Termination::goals_met && result.certificate.proven() &&
           std::all_of(result.goals.begin(), result.goals.end(), [](const AskedAchieved& goal) { return goal.met; });
}

int produce_mesh(const MeshJob& job, Interrupt& interrupt, const std::function<void()>& read, const std::function<MeshResult(const RunControl&)>& make) {
    require_valid(job.options);
    require_valid(job.write);
    std::vector<std::string> inputs = job.inputs;
    if (!job.background.empty()) inputs.push_back(job.background);
    require_mesh_outputs(job.outputs, inputs);
    std::vector<std::string> others = job.outputs;
    others.insert(others.end(), inputs.begin(), inputs.end());
    require_report("--exemptions", job.exemptions, others);
    if (!job.exemptions.empty()) others.push_back(job.exemptions);
    require_report("--json", job.json, others);
    // Programs that asked for a report get the reason in it, too.
    const auto report_error = [&](const MeshError& error) {
        if (job.json.empty() || error.code() == ErrorCode::cannot_write || error.code() == ErrorCode::cancelled) return;
        Json json = header(job);
        json["exit_status"] = exit_status(error.code());
        json["error"] = to_json(error);
        json["files"] = Json::array();
        write_json(job.json, json);
    };
    try {
        return run(job, interrupt, read, make);
    } catch (const MeshError& error) {
        report_error(error);
        throw;
    } catch (const std::bad_alloc&) {  // generate() tells its own: this is outside of it
        const MeshError error(ErrorCode::budget_exhausted, Stage::read, "out of memory while files were read or written");
        report_error(error);
        throw error;
    }
}

}  // namespace wellmesh::cli
