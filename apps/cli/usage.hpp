// SPDX-License-Identifier: Apache-2.0
// What people see who mistyped.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace wellmesh::cli {

/// Exit statuses, as every --help ends with.
[[nodiscard]] std::string exit_status_footer();

/// The candidate nearest to `word` in edit distance, or empty when none is near enough to be a slip of it.
[[nodiscard]] std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

/// Prints help or version to standard output, or what is wrong with the command line to standard error.
/// @return the exit status.
int report_parse_error(const CLI::App& program, const CLI::ParseError& error);

}  // namespace wellmesh::cli
