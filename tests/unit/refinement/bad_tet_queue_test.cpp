// SPDX-License-Identifier: Apache-2.0
#include "refinement/bad_tet_queue.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <vector>

namespace wellmesh::testing {
namespace {

TetStore::Corners corners(std::uint32_t n) { return {VertexId{n}, VertexId{n + 1}, VertexId{n + 2}, VertexId{n + 3}}; }

TEST(BadTetQueue, PopsWorstPowersOfTwoFirstAndTheLastPushedAmongEquals) {
    BadTetQueue queue;
    struct Pushed {
        int level;
        std::uint32_t order;
    };
    std::map<TetId, Pushed> pushed;
    for (std::uint32_t i = 0; i < 2000; ++i) {
        const double badness = std::exp2(60 * unit_double(mix64(1, i)) - 20);
        queue.push(TetId{i}, corners(i), badness);
        pushed[TetId{i}] = {std::ilogb(badness), i};
    }
    ASSERT_EQ(queue.size(), 2000U);
    Pushed last{1000, 0};
    while (!queue.empty()) {
        const auto entry = queue.pop();
        const Pushed now = pushed.at(entry.tet);
        EXPECT_EQ(entry.fingerprint, BadTetQueue::fingerprint(corners(entry.tet.value())));
        EXPECT_LE(now.level, last.level);
        if (now.level == last.level) { EXPECT_LT(now.order, last.order); }
        last = now;
        pushed.erase(entry.tet);
    }
    EXPECT_TRUE(pushed.empty());
    EXPECT_EQ(queue.size(), 0U);
}

TEST(BadTetQueue, PushesBetweenPopsKeepTheOrder) {
    BadTetQueue queue;
    queue.push(TetId{1}, corners(1), 4);
    queue.push(TetId{2}, corners(2), 64);
    EXPECT_EQ(queue.pop().tet, TetId{2});
    queue.push(TetId{3}, corners(3), 1024);
    queue.push(TetId{4}, corners(4), 1);
    EXPECT_EQ(queue.pop().tet, TetId{3});
    EXPECT_EQ(queue.pop().tet, TetId{1});
    EXPECT_EQ(queue.pop().tet, TetId{4});
    EXPECT_TRUE(queue.empty());
}

TEST(BadTetQueue, TakesEveryBadness) {
    BadTetQueue queue;
    const double infinity = std::numeric_limits<double>::infinity();
    const std::vector<double> from_best{0.0, 1e-300, 1.0, 1e300, infinity};
    for (std::uint32_t i = 0; i < 5; ++i) queue.push(TetId{i}, corners(i), from_best[i]);
    EXPECT_TRUE(queue.pop().tet == TetId{4});
    for (int i = 0; i < 4; ++i) queue.pop();
    EXPECT_TRUE(queue.empty());
    queue.push(TetId{9}, corners(9), std::numeric_limits<double>::quiet_NaN());  // a flat tetrahedron's radius: worst of all
    queue.push(TetId{8}, corners(8), 1e20);
    EXPECT_EQ(queue.pop().tet, TetId{9});
    queue.clear();
    EXPECT_TRUE(queue.empty());
    queue.push(TetId{7}, corners(7), 2);
    EXPECT_EQ(queue.pop().tet, TetId{7});
}

TEST(BadTetQueue, FingerprintsTellReusedIdsApart) {
    EXPECT_NE(BadTetQueue::fingerprint(corners(5)), BadTetQueue::fingerprint(corners(6)));
    EXPECT_NE(BadTetQueue::fingerprint({VertexId{1}, VertexId{2}, VertexId{3}, VertexId{4}}), BadTetQueue::fingerprint({VertexId{1}, VertexId{2}, VertexId{4}, VertexId{3}}));
}

}  // namespace
}  // namespace wellmesh::testing
