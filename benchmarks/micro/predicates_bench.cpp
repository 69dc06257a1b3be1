// SPDX-License-Identifier: Apache-2.0
// Nanoseconds a predicate call, by what the points make it do. Points fit into the first-level cache; signs are those of a
// Delaunay kernel at work (positive tetrahedra, mostly outside points), so that branch prediction behaves as it does there.
#include <benchmark/benchmark.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/rng.hpp"
#include "predicates/predicates_internal.hpp"

namespace {

using namespace wellmesh;
using Quintuple = std::array<Vec3, 5>;
constexpr std::size_t kCases = 200;

class Numbers {
public:
    double next() { return unit_double(mix64(1, counter_++)); }
    Vec3 point() {
        const double x = next(), y = next();
        return {x, y, next()};
    }

private:
    std::uint64_t counter_ = 0;
};

/// Positive tetrahedra in the unit cube and a point outside of the circumsphere.
std::vector<Quintuple> generic_points() {
    Numbers numbers;
    std::vector<Quintuple> result;
    while (result.size() < kCases) {
        Quintuple q;
        for (Vec3& p : q) p = numbers.point();
        if (orient3d(q[0], q[1], q[2], q[3]) == Sign::negative) std::swap(q[0], q[1]);
        if (insphere(q[0], q[1], q[2], q[3], q[4]) == Sign::negative) result.push_back(q);
    }
    return result;
}

/// Points of a slanted plane, rounded.
std::vector<Quintuple> slanted_points() {
    Numbers numbers;
    std::vector<Quintuple> result(kCases);
    for (Quintuple& q : result)
        for (Vec3& p : q) {
            const double s = numbers.next() - 0.5, t = numbers.next() - 0.5;
            p = {0.3 * s + 0.8 * t + 0.1, -0.7 * s + 0.1 * t, 0.2 * s + 0.33 * t};
        }
    return result;
}

/// Four corners of a cube that make a positive tetrahedron, and a fifth: cospherical; exactly so for spacing 1.
std::vector<Quintuple> cube_corners(double spacing) {
    Numbers numbers;
    std::vector<Quintuple> result;
    while (result.size() < kCases) {
        Quintuple q;
        for (Vec3& p : q) {
            const auto corner = static_cast<unsigned>(8 * numbers.next());
            p = {spacing * (1 + (corner & 1U)), spacing * (3 + (corner >> 1U & 1U)), spacing * (2 + (corner >> 2U))};
        }
        if (orient3d(q[0], q[1], q[2], q[3]) != Sign::positive) continue;
        if (q[4] == q[0] || q[4] == q[1] || q[4] == q[2] || q[4] == q[3]) continue;
        result.push_back(q);
    }
    return result;
}

template <class Predicate>
void run(benchmark::State& state, const std::vector<Quintuple>& cases, Predicate predicate) {
    const std::uint64_t exact_calls = exact_predicate_calls();
    std::size_t i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(predicate(cases[i]));
        if (++i == cases.size()) i = 0;
    }
    state.counters["exact_share"] = static_cast<double>(exact_predicate_calls() - exact_calls) / static_cast<double>(state.iterations());
}

const PredicateFilter kUnitBox(Vec3{1, 1, 1}), kNoFilter;

template <std::vector<Quintuple> (*Points)()>
void orient3d_filtered(benchmark::State& state) {
    run(state, Points(), [](const Quintuple& q) { return kUnitBox.orient3d(q[0], q[1], q[2], q[3]); });
}
template <std::vector<Quintuple> (*Points)()>
void orient3d_unfiltered(benchmark::State& state) {
    run(state, Points(), [](const Quintuple& q) { return kNoFilter.orient3d(q[0], q[1], q[2], q[3]); });
}
template <std::vector<Quintuple> (*Points)()>
void insphere_filtered(benchmark::State& state) {
    run(state, Points(), [](const Quintuple& q) { return kUnitBox.insphere(q[0], q[1], q[2], q[3], q[4]); });
}
template <std::vector<Quintuple> (*Points)()>
void insphere_unfiltered(benchmark::State& state) {
    run(state, Points(), [](const Quintuple& q) { return kNoFilter.insphere_perturbed(q[0], q[1], q[2], q[3], q[4]); });
}
template <std::vector<Quintuple> (*Points)()>
void diametral(benchmark::State& state) {
    run(state, Points(), [](const Quintuple& q) { return side_of_diametral_sphere(q[0], q[1], q[2]); });
}
template <std::vector<Quintuple> (*Points)()>
void equatorial(benchmark::State& state) {
    run(state, Points(), [](const Quintuple& q) { return side_of_equatorial_sphere(q[0], q[1], q[2], q[3]); });
}
std::vector<Quintuple> integer_cube() { return cube_corners(1); }
std::vector<Quintuple> decimal_cube() { return cube_corners(0.1); }

BENCHMARK(orient3d_filtered<generic_points>);
BENCHMARK(orient3d_filtered<slanted_points>);
BENCHMARK(orient3d_unfiltered<generic_points>);
BENCHMARK(insphere_filtered<generic_points>);
BENCHMARK(insphere_filtered<slanted_points>);
BENCHMARK(insphere_unfiltered<generic_points>);
BENCHMARK(insphere_unfiltered<integer_cube>);
BENCHMARK(insphere_unfiltered<decimal_cube>);
BENCHMARK(diametral<generic_points>);
BENCHMARK(equatorial<generic_points>);
BENCHMARK(equatorial<integer_cube>);

}  // namespace
