// SPDX-License-Identifier: Apache-2.0
#include "adoption/given_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace wellmesh::testing {
namespace {

/// Two tetrahedra of volume 1/6 on either side of one face; the second has its own copy of vertex 1, is listed the other way around, and vertex 6 is of none.
TetMesh two_tets() {
    TetMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}, {1, -0.0, 0}, {7, 7, 7}};
    mesh.tets = {{0, 1, 2, 3}, {0, 5, 2, 4}};
    mesh.tet_regions = {0, 0};
    return mesh;
}

TEST(GivenMesh, VerticesAtOnePlaceAreOne) {
    const GivenMesh given = inspect_given_mesh(two_tets());
    EXPECT_EQ(given.first_at_place, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 1, 6}));
    EXPECT_EQ(given.used, (std::vector<char>{1, 1, 1, 1, 1, 0, 0}));
    EXPECT_EQ(given.hull.size(), 6U);  // the face between them is inside
    EXPECT_EQ(std::count(given.on_hull.begin(), given.on_hull.end(), 1), 5);
}

TEST(GivenMesh, VolumesWithAndWithoutSign) {
    const GivenMesh given = inspect_given_mesh(two_tets());
    EXPECT_DOUBLE_EQ(given.volume, 2.0 / 6);
    EXPECT_DOUBLE_EQ(given.signed_volume, 0);
}

TEST(GivenMesh, ReferencesCountWhereAllAgree) {
    TetMesh mesh = two_tets();
    mesh.subfaces = {{0, 1, 3}, {0, 5, 4}, {0, 2, 3}};
    mesh.subface_facets = {4, 4, 9};
    mesh.subsegments = {{3, 0}};
    mesh.subsegment_segments = {2};
    const GivenMesh given = inspect_given_mesh(mesh);
    EXPECT_EQ(given.facet_reference, (std::vector<std::int32_t>{0, 4, 9, 0, 4, 0, 0}));
    EXPECT_EQ(given.segment_reference, (std::vector<std::int32_t>{2, 0, 0, 2, 0, 0, 0}));
}

}  // namespace
}  // namespace wellmesh::testing
