// SPDX-License-Identifier: Apache-2.0
#include "usage.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cstdio>

#include "commands.hpp"
#include "exit_status.hpp"
#include "output_file.hpp"

namespace wellmesh::cli {

namespace {

/// Levenshtein's distance, one row at a time.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t above = row[j];
            row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0U : 1U)});
            diagonal = above;
        }
    }
    return row[b.size()];
}

const CLI::App& typed_command(const CLI::App& program) {
    const auto typed = program.get_subcommands();
    return typed.empty() ? program : *typed.front();
}

std::vector<std::string> option_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    }
    return names;
}

std::vector<std::string> command_names(const CLI::App& program) {
    std::vector<std::string> names;
    for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; })) names.push_back(command->get_name());
    return names;
}

/// What the parser did not know, options first: a value left over by an unknown option is no fault of its own.
std::string first_unknown(const CLI::App& program) {
    const std::vector<std::string> left = program.remaining(true);
    const auto option = std::find_if(left.begin(), left.end(), [](const std::string& word) { return word.size() > 1 && word[0] == '-'; });
    if (option != left.end()) return *option;
    return left.empty() ? std::string() : left.front();
}

std::string explain_unknown(const CLI::App& program, const std::string& word) {
    const CLI::App& command = typed_command(program);
    const bool is_option = word.size() > 1 && word[0] == '-';
    if (!is_option && &command != &program) return fmt::format("unexpected argument '{}'", word);
    const std::vector<std::string> known = is_option ? option_names(command) : command_names(program);
    const std::string guess = nearest(word.substr(0, word.find('=')), known);
    const char* kind = is_option ? "option" : "command";
    if (!guess.empty()) return fmt::format("unknown {} '{}'; did you mean '{}'?", kind, word, guess);
    return fmt::format("unknown {} '{}'; known are {}", kind, word, fmt::join(known, " "));
}

}  // namespace

std::string exit_status_footer() {
    return "Exit status\n"
           "  0    goals met (check: no claim refuted; study: every run has a mesh)\n"
           "  1    a valid mesh that misses goals, listed (check: a claim refuted; study: a run failed)\n"
           "  2    bad input, diagnosed; nothing written\n"
           "  3    usage: unknown option, value out of range\n"
           "  4    gave up before the mesh conformed (vertices, time, memory, acute feature); nothing written\n"
           "  5    a file can't be read or written\n"
           "  70   internal error; please report it\n"
           "  130  interrupted; nothing left half written";
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
    std::string best;
    std::size_t least = word.size() / 2;  // more than half of it wrong is another word
    for (const std::string& candidate : candidates)
        if (const std::size_t distance = edit_distance(word, candidate); distance <= least && (best.empty() || distance < least)) {
            least = distance;
            best = candidate;
        }
    return best;
}

int report_parse_error(const CLI::App& program, const CLI::ParseError& error) {
    const CLI::App& command = typed_command(program);
    if (error.get_name() == "CallForHelp" || error.get_name() == "CallForAllHelp") {
        write_stdout(&command == &program ? program.help() : command.help("wellmesh"));
        return kGoalsMet;
    }
    if (error.get_name() == "CallForVersion") {
        write_stdout(std::string(error.what()) + '\n');
        return kGoalsMet;
    }
    const std::string unknown = first_unknown(program);
    const std::string reason = !unknown.empty() ? explain_unknown(program, unknown)
                               : &command == &program ? fmt::format("no command given; known are {}", fmt::join(command_names(program), " "))
                                                      : std::string(error.what());
    const std::string name = &command == &program ? "wellmesh" : "wellmesh " + command.get_name();
    fmt::print(stderr, "{}: {}\nSee '{} --help'.\n", name, reason, name);
    return kUsage;
}

}  // namespace wellmesh::cli
