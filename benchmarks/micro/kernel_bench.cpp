// SPDX-License-Identifier: Apache-2.0
// Nanoseconds of the kernel's operations on a triangulation that is larger than the second-level cache: 100,000 uniform points. Each is timed at points in
// spatial order, as bulk insertion and refinement visit them, and at random ones, which shows what memory costs.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <span>
#include <vector>

#include "core/rng.hpp"
#include "delaunay/spatial_order.hpp"
#include "delaunay/triangulation.hpp"

namespace {

using namespace wellmesh;
constexpr std::size_t kPoints = 100'000, kQueries = 20'000;

std::vector<Vec3> uniform_points(std::size_t count, std::uint64_t stream) {
    std::vector<Vec3> points(count);
    std::uint64_t counter = 0;
    const auto next = [&] { return unit_double(mix64(stream, counter++)); };
    for (Vec3& p : points) {
        p.x = next();
        p.y = next();
        p.z = next();
    }
    return points;
}

std::vector<Vec3> queries(bool in_order) {
    const std::vector<Vec3> points = uniform_points(kQueries, 2);
    if (!in_order) return points;
    std::vector<Vec3> sorted;
    for (const std::uint32_t i : spatial_order(points)) sorted.push_back(points[i]);
    return sorted;
}

Triangulation triangulated() {
    const std::vector<Vec3> points = uniform_points(kPoints, 1);
    Triangulation mesh({0, 0, 0}, {1, 1, 1});
    Workers alone(1);
    mesh.insert_all_in_order(points, biased_spatial_order(points), alone);
    return mesh;
}

void bulk_insertion(benchmark::State& state) {
    const std::vector<Vec3> points = uniform_points(static_cast<std::size_t>(state.range(0)), 1);
    Workers workers(static_cast<unsigned>(state.range(1)));
    for (auto _ : state) {
        Triangulation mesh({0, 0, 0}, {1, 1, 1});
        mesh.insert_all_in_order(points, biased_spatial_order(points, workers), workers);
        benchmark::DoNotOptimize(mesh.tets().live());
    }
    state.SetItemsProcessed(state.iterations() * state.range(0));
}

void spatial_sort(benchmark::State& state) {
    const std::vector<Vec3> points = uniform_points(kPoints, 1);
    for (auto _ : state) benchmark::DoNotOptimize(biased_spatial_order(points).data());
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kPoints));
}

template <bool kInOrder>
void walk(benchmark::State& state) {
    const Triangulation mesh = triangulated();
    const std::vector<Vec3> points = queries(kInOrder);
    std::size_t i = 0;
    TetId near{};
    for (auto _ : state) {
        near = mesh.locate(points[i], near);
        benchmark::DoNotOptimize(near);
        if (++i == points.size()) i = 0;
    }
}

/// With the walk from the last cavity, which is a few steps in order.
template <bool kInOrder>
void conflict_cavity(benchmark::State& state) {
    Triangulation mesh = triangulated();
    const std::vector<Vec3> points = queries(kInOrder);
    std::size_t i = 0, tets = 0;
    TetId near = mesh.locate(points[0], {});
    Cavity cavity;
    for (auto _ : state) {
        mesh.find_conflict_cavity(points[i], near, cavity);
        near = cavity.tets.front();
        tets += cavity.tets.size();
        if (++i == points.size()) i = 0;
    }
    state.counters["tets"] = static_cast<double>(tets) / static_cast<double>(state.iterations());
}

/// Inserts a batch and takes it out again. @param kRemoval  time the removals, else the insertions, each with its search.
template <bool kRemoval>
void batch(benchmark::State& state) {
    Triangulation mesh = triangulated();
    const std::vector<Vec3> points = queries(true);
    std::vector<VertexId> made;
    for (const Vec3& p : points) made.push_back(mesh.add_point(p));
    Cavity cavity;
    Hole hole;
    TetId near = mesh.locate(points[0], {});
    const auto insert_all = [&] {
        for (std::size_t i = 0; i < points.size(); ++i) {
            mesh.find_conflict_cavity(points[i], near, cavity);
            mesh.insert_vertex(made[i], cavity);
            near = mesh.new_tets().front();
        }
    };
    const auto remove_all = [&] {
        for (const VertexId v : made)
            if (mesh.find_hole(v, hole)) mesh.remove_vertex(hole);
        near = mesh.new_tets().front();
    };
    for (auto _ : state) {
        if (kRemoval) {
            state.PauseTiming();
            insert_all();
            state.ResumeTiming();
            remove_all();
        } else {
            insert_all();
            state.PauseTiming();
            remove_all();
            state.ResumeTiming();
        }
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kQueries));
}

BENCHMARK(bulk_insertion)->Args({10'000, 1})->Args({100'000, 1})->Args({1'000'000, 1})->Args({1'000'000, 2})->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(spatial_sort)->Unit(benchmark::kMillisecond);
BENCHMARK(walk<true>);
BENCHMARK(walk<false>);
BENCHMARK(conflict_cavity<true>);
BENCHMARK(conflict_cavity<false>);
BENCHMARK(batch<false>)->Name("insertion_of_20000")->Unit(benchmark::kMillisecond);
BENCHMARK(batch<true>)->Name("removal_of_20000")->Unit(benchmark::kMillisecond);

}  // namespace
