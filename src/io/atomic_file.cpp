// SPDX-License-Identifier: Apache-2.0
#include "io/atomic_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <ctime>
#include <cstdio>
#include <cstring>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "wellmesh/error.hpp"

namespace wellmesh::io {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;
constexpr int kNameAttempts = 1000;

/// Beyond RLIMIT_FSIZE a write raises SIGXFSZ, which by default kills the process and would leave the temporary behind.
/// While this lives the signal is held back from this thread and write() just fails with EFBIG.
class HoldFileSizeSignal {
public:
    HoldFileSizeSignal() {
        sigemptyset(&held_);
        sigaddset(&held_, SIGXFSZ);
        sigset_t pending;
        was_pending_ = sigpending(&pending) == 0 && sigismember(&pending, SIGXFSZ) == 1;
        blocked_ = pthread_sigmask(SIG_BLOCK, &held_, &before_) == 0;
    }
    HoldFileSizeSignal(const HoldFileSizeSignal&) = delete;
    HoldFileSizeSignal& operator=(const HoldFileSizeSignal&) = delete;
    ~HoldFileSizeSignal() {
        if (!blocked_) return;
        const int error = errno;
        const timespec no_wait{};
        if (!was_pending_)
            while (sigtimedwait(&held_, nullptr, &no_wait) == -1 && errno == EINTR) {}
        pthread_sigmask(SIG_SETMASK, &before_, nullptr);
        errno = error;
    }

private:
    sigset_t held_{}, before_{};
    bool was_pending_ = false, blocked_ = false;
};

std::filesystem::path followed(const std::filesystem::path& target) {
    std::error_code error;
    if (!std::filesystem::is_symlink(target, error) || error) return target;
    const std::filesystem::path end = std::filesystem::weakly_canonical(target, error);
    return error ? target : end;
}

}  // namespace

OutputFile::OutputFile(const std::filesystem::path& target, std::stop_token stop, Workers* workers)
    : target_(followed(target)), stop_(std::move(stop)), workers_(workers), buffer_(kBufferBytes) {
    struct stat status {};
    if (::stat(target_.c_str(), &status) != 0) {
        if (errno != ENOENT) fail("open", errno);
        open_temporary();
        return;
    }
    if (S_ISDIR(status.st_mode)) fail("open", EISDIR);
    if (!S_ISREG(status.st_mode)) {
        open_directly();
        return;
    }
    // A rename would replace a file that its owner protected against writing.
    if (::access(target_.c_str(), W_OK) != 0) fail("open", errno);
    open_temporary();
    if (::fchmod(descriptor_, status.st_mode & 07777) != 0) {
        const int error = errno;
        ::close(std::exchange(descriptor_, -1));
        ::unlink(temporary_.c_str());
        fail("set the mode of", error);
    }
}

OutputFile::~OutputFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!direct_ && !committed_ && !temporary_.empty()) ::unlink(temporary_.c_str());
}

void OutputFile::fail(const char* doing, int error) const {
    throw MeshError(ErrorCode::cannot_write, Stage::write,
                    fmt::format("cannot {} {}: {}", doing, target_.string(), std::generic_category().message(error)),
                    {{EntityKind::file, 0, {}}});
}

void OutputFile::open_temporary() {
    static std::atomic<unsigned> counter{0};  // only makes names differ between threads; never shows in the output
    for (int attempt = 0; attempt < kNameAttempts; ++attempt) {
        // Short, whatever the target's length: a name of 255 bytes must not become too long.
        temporary_ = target_.parent_path() / fmt::format(".wellmesh-{}-{}.tmp", ::getpid(), counter.fetch_add(1));
        descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor_ >= 0) return;
        if (errno != EEXIST) break;
    }
    const int error = errno;
    temporary_.clear();
    fail("create", error);
}

void OutputFile::open_directly() {
    direct_ = true;
    descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail("open", errno);
}

void OutputFile::write_out(const char* data, std::size_t size) {
    if (stop_.stop_requested()) throw MeshError(ErrorCode::cancelled, Stage::write, "interrupted in stage write, while writing " + target_.string());
    const HoldFileSizeSignal hold;
    while (size > 0) {
        const ssize_t wrote = ::write(descriptor_, data, size);
        if (wrote < 0 && errno == EINTR) continue;
        if (wrote <= 0) fail("write", wrote < 0 ? errno : ENOSPC);
        data += wrote;
        size -= static_cast<std::size_t>(wrote);
    }
}

void OutputFile::flush() {
    write_out(buffer_.data(), std::exchange(used_, 0));
}

void OutputFile::text(std::string_view text) {
    bytes(text.data(), text.size());
}

void OutputFile::bytes(const void* data, std::size_t size) {
    const char* from = static_cast<const char*>(data);
    if (size > buffer_.size() - used_) flush();
    if (size >= buffer_.size()) {
        while (size > 0) {  // in pieces, so that a stop is noticed
            const std::size_t piece = std::min(size, kBufferBytes);
            write_out(from, piece);
            from += piece;
            size -= piece;
        }
        return;
    }
    if (size > 0) std::memcpy(buffer_.data() + used_, from, size);
    used_ += size;
}

void OutputFile::character(char c) {
    if (used_ == buffer_.size()) flush();
    buffer_[used_++] = c;
}

void OutputFile::integer(std::int64_t value) {
    if (buffer_.size() - used_ < kLongestNumber) flush();
    char* const first = buffer_.data() + used_;
    used_ += static_cast<std::size_t>(std::to_chars(first, first + kLongestNumber, value).ptr - first);
}

void OutputFile::real(double value) {
    if (buffer_.size() - used_ < kLongestNumber) flush();
    char* const first = buffer_.data() + used_;
    used_ += static_cast<std::size_t>(std::to_chars(first, first + kLongestNumber, value).ptr - first);
}

void OutputFile::point(const Vec3& p) {
    real(p.x);
    character(' ');
    real(p.y);
    character(' ');
    real(p.z);
}

void OutputFile::finish(bool sync) {
    flush();
    if (sync && !direct_ && ::fsync(descriptor_) != 0) fail("write", errno);
    // On Linux the descriptor is gone even if close() reports EINTR or an error.
    if (::close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR) fail("write", errno);
    buffer_.clear();
    buffer_.shrink_to_fit();
}

void OutputFile::commit() {
    if (!direct_ && std::rename(temporary_.c_str(), target_.c_str()) != 0) fail("replace", errno);
    committed_ = true;
}

void OutputFile::retract() noexcept {
    if (committed_ && !direct_) ::unlink(target_.c_str());
}

OutputFile& OutputSet::add(const std::filesystem::path& target) {
    files_.push_back(std::make_unique<OutputFile>(target, stop_, &workers_));
    targets_.push_back(target);
    return *files_.back();
}

std::vector<std::filesystem::path> OutputSet::commit() {
    for (const auto& file : files_) file->finish(sync_);
    try {
        for (const auto& file : files_) file->commit();
    } catch (...) {
        for (const auto& file : files_) file->retract();
        throw;
    }
    std::error_code ignored;
    for (const auto& target : outdated_)
        if (std::filesystem::is_regular_file(target, ignored)) std::filesystem::remove(target, ignored);
    return std::exchange(targets_, {});
}

}  // namespace wellmesh::io
