// SPDX-License-Identifier: Apache-2.0
// One file a command. Each adds its flags to the program and, when its name was typed, puts what to run into `selected`.
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "interrupt.hpp"

namespace CLI {
class App;
}

namespace wellmesh::cli {

/// Runs a parsed command. Returns the exit status; may throw MeshError.
using Command = std::function<int(Interrupt&)>;

void add_mesh_command(CLI::App& program, Command& selected);
void add_improve_command(CLI::App& program, Command& selected);
void add_study_command(CLI::App& program, Command& selected);
void add_check_command(CLI::App& program, Command& selected);
void add_quality_command(CLI::App& program, Command& selected);
void add_doctor_command(CLI::App& program, Command& selected);
void add_delaunay_command(CLI::App& program, Command& selected);
void add_convert_command(CLI::App& program, Command& selected);
void add_example_command(CLI::App& program, Command& selected);

/// Prints a report for people: to standard output, or to standard error when a JSON report has taken that.
void print_report(const std::string& text, const std::string& json_path);

/// Seconds since it was made.
class Stopwatch {
public:
    [[nodiscard]] double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace wellmesh::cli
