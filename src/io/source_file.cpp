// SPDX-License-Identifier: Apache-2.0
#include "io/source_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <system_error>

#include <fmt/format.h>

#include "core/page_memory.hpp"

namespace wellmesh::io {
namespace {

constexpr std::size_t kLongestQuote = 40;          // bytes of a token that a message repeats
constexpr std::size_t kLargeFile = std::size_t{1} << 18;  // bytes; smaller ones are read before threads have started
constexpr std::size_t kChunk = std::size_t{1} << 20;

[[noreturn]] void cannot_read(const std::string& name, const std::string& why) {
    throw MeshError(ErrorCode::cannot_read, Stage::read, fmt::format("cannot read {}: {}", name, why), {{EntityKind::file, 0, {}}});
}

std::string system_message(int error) { return std::generic_category().message(error); }

class Descriptor {
public:
    explicit Descriptor(int fd) : fd_(fd) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() {
        if (fd_ >= 0) ::close(fd_);
    }
    [[nodiscard]] int get() const { return fd_; }

private:
    int fd_;
};

}  // namespace

SourceFile read_source(const std::filesystem::path& path, unsigned threads) {
    SourceFile source{path, path.string(), {}, threads};
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (file.get() < 0) cannot_read(source.name, system_message(errno));
    struct stat status {};
    if (::fstat(file.get(), &status) != 0) cannot_read(source.name, system_message(errno));
    if (S_ISDIR(status.st_mode)) cannot_read(source.name, "it is a directory");
    if (!S_ISREG(status.st_mode) && !S_ISFIFO(status.st_mode)) cannot_read(source.name, "it is neither a regular file nor a pipe");

    std::string& bytes = source.bytes;
    std::size_t used = 0;
    // One byte more than the size, so that the read() that finds the end needs no further room.
    bytes.reserve(S_ISREG(status.st_mode) ? static_cast<std::size_t>(std::max<off_t>(status.st_size, 0)) + 1 : kChunk);
    advise_huge_pages(bytes.data(), bytes.capacity());
    bytes.resize(bytes.capacity());
    while (true) {
        if (used == bytes.size()) bytes.resize(bytes.size() + std::max(kChunk, bytes.size() / 2));
        const ssize_t got = ::read(file.get(), bytes.data() + used, bytes.size() - used);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) cannot_read(source.name, system_message(errno));
        if (got == 0) break;
        used += static_cast<std::size_t>(got);
    }
    bytes.resize(used);
    if (bytes.empty()) fail_in_file(source, "the file is empty");
    if (bytes.size() >= kLargeFile && threads != 1) source.workers = std::make_unique<Workers>(threads);
    if (source.workers && source.workers->threads() == 1) source.workers.reset();  // one core, or no more threads to be had
    return source;
}

std::string quoted_token(std::string_view token) {
    std::string out = "'";
    for (const char c : token.substr(0, kLongestQuote)) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte >= 0x7f)
            out += fmt::format("\\x{:02x}", byte);
        else
            out += c;
    }
    out += token.size() > kLongestQuote ? "...'" : "'";
    return out;
}

void fail_at_line(const SourceFile& source, std::uint64_t line, const std::string& message) {
    throw MeshError(ErrorCode::bad_input, Stage::read, fmt::format("{}:{}: {}", source.name, line, message), {{EntityKind::file, line, {}}});
}

void fail_at_byte(const SourceFile& source, std::uint64_t byte, const std::string& message) {
    throw MeshError(ErrorCode::bad_input, Stage::read, fmt::format("{}: byte {}: {}", source.name, byte, message), {{EntityKind::file, 0, {}}});
}

void fail_in_file(const SourceFile& source, const std::string& message) {
    throw MeshError(ErrorCode::bad_input, Stage::read, fmt::format("{}: {}", source.name, message), {{EntityKind::file, 0, {}}});
}

std::string lower_case_extension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return extension;
}

}  // namespace wellmesh::io
