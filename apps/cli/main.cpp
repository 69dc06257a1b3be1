// SPDX-License-Identifier: Apache-2.0
// The command line program: parses, runs one command, turns every failure into a message and an exit status.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <new>

#include "commands.hpp"
#include "exit_status.hpp"
#include "output_file.hpp"
#include "render_report.hpp"
#include "usage.hpp"
#include "wellmesh/error.hpp"
#include "wellmesh/version.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace wellmesh::cli {

void print_report(const std::string& text, const std::string& json_path) {
    if (json_path == kStandardOutput) fmt::print(stderr, "{}", text);
    else write_stdout(text);
}

namespace {

void print_error(const MeshError& error) {
    constexpr std::size_t kShown = 20;
    if (error.code() == ErrorCode::cancelled) {
        fmt::print(stderr, "wellmesh: {}\n", error.what());
        return;
    }
    fmt::print(stderr, "wellmesh: {}: {}\n", to_string(error.code()), error.what());
    const auto& offenders = error.offenders();
    for (std::size_t i = 0; i < std::min(offenders.size(), kShown); ++i) {
        const bool names_place = offenders[i].kind != EntityKind::file;  // messages about files name the line themselves
        if (names_place) fmt::print(stderr, "  {}\n", describe(offenders[i]));
    }
    if (offenders.size() > kShown) fmt::print(stderr, "  and {} more\n", offenders.size() - kShown);
    if (error.code() == ErrorCode::bad_input && error.stage() == Stage::validate)
        fmt::print(stderr, "'wellmesh doctor' lists every defect.\n");
}

/// Without standard error a message would fail, or land in the next file that is opened.
void ensure_standard_error() {
    if (::fcntl(STDERR_FILENO, F_GETFD) != -1) return;
    const int null = ::open("/dev/null", O_WRONLY);
    if (null < 0 || null == STDERR_FILENO) return;
    ::dup2(null, STDERR_FILENO);
    ::close(null);
}

int run_guarded(const Command& command) {
    try {
        // A file beyond the size limit is then an error of write(), with a message and a status, not a death.
        std::signal(SIGXFSZ, SIG_IGN);
        Interrupt interrupt;
        return command(interrupt);
    } catch (const MeshError& error) {
        print_error(error);
        return exit_status(error.code());
    } catch (const std::bad_alloc&) {
        std::fputs("wellmesh: budget_exhausted: out of memory; nothing written\n", stderr);
        return kGaveUp;
    } catch (const std::exception& error) {
        fmt::print(stderr, "wellmesh: internal error: {}; please report it with the input\n", error.what());
        return kInternalError;
    }
}

int run(int argc, char** argv) {
    CLI::App program("wellmesh: certified Delaunay tetrahedral meshes without slivers", "wellmesh");
    program.set_version_flag("--version", "wellmesh " WELLMESH_VERSION, "print the version and exit");
    program.set_help_flag("-h,--help", "print this help and exit");
    program.require_subcommand(1);
    program.failure_message(CLI::FailureMessage::simple);
    Command selected;
    for (const auto add : {add_mesh_command, add_improve_command, add_study_command, add_check_command, add_quality_command, add_doctor_command, add_delaunay_command,
                           add_convert_command, add_example_command})
        add(program, selected);
    program.footer(exit_status_footer());
    // An unset shell variable is no number, and no file either. Lists and seeds say so themselves, with the valid form.
    const CLI::Validator not_empty([](std::string& text) { return text.empty() ? std::string("must not be empty") : std::string(); }, "");
    for (CLI::App* command : program.get_subcommands([](CLI::App*) { return true; })) {
        command->footer(exit_status_footer());
        for (CLI::Option* option : command->get_options())
            if (option->get_expected_max() > 0 && command->get_name() != "study" && !option->check_lname("seed")) option->check(not_empty);
    }
    try {
        program.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return report_parse_error(program, error);
    }
    return run_guarded(selected);
}

/// Blocks from 1 MB on are mapped on their own, and the system's again once freed. glibc's own threshold grows with what is freed, up to 32 MB, and large
/// arrays that lie in the heap leave holes: up to 7 bytes a tetrahedron. It takes the place of MALLOC_MMAP_THRESHOLD_, and the heap's end goes back from 128 kB on.
void map_large_blocks() {
#ifdef __GLIBC__
    (void)::mallopt(M_MMAP_THRESHOLD, 1 << 20);
#endif
}

}  // namespace

}  // namespace wellmesh::cli

int main(int argc, char** argv) {
    wellmesh::cli::map_large_blocks();
    wellmesh::cli::ensure_standard_error();
    try {
        return wellmesh::cli::run(argc, argv);
    } catch (const wellmesh::MeshError& error) {  // --help into a full disk
        std::fprintf(stderr, "wellmesh: %s\n", error.what());
        return wellmesh::cli::exit_status(error.code());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "wellmesh: internal error: %s\n", error.what());
        return wellmesh::cli::kInternalError;
    }
}
