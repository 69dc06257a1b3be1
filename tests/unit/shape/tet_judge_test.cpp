// SPDX-License-Identifier: Apache-2.0
// The shortcuts of the judge agree with its full measure, and the blocks of the queue cover space.
#include "shape/tet_judge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/rng.hpp"
#include "refinement/refine.hpp"
#include "shape/blocks.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"

namespace wellmesh::testing {
namespace {

double coordinate(std::uint64_t key, std::uint64_t i) { return static_cast<double>(mix64(key, i) >> 11U) * 0x1p-53; }

TEST(TetJudge, WhatIsSurelyWorseIsWorse) {
    std::size_t sure = 0, worse = 0;
    for (std::uint64_t k = 0; k < 20000; ++k)
        for (const double scale : {1e-60, 1e-6, 1.0, 1e60}) {
            std::array<Vec3, 4> p{};
            for (std::size_t i = 0; i < 4; ++i) p[i] = {scale * coordinate(k, 3 * i), scale * coordinate(k, 3 * i + 1), scale * coordinate(k, 3 * i + 2)};
            if (k % 3 == 0) p[3] = p[0] + 0.3 * (p[1] - p[0]) + 0.3 * (p[2] - p[0]);  // flat, up to rounding
            const double cosine = max_cos_dihedral(p[0], p[1], p[2], p[3]);
            for (const double limit : {0.5, std::cos(std::numbers::pi / 6), 0.99996, cosine, 1.0, kNoAngleCosine}) {
                const bool is_sure = TetJudge::is_surely_worse(p[0], p[1], p[2], p[3], limit);
                EXPECT_TRUE(!is_sure || cosine > limit) << k << ' ' << scale << ' ' << limit;
                sure += is_sure;
                worse += cosine > limit && limit < 1;
            }
        }
    EXPECT_GT(static_cast<double>(sure), 0.7 * static_cast<double>(worse)) << "what it is for";
}

TEST(TetJudge, EvenEdgesBoundAllAngles) {
    const std::array<Vec3, 4> regular{Vec3{1, 1, 1}, Vec3{1, -1, -1}, Vec3{-1, 1, -1}, Vec3{-1, -1, 1}};
    const std::array<Vec3, 4> of_lattice{Vec3{0, 0, 0}, Vec3{0, 0, 1}, Vec3{0.5, 0.5, 0.5}, Vec3{-0.5, 0.5, 0.5}};
    const auto cosine_of = [](double degrees) { return std::cos(degrees * std::numbers::pi / 180); };
    std::size_t sure = 0;
    for (std::uint64_t k = 0; k < 20000; ++k)
        for (const double scale : {1e-90, 1e-6, 1.0, 1e60}) {
            std::array<Vec3, 4> p = k % 2 == 0 ? regular : of_lattice;
            const double by = std::ldexp(1, -static_cast<int>(k % 53));  // from no likeness to rounding
            for (std::size_t i = 0; i < 4; ++i) p[i] = scale * (p[i] + by * Vec3{coordinate(k, 3 * i), coordinate(k, 3 * i + 1), coordinate(k, 3 * i + 2)});
            if (determinant(p[1] - p[0], p[2] - p[0], p[3] - p[0]) < 0) std::swap(p[2], p[3]);
            const double worst = max_cos_dihedral(p[0], p[1], p[2], p[3]);
            for (const double limit : {cosine_of(20), cosine_of(35), cosine_of(60), cosine_of(70.5), worst, std::nextafter(worst, 0), 0.99 * worst}) {
                const bool is_sure = TetJudge::has_even_edges(p[0], p[1], p[2], p[3], limit);
                ASSERT_TRUE(!is_sure || worst <= limit) << k << ' ' << scale << ' ' << limit;
                sure += is_sure;
            }
        }
    EXPECT_GT(sure, 10000U);
    const auto& [a, b, c, d] = of_lattice;
    EXPECT_TRUE(TetJudge::has_even_edges(a, b, d, c, cosine_of(35)) || TetJudge::has_even_edges(a, b, c, d, cosine_of(35))) << "what it is for";
    EXPECT_FALSE(TetJudge::has_even_edges(a, c, b, d, cosine_of(35)) && TetJudge::has_even_edges(a, b, c, d, cosine_of(35))) << "inverted";
}

TEST(TetJudge, WhatIsSurelyGoodIsGood) {
    MeshOptions options;
    options.size.edge_length = 0.15;
    StagedMesh staged(transformed(cube(), 3, 0, 1), options);
    Refiner refiner(staged.mesh, staged.boundary, staged.guard, staged.options);
    staged.conform();
    ASSERT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
    TetJudge judge(staged.mesh, refiner.sizes(), 1.2);  // some are beyond that
    for (const double aspect : {TetJudge::kNoAspect, 8.0, 3.5})
        for (const double angle : {10.0, 30.0, 50.0}) {
            judge.set_goal(std::cos(angle * std::numbers::pi / 180), aspect);
            std::size_t sure = 0, good = 0, sure_in_lanes = 0, beyond_ratio = 0;
            ShapeBatch<TetId> batch;
            const auto look = [&](TetId t, const SquaredShapes& shapes, std::size_t lane) {
                const bool is_sure = judge.is_surely_good(shapes, lane, false), with_ratio = judge.is_surely_good(shapes, lane, true);
                EXPECT_TRUE(!is_sure || judge.shape_badness(t) <= judge.goal()) << angle;
                EXPECT_EQ(with_ratio, is_sure && judge.keeps_radius_edge(t)) << angle;
                sure_in_lanes += is_sure;
                beyond_ratio += is_sure && !with_ratio;
            };
            staged.for_domain([&](TetId t) {
                const bool is_sure = judge.is_surely_good(t);
                EXPECT_TRUE(!is_sure || judge.shape_badness(t) <= judge.goal()) << angle;
                sure += is_sure;
                good += judge.shape_badness(t) <= judge.goal();
                const auto& c = staged.mesh.tets().corners(t);
                batch.add(t, staged.mesh.point(c[0]), staged.mesh.point(c[1]), staged.mesh.point(c[2]), staged.mesh.point(c[3]), look);
            });
            batch.finish(look);
            EXPECT_LE(sure, good);
            EXPECT_LE(sure_in_lanes, good);
            if (aspect == TetJudge::kNoAspect && angle < 50) { EXPECT_GT(beyond_ratio, 0U) << angle; }
            if (aspect != 3.5) {
                EXPECT_GE(static_cast<double>(sure), 0.7 * static_cast<double>(good)) << angle;
                EXPECT_GE(static_cast<double>(sure_in_lanes), 0.7 * static_cast<double>(good)) << angle;
            }
        }
}

/// Powers of two change nothing, however small: fourth powers of volumes would be zero there.
TEST(TetJudge, ShapesAreAsBadAtAnyScale) {
    const auto count_good = [](double scale) {
        MeshOptions options;
        options.size.edge_length = 0.15 * scale;
        StagedMesh staged(transformed(cube(), 3, 0, scale), options);
        Refiner refiner(staged.mesh, staged.boundary, staged.guard, staged.options);
        staged.conform();
        EXPECT_EQ(refiner.refine(), RunGuard::Verdict::go_on);
        TetJudge judge(staged.mesh, refiner.sizes(), 2);
        judge.set_goal(std::cos(20 * std::numbers::pi / 180), 8);
        std::size_t good = 0;
        staged.for_domain([&](TetId t) { good += judge.shape_badness(t) <= judge.goal(); });
        return good;
    };
    const std::size_t good = count_good(1);
    EXPECT_GT(good, 100U);
    for (const double scale : {0x1p-85, 0x1p-100, 0x1p+80}) EXPECT_EQ(count_good(scale), good) << scale;
}

TEST(Blocks, NeighboursShareOneAndThereAreEnough) {
    EXPECT_EQ(Blocks().of({5, 6, 7}), 0U);
    EXPECT_EQ(Blocks({0, 0, 0}, {1, 1, 1}, 1000).of({1, 1, 1}), 0U) << "a small mesh is one block";
    const Blocks blocks({-1, -1, -1}, {1, 1, 1}, 8 * 4096);
    std::array<bool, 8> seen{};
    for (const double x : {-0.5, 0.5})
        for (const double y : {-0.5, 0.5})
            for (const double z : {-0.5, 0.5}) {
                const std::uint32_t block = blocks.of({x, y, z});
                ASSERT_LT(block, 8U);
                EXPECT_FALSE(seen[block]);
                seen[block] = true;
                EXPECT_EQ(blocks.of({x + 0.4 * x, y, z - 0.4 * z}), block);
            }
    EXPECT_EQ(blocks.of({-9, -9, -9}), blocks.of({-0.9, -0.9, -0.9})) << "outside: at the side";
    EXPECT_LT(Blocks({0, 0, 0}, {1, 0, 0}, 1U << 30U).of({1, 0, 0}), 1U << 30U) << "flat boxes";
}

}  // namespace
}  // namespace wellmesh::testing
