// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "conforming/boundary_refiner.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh::testing {
namespace {

constexpr unsigned kPoints = 300;

TEST(PickingPoint, TheFirstIsTheCentre) {
    for (unsigned dimension = 1; dimension <= 3; ++dimension)
        for (std::uint64_t key = 0; key < 5; ++key) EXPECT_EQ(picking_point(dimension, key, 0), Vec3{});
}

TEST(PickingPoint, LiesInTheBallOfItsDimension) {
    for (unsigned dimension = 1; dimension <= 3; ++dimension)
        for (std::uint64_t key = 0; key < 20; ++key)
            for (unsigned k = 1; k < kPoints; ++k) {
                const Vec3 p = picking_point(dimension, mix64(key), k);
                ASSERT_LE(squared_norm(p), 1.0);
                if (dimension < 3) { ASSERT_EQ(p.z, 0.0); }
                if (dimension < 2) { ASSERT_EQ(p.y, 0.0); }
            }
}

TEST(PickingPoint, DependsOnItsArgumentsAlone) {
    for (unsigned dimension = 1; dimension <= 3; ++dimension) {
        std::vector<Vec3> forwards, backwards;
        for (unsigned k = 1; k < kPoints; ++k) forwards.push_back(picking_point(dimension, 42, k));
        for (unsigned k = kPoints; --k >= 1;) backwards.push_back(picking_point(dimension, 42, k));
        std::reverse(backwards.begin(), backwards.end());
        EXPECT_EQ(forwards, backwards);
    }
}

TEST(PickingPoint, PointsOfOneKeyAreDistinctAndKeysDiffer) {
    for (unsigned dimension = 1; dimension <= 3; ++dimension) {
        std::vector<Vec3> all;
        for (std::uint64_t key = 0; key < 4; ++key)
            for (unsigned k = 1; k < kPoints; ++k) all.push_back(picking_point(dimension, key, k));
        std::sort(all.begin(), all.end(), lexicographically_less);
        EXPECT_EQ(std::adjacent_find(all.begin(), all.end()), all.end());
    }
}

TEST(PickingPoint, FillsTheBallEvenly) {
    // Shells of equal volume and half-spaces hold equal shares.
    for (unsigned dimension = 1; dimension <= 3; ++dimension) {
        constexpr unsigned kMany = 1000;
        unsigned inner = 0;
        std::array<unsigned, 3> positive{};
        for (unsigned k = 1; k <= kMany; ++k) {
            const Vec3 p = picking_point(dimension, 7, k);
            inner += std::pow(norm(p), dimension) < 0.5;
            positive[0] += p.x > 0;
            positive[1] += p.y > 0;
            positive[2] += p.z > 0;
        }
        EXPECT_NEAR(inner, kMany / 2, kMany / 20) << dimension;
        for (unsigned axis = 0; axis < dimension; ++axis) EXPECT_NEAR(positive[axis], kMany / 2, kMany / 20) << dimension;
    }
}

}  // namespace
}  // namespace wellmesh::testing
