// SPDX-License-Identifier: Apache-2.0
#include "cli/run_program.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace wellmesh::testing {

namespace fs = std::filesystem;

namespace {

struct Pipe {
    int read = -1, write = -1;
};

Pipe make_pipe() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("pipe2 failed");
    return {ends[0], ends[1]};
}

Pipe make_terminal() {
    int master = -1, slave = -1;
    if (openpty(&master, &slave, nullptr, nullptr, nullptr) != 0) throw std::runtime_error("openpty failed");
    fcntl(master, F_SETFD, FD_CLOEXEC);
    fcntl(slave, F_SETFD, FD_CLOEXEC);
    return {master, slave};
}

void limit(int resource, std::optional<std::uint64_t> most) {
    if (!most) return;
    const rlimit value{*most, *most};
    setrlimit(static_cast<__rlimit_resource>(resource), &value);
}

/// After fork: becomes the program, or dies with a status that no test expects.
[[noreturn]] void become_program(const std::vector<std::string>& arguments, const RunOptions& options, int out, int err) {
    if (!options.folder.empty() && chdir(options.folder.c_str()) != 0) _exit(99);
    const int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    setenv("TERM", "xterm", 1);
    limit(RLIMIT_FSIZE, options.file_size_limit);
    limit(RLIMIT_AS, options.address_space_limit);
    std::signal(SIGINT, options.ignore_interrupt ? SIG_IGN : SIG_DFL);
    std::signal(SIGPIPE, SIG_DFL);
    std::vector<char*> argv = {const_cast<char*>("wellmesh")};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    execv(WELLMESH_PROGRAM, argv.data());
    _exit(99);
}

/// Reads both streams to their ends, sending the signal on the way.
void collect(pid_t child, const RunOptions& options, int out, int err, Outcome& outcome) {
    const auto start = std::chrono::steady_clock::now();
    bool signal_due = options.signal.has_value();
    std::vector<pollfd> streams = {{err, POLLIN, 0}};
    if (out >= 0) streams.push_back({out, POLLIN, 0});
    while (!streams.empty()) {
        const int ready = poll(streams.data(), streams.size(), signal_due ? 10 : -1);
        if (signal_due && std::chrono::steady_clock::now() - start >= options.signal_after) {
            kill(child, *options.signal);
            signal_due = false;
        }
        if (ready <= 0) continue;
        for (pollfd& stream : streams) {
            if (stream.revents == 0) continue;
            char buffer[4096];
            const ssize_t got = read(stream.fd, buffer, sizeof buffer);
            if (got > 0) (stream.fd == out ? outcome.out : outcome.err).append(buffer, static_cast<std::size_t>(got));
            else stream.events = 0;  // ended; a terminal says EIO
        }
        std::erase_if(streams, [](const pollfd& stream) { return stream.events == 0; });
    }
}

}  // namespace

Outcome run_wellmesh(const std::vector<std::string>& arguments, const RunOptions& options) {
    Outcome outcome;
    const Pipe out = make_pipe();
    const Pipe err = options.terminal ? make_terminal() : make_pipe();
    if (options.closed_stdout) close(out.read);
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("fork failed");
    if (child == 0) become_program(arguments, options, out.write, err.write);
    close(out.write);
    close(err.write);
    collect(child, options, options.closed_stdout ? -1 : out.read, err.read, outcome);
    if (!options.closed_stdout) close(out.read);
    close(err.read);
    int status = 0;
    waitpid(child, &status, 0);
    outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return outcome;
}

ScratchFolder::ScratchFolder() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = fmt::format("wellmesh-{}-{}-{}", test->test_suite_name(), test->name(), getpid());
    std::replace(name.begin(), name.end(), '/', '_');
    path_ = fs::temp_directory_path() / name;
    fs::remove_all(path_);
    fs::create_directories(path_);
}

ScratchFolder::~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

std::string ScratchFolder::write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return file(name);
}

std::vector<std::string> ScratchFolder::listing() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(path_)) names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

std::string read_text(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

}  // namespace wellmesh::testing
