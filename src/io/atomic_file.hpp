// SPDX-License-Identifier: Apache-2.0
// Output files that appear complete or not at all.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/workers.hpp"
#include "io/output_text.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh::io {

/// A file under a temporary name in the directory of its target. Text is independent of the locale.
///
/// A target that is not a regular file (a pipe, /dev/stdout, /dev/full) is written directly: a rename would replace the device.
/// A symbolic link is followed, so that the link survives. Every failure throws MeshError{cannot_write}.
class OutputFile {
public:
    /// @param workers  for rows(); must outlive this. nullptr: none.
    OutputFile(const std::filesystem::path& target, std::stop_token stop, Workers* workers = nullptr);
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;
    ~OutputFile();  ///< removes the temporary unless commit() was reached

    void text(std::string_view text);
    void character(char c);
    void integer(std::int64_t value);
    void real(double value);  ///< the shortest decimal that reads back as the same bits
    void bytes(const void* data, std::size_t size);
    void point(const Vec3& p);  ///< three real(), a space between them

    /// Calls write(out, i) for each i below n, several at once; what they write stands in order. `out` has the members above.
    /// @param write  takes an OutputFile& as well as an OutputText&, and reads only what does not change meanwhile.
    template <class Write>
    void rows(std::size_t n, Write&& write) {
        if (workers_ == nullptr || workers_->threads() == 1 || n <= kRows) {
            for (std::size_t i = 0; i < n; ++i) write(*this, i);
            return;
        }
        // A few pieces a thread at a time: enough to do for all of them while memory stays small.
        std::vector<OutputText> pieces(std::size_t{4} * workers_->threads());
        for (std::size_t first = 0; first < n; first += pieces.size() * kRows) {
            const std::size_t last = std::min(n, first + pieces.size() * kRows);
            workers_->for_ranges(last - first, kRows, [&](std::size_t begin, std::size_t end, std::size_t piece) {
                pieces[piece].clear();
                for (std::size_t i = first + begin; i < first + end; ++i) write(pieces[piece], i);
            });
            for (std::size_t piece = 0; piece * kRows < last - first; ++piece) text(pieces[piece].written());
        }
    }

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

    static constexpr std::size_t kRows = 4096;  // a piece of rows()

    std::filesystem::path target_, temporary_;
    std::stop_token stop_;
    Workers* workers_;
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
    /// @param threads  that format; 0: as many as the machine has cores. Files are the same for any number.
    explicit OutputSet(std::stop_token stop = {}, bool sync = false, unsigned threads = 1) : stop_(std::move(stop)), sync_(sync), workers_(threads) {}
    OutputFile& add(const std::filesystem::path& target);
    /// A file that would belong to what these replace: gone once they are there, if it exists.
    void drop(const std::filesystem::path& target) { outdated_.push_back(target); }
    /// @return the targets in the order they were added. @throws MeshError{cannot_write}
    std::vector<std::filesystem::path> commit();

private:
    std::stop_token stop_;
    bool sync_;
    Workers workers_;
    std::vector<std::unique_ptr<OutputFile>> files_;
    std::vector<std::filesystem::path> targets_, outdated_;
};

}  // namespace wellmesh::io
