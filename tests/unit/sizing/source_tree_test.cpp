// SPDX-License-Identifier: Apache-2.0
#include "sizing/source_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/vec3_math.hpp"
#include "random_points.hpp"
#include "validation/local_feature_size.hpp"

namespace wellmesh::testing {
namespace {

TEST(SourceTree, IsTheLeastOverAllSources) {
    RandomPoints random(5);
    for (const std::size_t n : {1U, 3U, 5U, 60U, 700U}) {
        std::vector<SizeSource> sources;
        for (std::size_t i = 0; i < n; ++i) {
            SizeSource s{{random.point(), random.point(), random.point()}, static_cast<unsigned>(1 + i % 3), 0.01 + random.number()};
            for (unsigned k = 1; k < 3; ++k) s.corners[k] = s.corners[0] + 0.1 * (s.corners[k] - s.corners[0]);
            sources.push_back(s);
        }
        for (const double growth : {0.0, 0.3, 1.0}) {
            const SourceTree tree(sources, growth);
            ASSERT_EQ(tree.size(), n);
            for (int i = 0; i < 200; ++i) {
                const Vec3 p = 2.0 * random.point() - Vec3{0.5, 0.5, 0.5};
                double least = std::numeric_limits<double>::infinity();
                for (const SizeSource& s : sources) {
                    const double d = s.size == 1   ? distance(p, s.corners[0])
                                     : s.size == 2 ? distance_to_segment(p, s.corners[0], s.corners[1])
                                                   : distance_to_triangle(p, s.corners[0], s.corners[1], s.corners[2]);
                    least = std::min(least, s.edge_length + growth * d);
                }
                ASSERT_EQ(tree(p), least);
                ASSERT_EQ(tree(p, 0.5 * least), 0.5 * least);
            }
        }
    }
}

TEST(SourceTree, WithoutSourcesNothingIsAsked) {
    const SourceTree tree({}, 0.3);
    EXPECT_TRUE(tree.empty());
    EXPECT_TRUE(std::isinf(tree({1, 2, 3})));
    EXPECT_EQ(tree({1, 2, 3}, 7), 7);
}

}  // namespace
}  // namespace wellmesh::testing
