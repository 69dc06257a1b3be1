// SPDX-License-Identifier: Apache-2.0
// Files are the same for any number of threads.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "support/any_threads.hpp"
#include "support/grid_mesh.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh {
namespace {

std::map<std::string, std::string> written(const TetMesh& mesh, const std::string& name, WriteOptions options, unsigned threads) {
    const std::filesystem::path folder = std::filesystem::temp_directory_path() / ("wellmesh-write-threads-" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    options.threads = threads;
    std::map<std::string, std::string> contents;
    for (const auto& file : write_mesh(mesh, folder / name, options)) {
        std::ifstream stream(file, std::ios::binary);
        contents[file.filename().string()] = std::string(std::istreambuf_iterator<char>(stream), {});
    }
    std::filesystem::remove_all(folder);
    return contents;
}

TEST(WriteThreads, SameBytes) {
    TetMesh mesh = testing::grid_mesh(18).mesh;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) mesh.vertices[v] = mesh.vertices[v] + 0.1 * Vec3{unit_double(mix64(v)), unit_double(mix64(v, 1)), 0};
    ASSERT_GT(mesh.tets.size(), 34000U);  // more than the pieces of work that two threads have at a time
    for (const bool weighted : {false, true}) {
        if (weighted)
            for (std::size_t v = 0; v < mesh.vertices.size(); ++v) mesh.weights.push_back(1e-3 * unit_double(mix64(v, 2)));
        for (const auto& [name, version] : std::vector<std::pair<std::string, int>>{{"m.mesh", 41}, {"m.vtu", 41}, {"m.msh", 41}, {"m.msh", 22}, {"m.inp", 41}, {"m.node", 41}}) {
            SCOPED_TRACE(name);
            WriteOptions options;
            options.msh_version = version;
            EXPECT_GE(testing::same_for_any_threads([&](unsigned threads) { return written(mesh, name, options, threads); }).size(), 1U);
        }
    }
}

}  // namespace
}  // namespace wellmesh
