// SPDX-License-Identifier: Apache-2.0
// wellmesh example: a solid to try the program on.
#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <memory>

#include "commands.hpp"
#include "example_bracket.hpp"
#include "exit_status.hpp"
#include "output_file.hpp"
#include "wellmesh/error.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::cli {

namespace {

int run(const std::string& output, Interrupt& interrupt) {
    if (std::filesystem::path(output).extension() != ".poly")
        throw MeshError(ErrorCode::bad_options, Stage::write, fmt::format("{}: the example is written as .poly", output));
    require_writable(output);
    const Interrupt::Cooperative cooperative(interrupt);
    write_plc(example_bracket(), output);
    return kGoalsMet;
}

}  // namespace

void add_example_command(CLI::App& program, Command& selected) {
    CLI::App& command = *program.add_subcommand("example", "write an example solid: a bracket with holes and two materials");
    auto output = std::make_shared<std::string>();
    command.add_option("-o,--output", *output, "file to write: .poly")->required()->type_name("FILE");
    command.callback([&selected, output] { selected = [output](Interrupt& interrupt) { return run(*output, interrupt); }; });
}

}  // namespace wellmesh::cli
