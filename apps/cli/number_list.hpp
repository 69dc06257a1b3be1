// SPDX-License-Identifier: Apache-2.0
// Lists and ranges of numbers as people type them: "1,2,5", "1:5", "5:5:35", and any mixture, "0,20:5:30".
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace wellmesh::cli {

/// What a list may look like, for messages and help.
inline constexpr const char* kNumberListForm = "numbers a,b,c or ranges FIRST:LAST or FIRST:STEP:LAST, STEP above 0, FIRST not above LAST";

/// Finite numbers in the order typed, each once; LAST counts if a whole number of steps leads there, up to rounding.
/// @throws CLI::ValidationError{flag} with the form above.
[[nodiscard]] std::vector<double> read_numbers(const std::string& text, const std::string& flag);

/// The same for whole numbers from 0 to 2^64 - 1. @throws CLI::ValidationError{flag}
[[nodiscard]] std::vector<std::uint64_t> read_counts(const std::string& text, const std::string& flag);

}  // namespace wellmesh::cli
