// SPDX-License-Identifier: Apache-2.0
// Runs the built program as a user would: its own process, pipes, signals, limits.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace wellmesh::testing {

struct Outcome {
    int status = -1;  ///< exit status; 128 + signal when a signal killed it
    std::string out, err;
};

struct RunOptions {
    std::filesystem::path folder;                      ///< working directory
    bool terminal = false;                             ///< standard error is a pseudo-terminal
    bool closed_stdout = false;                        ///< nobody reads standard output
    std::optional<std::uint64_t> file_size_limit{};    ///< bytes, stands for a full disk
    std::optional<std::uint64_t> address_space_limit{};
    bool ignore_interrupt = false;                     ///< as nohup and background jobs of scripts do
    std::optional<int> signal{};                       ///< sent once `signal_after` has passed
    std::chrono::milliseconds signal_after{500};
};

/// Runs `wellmesh ARGUMENTS`. One that runs longer than CTest allows is CTest's to kill.
Outcome run_wellmesh(const std::vector<std::string>& arguments, const RunOptions& options = {});

/// A folder of its own for each test, removed at the end.
class ScratchFolder {
public:
    ScratchFolder();
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    [[nodiscard]] std::string write(const std::string& name, const std::string& content) const;  ///< returns the full path
    [[nodiscard]] std::string file(const std::string& name) const { return (path_ / name).string(); }
    [[nodiscard]] std::vector<std::string> listing() const;  ///< names, sorted, hidden ones included

private:
    std::filesystem::path path_;
};

inline constexpr const char* kCubeOff =
    "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n"
    "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n";

using Names = std::vector<std::string>;

[[nodiscard]] inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string read_text(const std::filesystem::path& path);

}  // namespace wellmesh::testing
