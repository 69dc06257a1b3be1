// SPDX-License-Identifier: Apache-2.0
#include "output_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

#include "wellmesh/error.hpp"

namespace wellmesh::cli {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const std::string& path, int error) {
    throw MeshError(ErrorCode::cannot_write, Stage::write, fmt::format("cannot write {}: {}", path, std::strerror(error)));
}

/// @return 0 or the errno of the first failure.
int write_all(int descriptor, std::string_view text) {
    while (!text.empty()) {
        const ssize_t written = ::write(descriptor, text.data(), text.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return errno;
        text.remove_prefix(static_cast<std::size_t>(written));
    }
    return 0;
}

int write_and_close(int descriptor, std::string_view text) {
    int error = write_all(descriptor, text);
    if (::close(descriptor) != 0 && error == 0) error = errno;  // e.g. a quota noticed late
    return error;
}

}  // namespace

fs::path resolved(const fs::path& path) {
    // Absolute first: weakly_canonical leaves a name relative when no part of it exists.
    std::error_code error;
    const fs::path target = fs::weakly_canonical(fs::absolute(path, error), error);
    return error ? path : target;
}

void write_stdout(std::string_view text) {
    if (const int error = write_all(STDOUT_FILENO, text); error != 0) fail("standard output", error);
}

void write_text(const std::string& path, std::string_view text) {
    if (path == kStandardOutput) return write_stdout(text);
    const fs::path target = resolved(path);
    std::error_code ignored;
    const fs::file_status status = fs::status(target, ignored);
    if (fs::exists(status) && !fs::is_regular_file(status)) {
        const int descriptor = ::open(target.c_str(), O_WRONLY | O_CLOEXEC);
        if (descriptor < 0) fail(path, errno);
        if (const int error = write_and_close(descriptor, text); error != 0) fail(path, error);
        return;
    }
    const fs::path temporary = target.parent_path() / fmt::format(".wellmesh-report.{}.tmp", ::getpid());  // no longer than any name may be
    const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor < 0) fail(path, errno);
    int error = write_and_close(descriptor, text);
    if (error == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) error = errno;
    if (error != 0) {
        ::unlink(temporary.c_str());
        fail(path, error);
    }
}

void require_writable(const fs::path& path) {
    if (path == kStandardOutput) return;
    const fs::path target = resolved(path);
    std::error_code ignored;
    const fs::file_status status = fs::status(target, ignored);
    if (fs::is_directory(status)) fail(path.string(), EISDIR);
    const bool in_place = fs::exists(status) && !fs::is_regular_file(status);
    if (::access(in_place ? target.c_str() : target.parent_path().c_str(), W_OK) != 0) fail(path.string(), errno);
}

}  // namespace wellmesh::cli
