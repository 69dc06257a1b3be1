// SPDX-License-Identifier: Apache-2.0
#include "quality/shape_statistics.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

namespace wellmesh {
namespace {

TEST(ShapeAccumulator, KeepsExtremesAndCounts) {
    ShapeAccumulator a;
    EXPECT_EQ(a.result().tets, 0U);
    EXPECT_EQ(a.result().min_dihedral_angle_deg, 0);
    TetShape s;
    s.radius_edge = 1, s.aspect = 4, s.sigma = 0.1, s.volume = 2, s.min_dihedral_deg = 12, s.max_dihedral_deg = 100;
    a.add(s);
    s.radius_edge = 2, s.aspect = 3, s.sigma = 0.2, s.volume = 1, s.min_dihedral_deg = 70, s.max_dihedral_deg = 71;
    a.add(s);
    s.min_dihedral_deg = 5;  // a bin's lower end belongs to it
    a.add(s);
    s.min_dihedral_deg = std::numeric_limits<double>::quiet_NaN();
    a.add(s);
    const ShapeStatistics r = a.result();
    EXPECT_EQ(r.tets, 4U);
    EXPECT_EQ(r.max_radius_edge_ratio, 2);
    EXPECT_EQ(r.max_aspect_ratio, 4);
    EXPECT_EQ(r.min_sigma, 0.1);
    EXPECT_EQ(r.min_volume, 1);
    EXPECT_EQ(r.max_volume, 2);
    EXPECT_EQ(r.min_dihedral_angle_deg, 5);
    EXPECT_EQ(r.max_dihedral_angle_deg, 100);
    EXPECT_EQ(r.min_dihedral_histogram[0], 1U);
    EXPECT_EQ(r.min_dihedral_histogram[1], 1U);
    EXPECT_EQ(r.min_dihedral_histogram[2], 1U);
    EXPECT_EQ(r.min_dihedral_histogram[14], 1U);
    EXPECT_EQ(std::accumulate(r.min_dihedral_histogram.begin(), r.min_dihedral_histogram.end(), std::uint64_t{0}), 4U);
}

}  // namespace
}  // namespace wellmesh
