// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

#include "conforming/place_point.hpp"
#include "core/rng.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"

namespace wellmesh::testing {
namespace {

constexpr double kUlp = std::numeric_limits<double>::epsilon();

Vec3 random_point(std::uint64_t key, const Vec3& centre, double reach) {
    return centre + reach * Vec3{unit_double(mix64(key, 1)) - 0.5, unit_double(mix64(key, 2)) - 0.5, unit_double(mix64(key, 3)) - 0.5};
}

TEST(PlacePoint, ProjectionsMissTheirCarrierByAFewUlpAndMoveAtRightAngles) {
    for (const double shift : {0.0, 1e3, 1e6}) {
        const StagedMesh staged(transformed(stepped_shaft(), 3, shift, 1));
        const ValidPlc& plc = staged.plc;
        const double ulp = kUlp * staged.largest_coordinate();
        for (std::size_t f = 0; f < plc.facets.size(); ++f)
            for (std::uint64_t k = 0; k < 50; ++k) {
                const ValidFacet& facet = plc.facets[f];
                const Vec3 p = random_point(mix64(f, k), facet.origin, 3), q = project_to_facet(facet, p);
                EXPECT_LE(std::abs(dot(q - facet.origin, facet.normal)), 4 * ulp);
                EXPECT_LE(norm(cross(q - p, facet.normal)), 16 * ulp);
                EXPECT_LE(distance(project_to_facet(facet, q), q), 8 * ulp);
            }
        for (std::size_t s = 0; s < plc.segments.size(); ++s)
            for (std::uint64_t k = 0; k < 50; ++k) {
                const Vec3 &a = plc.vertices[plc.segments[s].ends[0].index()], &b = plc.vertices[plc.segments[s].ends[1].index()];
                const Vec3 d = (1 / distance(a, b)) * (b - a);
                const Vec3 p = random_point(mix64(s, k), 0.5 * (a + b), 2), q = project_to_segment(plc, SegmentId{s}, p);
                EXPECT_LE(norm(cross(q - a, d)), 4 * ulp);
                EXPECT_LE(std::abs(dot(q - p, d)), 16 * ulp);
            }
    }
}

TEST(PlacePoint, EndsOfASegmentProjectToThemselves) {
    const StagedMesh staged(transformed(l_block(), 5, 1e6, 1e-6));
    for (std::size_t s = 0; s < staged.plc.segments.size(); ++s)
        for (const VertexId v : staged.plc.segments[s].ends) {
            const Vec3& p = staged.plc.vertices[v.index()];
            EXPECT_EQ(project_to_segment(staged.plc, SegmentId{s}, p), p);
        }
}

TEST(PlacePoint, CircumcentresAreEquidistant) {
    for (std::uint64_t k = 0; k < 500; ++k) {
        std::array<Vec3, 4> c;
        for (std::size_t i = 0; i < 4; ++i) c[i] = random_point(mix64(k, i), {10, -20, 30}, 1);
        double radius = 0;
        const Vec3 disk = circumcentre(c[0], c[1], c[2], &radius);
        for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(distance(disk, c[i]), radius, 1e-9 * radius * (1 + radius));
        const Vec3 n = cross(c[1] - c[0], c[2] - c[0]);
        EXPECT_NEAR(dot(disk - c[0], n), 0, 1e-12 * norm(n) * (1 + radius * radius));
        const Vec3 ball = circumcentre(c[0], c[1], c[2], c[3], &radius);
        for (const Vec3& p : c) EXPECT_NEAR(distance(ball, p), radius, 1e-9 * radius * (1 + radius));
    }
}

}  // namespace
}  // namespace wellmesh::testing
