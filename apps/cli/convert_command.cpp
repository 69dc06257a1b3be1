// SPDX-License-Identifier: Apache-2.0
// wellmesh convert: a complex or a mesh in another format, and what that format can't carry.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <string_view>

#include "commands.hpp"
#include "exit_status.hpp"
#include "flags.hpp"
#include "json_report.hpp"
#include "wellmesh/convert.hpp"
#include "wellmesh/error.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::cli {

namespace {

struct ConvertCommand {
    std::string input, output, json;
    bool quiet = false, as_complex = false;
    WriteOptions write;
};

constexpr std::array<std::string_view, 7> kComplexOnly{".poly", ".smesh", ".off", ".stl", ".obj", ".ply", ".vtp"};
constexpr std::array<std::string_view, 2> kBoth{".mesh", ".msh"};
constexpr std::array<std::string_view, 4> kMeshOnly{".vtu", ".inp", ".node", ".ele"};

template <std::size_t N>
bool has(const std::array<std::string_view, N>& extensions, std::string_view extension) {
    return std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
}

int run(const ConvertCommand& arguments, Interrupt& interrupt) {
    require_valid(arguments.write);
    const std::string extension = lower_extension(arguments.output);
    if (!has(kComplexOnly, extension) && !has(kBoth, extension) && !has(kMeshOnly, extension))
        throw MeshError(ErrorCode::bad_options, Stage::write,
                        fmt::format("{}: unknown format '{}'; known are .poly .smesh .off .stl .obj .ply .vtp for complexes, .vtu .inp .node .ele "
                                    "for meshes, .mesh .msh for both",
                                    arguments.output, extension));
    require_outputs({arguments.output}, {arguments.input});
    require_report("--json", arguments.json, {arguments.input, arguments.output});

    const std::string from = lower_extension(arguments.input);
    const bool to_complex = has(kComplexOnly, extension) || arguments.as_complex;
    const bool as_mesh = !to_complex && !has(kComplexOnly, from) && (has(kMeshOnly, extension) || holds_mesh(arguments.input));
    if (!as_mesh && has(kMeshOnly, extension))
        throw MeshError(ErrorCode::bad_options, Stage::write,
                        fmt::format("{} is a complex, and {} is a format of meshes: 'wellmesh mesh' fills a complex", arguments.input, extension));

    TetMesh mesh;
    Plc plc;
    if (as_mesh) mesh = read_mesh(arguments.input);
    else plc = read_plc(arguments.input);

    const Interrupt::Cooperative cooperative(interrupt);
    WriteOptions write = arguments.write;
    write.stop = interrupt.token();
    const std::vector<std::string> lost = as_mesh ? not_carried(mesh, arguments.output, write) : not_carried(plc, arguments.output, write);
    const std::vector<std::filesystem::path> files = as_mesh ? write_mesh(mesh, arguments.output, write) : write_plc(plc, arguments.output, write);
    if (!arguments.json.empty()) {
        Json json = json_header("convert", arguments.input);
        json["exit_status"] = kGoalsMet;
        json["kind"] = as_mesh ? "mesh" : "complex";
        json["not_carried"] = lost;
        json["files"] = Json::array();
        for (const auto& file : files) json["files"].push_back(file.string());
        write_json(arguments.json, json);
    }
    if (!arguments.quiet) {
        std::string text = as_mesh
                               ? fmt::format("mesh: {} vertices, {} tetrahedra, {} subfaces, {} subsegments\n", mesh.vertices.size(),
                                             mesh.tets.size(), mesh.subfaces.size(), mesh.subsegments.size())
                               : fmt::format("complex: {} vertices, {} facets, {} segments, {} region seeds, {} hole seeds\n", plc.vertices.size(),
                                             plc.facets.size(), plc.segments.size(), plc.region_seeds.size(), plc.hole_seeds.size());
        for (const std::string& loss : lost) text += "note: " + loss + '\n';
        for (const auto& file : files) text += "wrote " + file.string() + '\n';
        print_report(text, arguments.json);
    }
    return kGoalsMet;
}

}  // namespace

void add_convert_command(CLI::App& program, Command& selected) {
    CLI::App& command = *program.add_subcommand("convert", "write a complex or a mesh in another format, and say what that format can't carry");
    auto arguments = std::make_shared<ConvertCommand>();
    command.add_option("INPUT", arguments->input, "complex: .poly .smesh .off .stl .obj .ply .mesh .msh .vtp .vtu; mesh: .mesh .msh .vtu .node/.ele")
        ->required()
        ->type_name("");
    command
        .add_option("OUTPUT", arguments->output, "complex: .poly .smesh .off .stl .obj .ply .mesh .msh .vtp; mesh: .mesh .msh .vtu .inp .node/.ele")
        ->required()
        ->type_name("");
    command.add_flag("--complex", arguments->as_complex, "of a mesh take its faces, edges and points alone, as a complex");
    command.add_flag("--binary", arguments->write.binary_stl, "write .stl as binary (float32)");
    add_write_flags(command, arguments->write);
    add_json_flag(command, arguments->json);
    command.add_flag("--quiet", arguments->quiet, "no report; errors still go to standard error");
    command.callback([&selected, arguments] { selected = [arguments](Interrupt& interrupt) { return run(*arguments, interrupt); }; });
}

}  // namespace wellmesh::cli
