// SPDX-License-Identifier: Apache-2.0
// A whole input file in memory, and the errors that point into it. Memory is the file's size, whatever its header claims.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "core/workers.hpp"
#include "wellmesh/error.hpp"

namespace wellmesh::io {

struct SourceFile {
    std::filesystem::path path;
    std::string name;   ///< as messages print it
    std::string bytes;
    unsigned threads = 1;                ///< that read it and the files beside it; 0: as many as the machine has cores
    std::unique_ptr<Workers> workers{};  ///< those threads; null in a small file or where there is but one
};

/// Reads a regular file (or a pipe, to its end) completely.
/// @throws MeshError{cannot_read} naming the file: missing, a directory, a device, unreadable.
[[nodiscard]] SourceFile read_source(const std::filesystem::path& path, unsigned threads);

/// A token of the input as messages quote it: non-printing bytes escaped, long ones cut.
[[nodiscard]] std::string quoted_token(std::string_view token);

/// "file:line: message" as MeshError{bad_input}; the offender is the file with the line as its number.
[[noreturn]] void fail_at_line(const SourceFile& source, std::uint64_t line, const std::string& message);
/// "file: byte N: message" as MeshError{bad_input}, for binary data.
[[noreturn]] void fail_at_byte(const SourceFile& source, std::uint64_t byte, const std::string& message);
/// "file: message" as MeshError{bad_input}.
[[noreturn]] void fail_in_file(const SourceFile& source, const std::string& message);

/// Extension in lower case, with its dot.
[[nodiscard]] std::string lower_case_extension(const std::filesystem::path& path);

}  // namespace wellmesh::io
