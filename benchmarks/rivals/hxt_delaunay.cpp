// SPDX-License-Identifier: Apache-2.0
// hxt_delaunay POINTS.node [THREADS]: the Delaunay kernel of HXT, out of Gmsh's shared library; prints one JSON object.
// Counted: hxtDelaunay(), which sorts the points itself; reading, and copying into HXT's array of four doubles a point, are not.
//
// HXT has no installed header: what is declared here is the binary interface of Gmsh 4.8 (Debian 12). CMakeLists.txt takes no other.
#include <cstdint>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "points.hpp"

extern "C" {
struct Mesh {  // the part of it that is used
    struct {
        double* coord;
        std::uint32_t num, size;
    } vertices;
    struct {
        std::uint32_t* node;
        std::uint64_t* neighbour;
        void* colour;
        std::uint16_t* flag;
        std::uint64_t num, size;
    } tetrahedra;
};
struct Options {
    void* box;
    void* nodal_sizes;
    std::uint32_t vertices_in_mesh, insertion_first;
    double partitionability;
    int perfect_delaunay, allow_outer_insertion, verbosity, reproducible, threads;
};
int hxtMeshCreate(Mesh** mesh);
int hxtDelaunay(Mesh* mesh, Options* options);
}

int main(int argc, char** argv) {
    if (argc != 2 && argc != 3) return 3;
    const auto points = read_points(argv[1]);
    Mesh* mesh = nullptr;
    if (hxtMeshCreate(&mesh) != 0) return 1;
    const auto count = static_cast<std::uint32_t>(points.size());
    // HXT asks for memory aligned to its vectors; 64 bytes are enough for all of them.
    mesh->vertices.coord = static_cast<double*>(std::aligned_alloc(64, (4 * sizeof(double) * points.size() + 63) / 64 * 64));
    if (!mesh->vertices.coord) return 1;
    for (std::size_t i = 0; i < points.size(); ++i) std::memcpy(mesh->vertices.coord + 4 * i, points[i].data(), 3 * sizeof(double));
    mesh->vertices.num = mesh->vertices.size = count;
    Options options{};
    options.perfect_delaunay = 1;
    options.threads = argc == 3 ? std::atoi(argv[2]) : 1;
    const auto start = std::chrono::steady_clock::now();
    if (hxtDelaunay(mesh, &options) != 0) return 1;
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::uint64_t finite = 0;
    for (std::uint64_t t = 0; t < mesh->tetrahedra.num; ++t) finite += mesh->tetrahedra.node[4 * t + 3] != UINT32_MAX;
    std::printf("{\"version\": \"HXT of Gmsh 4.8\", \"seconds\": %.6f, \"tets\": %llu, \"vertices\": %u}\n", seconds.count(), static_cast<unsigned long long>(finite), mesh->vertices.num);
}
