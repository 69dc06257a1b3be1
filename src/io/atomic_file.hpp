// SPDX-License-Identifier: Apache-2.0
// Output files that appear complete or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "wellmesh/vec3.hpp"

namespace wellmesh::io {

/// A file under a temporary name in the directory of its target. Text is independent of the locale.
///
/// A target that is not a regular file (a pipe, /dev/stdout, /dev/full) is written directly: a rename would replace the device.
/// A symbolic link is followed, so that the link survives. Every failure throws MeshError{cannot_write}.
class OutputFile {
public:
    OutputFile(const std::filesystem::path& target, std::stop_token stop);
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;
    ~OutputFile();  ///< removes the temporary unless commit() was reached

    void text(std::string_view text);
    void character(char c);
    void integer(std::int64_t value);
    void real(double value);  ///< the shortest decimal that reads back as the same bits
    void bytes(const void* data, std::size_t size);
    void point(const Vec3& p);  ///< three real(), a space between them

    /// Writes what is buffered and closes; the data must be safe (quotas, network) before anything is renamed.
    void finish(bool sync);
    /// Renames over the target. @pre finish()
    void commit();
    /// Removes a committed file again, because another one of its set could not be committed.
    void retract() noexcept;

private:
    void open_temporary();
    void open_directly();
    void flush();
    void write_out(const char* data, std::size_t size);
    [[noreturn]] void fail(const char* doing, int error) const;

    std::filesystem::path target_, temporary_;
    std::stop_token stop_;
    std::vector<char> buffer_;
    std::size_t used_ = 0;
    int descriptor_ = -1;
    bool direct_ = false, committed_ = false;
};

/// Files that belong together: all are complete on disk before the first is renamed. If it goes out of scope before
/// commit(), by an exception say, nothing is left. Should a rename fail, the ones already renamed are removed, because files of
/// two different meshes side by side are worse than none.
class OutputSet {
public:
    explicit OutputSet(std::stop_token stop = {}, bool sync = false) : stop_(std::move(stop)), sync_(sync) {}
    OutputFile& add(const std::filesystem::path& target);
    /// A file that would belong to what these replace: gone once they are there, if it exists.
    void drop(const std::filesystem::path& target) { outdated_.push_back(target); }
    /// @return the targets in the order they were added. @throws MeshError{cannot_write}
    std::vector<std::filesystem::path> commit();

private:
    std::stop_token stop_;
    bool sync_;
    std::vector<std::unique_ptr<OutputFile>> files_;
    std::vector<std::filesystem::path> targets_, outdated_;
};

}  // namespace wellmesh::io
