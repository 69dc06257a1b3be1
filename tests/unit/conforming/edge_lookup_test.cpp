// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "conforming/edge_lookup.hpp"
#include "core/rng.hpp"

namespace wellmesh {
namespace {

struct Edge {
    VertexId a{}, b{};
};

/// Few vertices, so that many edges come twice, in both directions.
std::vector<Edge> random_edges(std::size_t number, std::uint64_t seed) {
    std::vector<Edge> out;
    for (std::uint64_t i = 0; out.size() < number; ++i) {
        const VertexId a{mix64(seed, 2 * i) % 12}, b{mix64(seed, 2 * i + 1) % 12};
        if (a != b) out.push_back({a, b});
    }
    return out;
}

/// Few are looked through, many are sorted: it must not be told.
TEST(EdgeLookup, FindsAllThatIsFiledUnderAnEdgeInOrder) {
    for (const std::size_t number : {0U, 1U, 31U, 32U, 33U, 200U}) {
        const std::vector<Edge> edges = random_edges(number, number);
        EdgeLookup lookup;
        for (std::size_t i = 0; i < edges.size(); ++i) lookup.add(edge_key(edges[i].a, edges[i].b), i);
        lookup.finish();
        for (std::size_t a = 0; a < 13; ++a)
            for (std::size_t b = 0; b < a; ++b) {
                std::vector<std::size_t> found, expected;
                lookup.for_each(edge_key(VertexId{a}, VertexId{b}), [&](std::size_t i) { found.push_back(i); });
                for (std::size_t i = 0; i < edges.size(); ++i)
                    if (std::set{edges[i].a.value(), edges[i].b.value()} == std::set{VertexId{a}.value(), VertexId{b}.value()}) expected.push_back(i);
                EXPECT_EQ(found, expected);
                EXPECT_EQ(lookup.contains(edge_key(VertexId{b}, VertexId{a})), !expected.empty());
            }
    }
}

TEST(DistinctEdges, AreThoseThatComeFirst) {
    for (const std::size_t number : {0U, 1U, 40U, 300U, 2000U}) {
        std::vector<Edge> listed, expected;
        DistinctEdges<Edge> distinct(listed);
        std::set<std::uint64_t> known;
        for (const Edge& e : random_edges(number, 7 + number)) {
            if (!distinct.is_listed(edge_key(e.a, e.b))) distinct.add(e);
            if (known.insert(edge_key(e.b, e.a)).second) expected.push_back(e);
        }
        distinct.finish();
        ASSERT_EQ(listed.size(), expected.size());
        for (std::size_t i = 0; i < listed.size(); ++i) EXPECT_TRUE(listed[i].a == expected[i].a && listed[i].b == expected[i].b);
    }
}

}  // namespace
}  // namespace wellmesh
