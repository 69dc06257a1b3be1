// SPDX-License-Identifier: Apache-2.0
// wellmesh delaunay: the Delaunay triangulation of a point set, with timings.
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>

#include "commands.hpp"
#include "exit_status.hpp"
#include "flags.hpp"
#include "json_report.hpp"
#include "output_file.hpp"
#include "wellmesh/delaunay.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::cli {

namespace {

struct DelaunayCommand {
    std::string points, json;
    std::vector<std::string> outputs;
    WriteOptions write;
    unsigned threads = 0;
};

int run(const DelaunayCommand& arguments, Interrupt& interrupt) {
    require_valid(arguments.write);
    require_mesh_outputs(arguments.outputs, {arguments.points});
    std::vector<std::string> others = arguments.outputs;
    others.push_back(arguments.points);
    require_report("--json", arguments.json, others);

    const Stopwatch reading;
    const std::vector<Vec3> points = read_points(arguments.points, {.threads = arguments.threads});
    const double read_seconds = reading.seconds();

    const Stopwatch triangulating;
    const DelaunayResult result = triangulate_points(points, arguments.threads);
    const double delaunay_seconds = triangulating.seconds();

    WriteOptions write = arguments.write;
    write.threads = arguments.threads;
    const Interrupt::Cooperative cooperative(interrupt);
    const Stopwatch writing;
    Json files = Json::array();
    for (const std::string& output : arguments.outputs)
        for (const auto& file : write_mesh(result.mesh, output, write)) files.push_back(file.string());

    Json json = json_header("delaunay", arguments.points);
    json["read_seconds"] = read_seconds;
    json["delaunay_seconds"] = delaunay_seconds;
    json["write_seconds"] = writing.seconds();
    json["points"] = points.size();
    json["duplicates"] = result.duplicates;
    json["tets"] = result.mesh.tets.size();
    json["files"] = std::move(files);
    write_json(arguments.json.empty() ? std::string(kStandardOutput) : arguments.json, json);
    return interrupt.requested() ? kInterrupted : kGoalsMet;
}

}  // namespace

void add_delaunay_command(CLI::App& program, Command& selected) {
    CLI::App& command = *program.add_subcommand("delaunay", "Delaunay triangulation of a point set; prints timings as JSON");
    auto arguments = std::make_shared<DelaunayCommand>();
    command.add_option("POINTS", arguments->points, "points: .node .xyz .ply")->required()->type_name("");
    add_output_flag(command, arguments->outputs, "mesh to write: .mesh .vtu .msh .inp .node/.ele, by extension; may be given several times");
    add_threads_flag(command, arguments->threads);
    add_write_flags(command, arguments->write);
    command.add_option("--json", arguments->json, "write the timings to this file instead of standard output")->type_name("FILE");
    command.callback([&selected, arguments] { selected = [arguments](Interrupt& interrupt) { return run(*arguments, interrupt); }; });
}

}  // namespace wellmesh::cli
