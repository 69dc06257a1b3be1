// SPDX-License-Identifier: Apache-2.0
// Nanoseconds of what refinement and shape do again and again on a refined mesh of the unit cube, 26,000 tetrahedra: classify a tetrahedron, judge the
// star of a candidate, move a vertex.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "core/rng.hpp"
#include "quality/tet_shape.hpp"
#include "shape/star_judge.hpp"
#include "shape/vertex_mover.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"

namespace {

using namespace wellmesh;

MeshOptions sized() {
    MeshOptions options;
    options.size.edge_length = 0.08;
    return options;
}

/// Refined, not yet shaped: what the shape stage begins with.
struct Refined {
    testing::StagedMesh staged{testing::cube(), sized()};
    Refiner refiner{staged.mesh, staged.boundary, staged.guard, staged.options};
    TetJudge judge{staged.mesh, refiner.sizes(), refiner.max_radius_edge()};
    VertexMover mover{staged.mesh, staged.boundary, judge, 1};
    std::vector<TetId> tets;
    std::vector<VertexId> inner;

    Refined() {
        staged.conform();
        refiner.refine();
        judge.set_goal(std::cos(30 * std::numbers::pi / 180), TetJudge::kNoAspect);
        staged.for_domain([&](TetId t) { tets.push_back(t); });
        for (std::size_t v = 0; v < staged.mesh.vertex_slots(); ++v)
            if (staged.mesh.triangulation().is_inserted(VertexId{v}) && staged.mesh.info(VertexId{v}).carrier == CarrierKind::region) inner.push_back(VertexId{v});
    }
};

template <class F>
void over_tets(benchmark::State& state, F&& measure) {
    const Refined mesh;
    std::size_t i = 0;
    for (auto _ : state) {
        benchmark::DoNotOptimize(measure(mesh, mesh.tets[i]));
        if (++i == mesh.tets.size()) i = 0;
    }
    state.counters["tets"] = static_cast<double>(mesh.tets.size());
}

void classify_for_refinement(benchmark::State& state) {
    over_tets(state, [](const Refined& mesh, TetId t) {
        double badness = 0;
        return mesh.refiner.classify(t, badness);
    });
}
void smallest_dihedral_angle(benchmark::State& state) {
    over_tets(state, [](const Refined& mesh, TetId t) { return mesh.judge.cosine(t); });
}
void radius_edge_ratio(benchmark::State& state) {
    over_tets(state, [](const Refined& mesh, TetId t) {
        const auto& c = mesh.staged.mesh.tets().corners(t);
        return radius_edge_squared(mesh.staged.mesh.point(c[0]), mesh.staged.mesh.point(c[1]), mesh.staged.mesh.point(c[2]), mesh.staged.mesh.point(c[3]));
    });
}
void size_at_tet(benchmark::State& state) {
    over_tets(state, [](const Refined& mesh, TetId t) { return mesh.judge.keeps_size(t); });
}
void judge_tet(benchmark::State& state) {
    over_tets(state, [](const Refined& mesh, TetId t) { return mesh.judge.badness(t); });
}
void all_shape_measures(benchmark::State& state) {
    over_tets(state, [](const Refined& mesh, TetId t) { return mesh.staged.shape(t); });
}

/// A point near the middle of a tetrahedron, its cavity and the worst of its star. @param kEarly  give up at the first that is below 30 degrees.
template <bool kEarly>
void judge_candidate(benchmark::State& state) {
    Refined mesh;
    Triangulation& triangulation = mesh.staged.mesh.triangulation();
    Cavity cavity;
    std::size_t i = 0, taken = 0;
    for (auto _ : state) {
        const TetId t = mesh.tets[i];
        const auto& c = mesh.staged.mesh.tets().corners(t);
        const Vec3 p = 0.25 * (mesh.staged.mesh.point(c[0]) + mesh.staged.mesh.point(c[1]) + mesh.staged.mesh.point(c[2]) + mesh.staged.mesh.point(c[3]));
        StarJudge star(mesh.staged.mesh, mesh.judge, Placement::in_cell(mesh.staged.mesh.cell(t)), p, kEarly ? mesh.judge.goal() : 1.0);
        taken += triangulation.grow_conflict_cavity(p, t, cavity, [&](const BoundaryFace& b) { return star.take(b); });
        if (++i == mesh.tets.size()) i = 0;
    }
    state.counters["accepted"] = static_cast<double>(taken) / static_cast<double>(state.iterations());
}

/// Attempts to raise the worst angle of the star of an inner vertex; each changes the mesh for the next.
void move_vertex(benchmark::State& state) {
    Refined mesh;
    std::size_t i = 0, moved = 0;
    std::vector<TetId> star;
    for (auto _ : state) {
        const VertexId v = mesh.inner[i];
        mesh.staged.mesh.triangulation().find_star(v, star);
        TetId worst = star.front();
        for (const TetId t : star)
            if (mesh.judge.cosine(t) > mesh.judge.cosine(worst)) worst = t;
        moved += mesh.mover.move(v, worst, mesh.judge.goal(), 30);
        if (++i == mesh.inner.size()) i = 0;
    }
    state.counters["moved"] = static_cast<double>(moved) / static_cast<double>(state.iterations());
}

void smooth_vertex(benchmark::State& state) {
    Refined mesh;
    std::size_t i = 0, moved = 0;
    for (auto _ : state) {
        moved += mesh.mover.smooth(mesh.inner[i], mesh.judge.goal());
        if (++i == mesh.inner.size()) i = 0;
    }
    state.counters["moved"] = static_cast<double>(moved) / static_cast<double>(state.iterations());
}

BENCHMARK(classify_for_refinement);
BENCHMARK(smallest_dihedral_angle);
BENCHMARK(radius_edge_ratio);
BENCHMARK(size_at_tet);
BENCHMARK(judge_tet);
BENCHMARK(all_shape_measures);
BENCHMARK(judge_candidate<false>);
BENCHMARK(judge_candidate<true>);
BENCHMARK(move_vertex)->Iterations(2000);
BENCHMARK(smooth_vertex)->Iterations(2000);

}  // namespace
