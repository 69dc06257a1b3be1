// SPDX-License-Identifier: Apache-2.0
#include "core/ids.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <type_traits>
#include <unordered_set>

namespace wellmesh {
namespace {

static_assert(!std::is_convertible_v<TetId, VertexId> && !std::is_constructible_v<TetId, VertexId>);
static_assert(!std::is_convertible_v<std::uint32_t, VertexId>);
static_assert(sizeof(VertexId) == 4 && std::is_trivially_copyable_v<VertexId>);

TEST(Ids, DefaultIsInvalid) {
    EXPECT_FALSE(VertexId().valid());
    EXPECT_TRUE(VertexId(0).valid());
    EXPECT_EQ(VertexId(std::size_t{7}).value(), 7U);
    EXPECT_EQ(VertexId(std::uint32_t{7}).index(), 7U);
}

TEST(Ids, CompareAndHashByValue) {
    EXPECT_LT(TetId(1), TetId(2));
    EXPECT_LT(TetId(1), TetId());  // invalid sorts last
    const std::unordered_set<TetId> set{TetId(1), TetId(2), TetId(1)};
    EXPECT_EQ(set.size(), 2U);
    EXPECT_TRUE(set.contains(TetId(2)));
}

}  // namespace
}  // namespace wellmesh
