// SPDX-License-Identifier: Apache-2.0
#include "io/atomic_file.hpp"

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>
#include <stop_token>

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "sample_files.hpp"
#include "sample_mesh.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh::io {
namespace {

using testing::expect_error;
using testing::TemporaryDirectory;
using Names = std::vector<std::string>;

TEST(OutputSet, FilesAppearOnlyWhenAllAreComplete) {
    const TemporaryDirectory directory;
    directory.write("b", "old");
    OutputSet files;
    files.add(directory / "a").text("new a");
    files.add(directory / "b").text("new b");
    EXPECT_EQ(directory.files().size(), 3U) << "two temporaries";
    EXPECT_EQ(TemporaryDirectory::read(directory / "b"), "old");
    EXPECT_EQ(files.commit(), (std::vector{directory / "a", directory / "b"}));
    EXPECT_EQ(directory.files(), (Names{"a", "b"}));
    EXPECT_EQ(TemporaryDirectory::read(directory / "a"), "new a");
    EXPECT_EQ(TemporaryDirectory::read(directory / "b"), "new b");
}

TEST(OutputSet, AnExceptionLeavesNothing) {
    const TemporaryDirectory directory;
    directory.write("a", "old");
    try {
        OutputSet files;
        files.add(directory / "a").text(std::string(5'000'000, 'x'));
        files.add(directory / "b").text("y");
        throw std::runtime_error("elsewhere");
    } catch (const std::runtime_error&) {
    }
    EXPECT_EQ(directory.files(), Names{"a"});
    EXPECT_EQ(TemporaryDirectory::read(directory / "a"), "old");
}

TEST(OutputSet, AFailedRenameTakesTheOthersBack) {
    const TemporaryDirectory directory;
    OutputSet files;
    files.add(directory / "a").text("x");
    files.add(directory / "b").text("y");
    std::filesystem::create_directory(directory / "b");  // appears after the check
    expect_error(ErrorCode::cannot_write, {"/b"}, [&] { (void)files.commit(); });
    EXPECT_FALSE(std::filesystem::exists(directory / "a"));
}

TEST(OutputFile, ShortAndLongWritesKeepTheirOrder) {
    const TemporaryDirectory directory;
    std::string expected;
    OutputSet files;
    OutputFile& out = files.add(directory / "a");
    for (int i = 0; i < 200'000; ++i) {
        out.integer(i);
        out.character(' ');
        out.real(i + 0.1);
        out.character('\n');
        expected += fmt::format("{} {}\n", i, i + 0.1);
        if (i % 50'000 == 0) {
            const std::string block(static_cast<std::size_t>(i) * 30, 'b');
            out.text(block);
            expected += block;
        }
    }
    (void)files.commit();
    EXPECT_TRUE(TemporaryDirectory::read(directory / "a") == expected);
}

TEST(OutputFile, NamesWhatCannotBeWritten) {
    const TemporaryDirectory directory;
    expect_error(ErrorCode::cannot_write, {"none/a", "No such file"}, [&] { OutputFile(directory / "none/a", {}); });
    std::filesystem::create_directory(directory / "d");
    expect_error(ErrorCode::cannot_write, {"/d", "directory"}, [&] { OutputFile(directory / "d", {}); });
    directory.write("file", "x");
    expect_error(ErrorCode::cannot_write, {"file/a"}, [&] { OutputFile(directory / "file/a", {}); });
    expect_error(ErrorCode::cannot_write, {}, [&] { OutputFile(directory / std::string(300, 'n'), {}); });
    EXPECT_EQ(directory.files(), (Names{"d", "file"}));
    EXPECT_EQ(OutputSet().commit(), std::vector<std::filesystem::path>{});
    const std::string longest(255, 'n');  // bytes that Linux allows in a name: the temporary's must not be longer
    OutputSet files;
    files.add(directory / longest).text("x");
    (void)files.commit();
    EXPECT_TRUE(std::filesystem::exists(directory / longest));
}

/// Runs `body` in a child process and returns its result, below 100.
template <class Body>
int result_in_child(Body body) {
    const pid_t child = ::fork();
    if (child < 0) return 100;
    if (child == 0) ::_exit(body());
    int status = 0;
    if (::waitpid(child, &status, 0) != child) return 101;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 200 + WTERMSIG(status);
}

TEST(OutputFile, ReadOnlyDirectoriesAndFilesAreRefused) {
    const TemporaryDirectory directory;
    constexpr uid_t kNobody = 65534;
    std::filesystem::create_directory(directory / "d");
    directory.write("protected", "x");
    for (const auto& path : {directory / "", directory / "d", directory / "protected"})
        if (::geteuid() == 0) {
            ASSERT_EQ(::chown(path.c_str(), kNobody, kNobody), 0);
        }
    ::chmod((directory / "d").c_str(), 0555);
    ::chmod((directory / "protected").c_str(), 0444);
    const int result = result_in_child([&] {
        // Permissions do not bind root.
        if (::geteuid() == 0 && (::setgid(kNobody) != 0 || ::setuid(kNobody) != 0)) return 2;
        for (const char* const name : {"d/a", "protected"}) {
            try {
                const OutputFile file(directory / name, {});
                return 3;
            } catch (const MeshError& error) {
                if (error.code() != ErrorCode::cannot_write) return 4;
            }
        }
        const OutputFile allowed(directory / "b", {});
        return 0;
    });
    EXPECT_EQ(result, 0);
    EXPECT_EQ(directory.files(), (Names{"d", "protected"}));
}

TEST(OutputFile, KeepsModesAndLinks) {
    const TemporaryDirectory directory;
    directory.write("target", "old");
    ::chmod((directory / "target").c_str(), 0640);
    std::filesystem::create_symlink("target", directory / "link");
    OutputSet files;
    files.add(directory / "link").text("new");
    (void)files.commit();
    EXPECT_TRUE(std::filesystem::is_symlink(directory / "link"));
    EXPECT_EQ(TemporaryDirectory::read(directory / "target"), "new");
    struct stat status {};
    ASSERT_EQ(::stat((directory / "target").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777U, 0640U);
}

TEST(DiskFull, DevFullIsAnError) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
    const TemporaryDirectory directory;
    for (const char* const name : {"a.mesh", "a.vtu", "a.msh"}) {
        std::filesystem::create_symlink("/dev/full", directory / name);
        for (const std::uint32_t n : {1U, 20U})  // within and beyond one buffer
            expect_error(ErrorCode::cannot_write, {"/dev/full", "No space"}, [&] { write_mesh(testing::sample_mesh(n), directory / name); });
        EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
    }
    std::filesystem::create_symlink("/dev/full", directory / "b.face");
    expect_error(ErrorCode::cannot_write, {"/dev/full"}, [&] { write_mesh(testing::sample_mesh(3), directory / "b.node"); });
    EXPECT_EQ(directory.files(), (Names{"a.mesh", "a.msh", "a.vtu", "b.face"})) << "no .node without its .face";
}

/// Writes files of at most `limit` bytes in a child process; exit status 0: MeshError{cannot_write} each time and nothing left.
int write_under_size_limit(const TemporaryDirectory& directory, rlim_t limit) {
    const rlimit bound{limit, limit};
    if (::setrlimit(RLIMIT_FSIZE, &bound) != 0) return 2;
    for (const char* const name : {"a.mesh", "a.vtu", "a.msh", "a.node"}) {
        try {
            write_mesh(testing::sample_mesh(26), directory / name);
            return 3;
        } catch (const MeshError& error) {
            if (error.code() != ErrorCode::cannot_write) return 4;
        }
    }
    return directory.files().empty() ? 0 : 5;
}

TEST(DiskFull, AFileSizeLimitIsAnErrorNotASignal) {
    const TemporaryDirectory directory;
    for (const rlim_t limit : {rlim_t{0}, rlim_t{1000}, rlim_t{1'500'000}}) {
        EXPECT_EQ(result_in_child([&] { return write_under_size_limit(directory, limit); }), 0) << "limit " << limit;
    }
}

TEST(Cancelled, AStopLeavesNothing) {
    const TemporaryDirectory directory;
    std::stop_source source;
    source.request_stop();
    for (const char* const name : {"a.mesh", "a.vtu", "a.msh", "a.node"})
        expect_error(ErrorCode::cancelled, {"interrupted"},
                     [&] { write_mesh(testing::sample_mesh(3), directory / name, {.stop = source.get_token()}); });
    EXPECT_TRUE(directory.files().empty());
}

TEST(Written, DevicesAndPipesAreWrittenDirectly) {
    const TemporaryDirectory directory;
    std::filesystem::create_symlink("/dev/null", directory / "a.mesh");
    EXPECT_NO_THROW(write_mesh(testing::sample_mesh(2), directory / "a.mesh", {.sync = true}));
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
    EXPECT_EQ(directory.files(), Names{"a.mesh"});
}

}  // namespace
}  // namespace wellmesh::io
