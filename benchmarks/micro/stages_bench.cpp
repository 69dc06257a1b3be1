// SPDX-License-Identifier: Apache-2.0
// Milliseconds of the pipeline's stages, by its own timers: made domains at about 20,000 and 200,000 tetrahedra, and models that are named.
//
//   stages_bench [--model FILE --size H]... [Google Benchmark's options]
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "support/synthetic_plcs.hpp"
#include "wellmesh/wellmesh.hpp"

namespace {

using namespace wellmesh;

void stages(benchmark::State& state, const Plc& plc, double size, double degrees) {
    MeshOptions options;
    options.size.edge_length = size;
    options.quality.min_dihedral_angle_deg = degrees;
    std::vector<std::pair<std::string, double>> seconds;
    double tets = 0;
    for (auto _ : state) {
        const MeshResult result = generate(plc, options);
        tets = static_cast<double>(result.mesh.tets.size());
        for (std::size_t i = 0; i < result.statistics.stages.size(); ++i) {
            if (i == seconds.size()) seconds.emplace_back(to_string(result.statistics.stages[i].stage), 0.0);
            seconds[i].second += result.statistics.stages[i].seconds;
        }
    }
    for (const auto& [stage, sum] : seconds) state.counters[stage + "_ms"] = 1e3 * sum / static_cast<double>(state.iterations());
    state.counters["tets"] = tets;
}

void add(const std::string& name, const Plc& plc, double size) {
    for (const double degrees : {0.0, 20.0, 30.0})
        benchmark::RegisterBenchmark((name + "/" + std::to_string(static_cast<int>(degrees)) + "_degrees").c_str(),
                                     [=](benchmark::State& state) { stages(state, plc, size, degrees); })
            ->Unit(benchmark::kMillisecond);
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::string> models;
    std::vector<double> sizes;
    int kept = 1;
    for (int i = 1; i < argc; ++i) {
        if (std::strcmp(argv[i], "--model") == 0 && i + 1 < argc) models.emplace_back(argv[++i]);
        else if (std::strcmp(argv[i], "--size") == 0 && i + 1 < argc) sizes.push_back(std::atof(argv[++i]));
        else argv[kept++] = argv[i];
    }
    argc = kept;
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv) || models.size() != sizes.size()) return 3;
    // Volume over tetrahedra over 0.112: the cube of the edge length.
    add("cube_20k", testing::cube(), 0.0764);
    add("cube_200k", testing::cube(), 0.0355);
    add("l_block_200k", testing::l_block(), 0.0512);
    add("stepped_shaft", testing::stepped_shaft(), testing::diagonal(testing::stepped_shaft()) / 60);
    for (std::size_t m = 0; m < models.size(); ++m) add(std::filesystem::path(models[m]).filename().string(), read_plc(models[m]), sizes[m]);
    benchmark::RunSpecifiedBenchmarks();
}
