// SPDX-License-Identifier: Apache-2.0
// Where the program writes: reports whole or not at all, and paths checked before hours of work.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace wellmesh::cli {

/// Name that stands for standard output.
inline constexpr std::string_view kStandardOutput = "-";

/// The absolute name that `path` finally leads to, symbolic links followed as far as they exist.
[[nodiscard]] std::filesystem::path resolved(const std::filesystem::path& path);

/// Writes `text` to `path`: under a temporary name beside it, then renamed; straight into what is no regular file
/// (/dev/null, a named pipe); to standard output for "-".
/// @throws MeshError{cannot_write}
void write_text(const std::string& path, std::string_view text);

/// Writes to standard output now. @throws MeshError{cannot_write}, e.g. on a full disk.
void write_stdout(std::string_view text);

/// Throws the MeshError{cannot_write} that writing `path` would end in, as far as that can be known: no such folder, no
/// permission, a folder of that name.
void require_writable(const std::filesystem::path& path);

}  // namespace wellmesh::cli
