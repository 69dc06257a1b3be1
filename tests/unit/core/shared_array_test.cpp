// SPDX-License-Identifier: Apache-2.0
#include "core/shared_array.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <string>
#include <utility>

namespace wellmesh::testing {
namespace {

struct alignas(32) Item {
    std::uint64_t a = 0, b = 0, c = 0, d = 0;
};

TEST(SharedArray, KeepsWhatItHoldsThroughEverySize) {
    SharedArray<Item> array;
    std::size_t moves = 0;
    const Item* at = nullptr;
    // From the allocator's memory to pages, small ones and huge ones.
    for (std::uint64_t i = 0; i < 1'500'000; ++i) {
        array.push_back({i, ~i, 0, 0});
        moves += std::exchange(at, array.data()) != array.data();
    }
    EXPECT_GT(moves, 10U);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(array.data()) % 64, 0U);
    for (std::uint64_t i = 0; i < array.size(); ++i) ASSERT_TRUE(array[i].a == i && array[i].b == ~i) << i;
    SharedArray<Item> copy = array, view = copy.view();
    view[7].a = 1;
    EXPECT_EQ(copy[7].a, 1U);
    EXPECT_EQ(array[7].a, 7U);
    const SharedArray<Item> owned = view;
    copy.release();
    EXPECT_EQ(copy.capacity(), 0U);
    EXPECT_EQ(owned[7].a, 1U);
    EXPECT_EQ(owned.size(), array.size());
}

TEST(SharedArray, TouchingAShareLeavesTheOtherSharesAlone) {
    SharedArray<Item> array;
    array.resize(1000, {1, 2, 3, 4});
    constexpr std::size_t kShare = 333'333;  // ends in the midst of a page
    for (std::uint64_t share = 0; share < 6; ++share) {
        const std::size_t first = array.size();
        array.resize_as_is(first + 2 * kShare);
        // The second half before the first: what lies on both sides of a share is in use.
        for (const std::size_t begin : {first + kShare, first}) {
            array.touch(begin, kShare);
            for (std::size_t i = begin; i < begin + kShare; ++i) array[i] = {i, ~i, share, begin};
        }
    }
    for (std::size_t i = 0; i < 1000; ++i) ASSERT_EQ(array[i].b, 2U) << i;
    for (std::uint64_t i = 1000; i < array.size(); ++i) {
        const std::uint64_t half = (i - 1000) / kShare;
        ASSERT_TRUE(array[i].a == i && array[i].b == ~i && array[i].c == half / 2 && array[i].d == 1000 + half * kShare) << i;
    }
}

TEST(SharedArray, ShrinksAndGrowsWithinWhatIsReserved) {
    SharedArray<Item> array;
    array.reserve(8'000'000);
    for (std::uint64_t i = 0; i < 2'000'000; ++i) array.push_back({i, ~i, 0, 0});
    array.resize(2'500'000, {7, 7, 7, 7});
    array.resize_as_is(100);
    array.resize(3'000'000, {8, 8, 8, 8});
    EXPECT_EQ(array.capacity(), 8'000'000U);
    for (std::uint64_t i = 0; i < 100; ++i) ASSERT_TRUE(array[i].a == i && array[i].b == ~i) << i;
    for (std::uint64_t i = 100; i < array.size(); ++i) ASSERT_EQ(array[i].d, 8U) << i;
}

/// Small and huge pages in turns: arrays grow, move and keep what they hold all the same.
TEST(SharedArray, DoesNotMindSlowPages) {
    SharedArray<Item> grows, is_reserved;
    constexpr std::int64_t kAllAreSlow = -1, kNoneIs = 1'000'000'000'000;
    unsigned fills = 0;
    const auto fill = [&](SharedArray<Item>& array, std::size_t more) {
        const std::size_t first = array.size();
        set_slow_page(++fills % 5 == 0 ? kAllAreSlow : kNoneIs);
        array.resize_as_is(first + more);
        set_slow_page(fills % 7 == 0 ? kAllAreSlow : kNoneIs);  // those of a share are, where the first ones were not
        array.touch(first, more);
        for (std::uint64_t i = first; i < first + more; ++i) array[i] = {i, ~i, 0, 0};
    };
    is_reserved.reserve(3'000'000);
    for (unsigned round = 0; round < 48; ++round) {
        fill(grows, 150'001);
        fill(is_reserved, 60'001);
        if (round % 16 == 5) grows.reserve(grows.size() + 700'000);
    }
    set_slow_page(kSlowPage);
    for (const SharedArray<Item>* array : {&grows, &is_reserved})
        for (std::uint64_t i = 0; i < array->size(); ++i) ASSERT_TRUE((*array)[i].a == i && (*array)[i].b == ~i) << i;
}

#ifdef __linux__

/// Since the last call the process has held at most so many bytes; 0 if the system doesn't say.
std::uint64_t most_resident_bytes() {
    std::ifstream status("/proc/self/status");
    std::uint64_t kilobytes = 0;
    for (std::string line; std::getline(status, line);)
        if (line.starts_with("VmHWM:")) kilobytes = std::stoull(line.substr(6));
    std::ofstream("/proc/self/clear_refs") << "5";
    return kilobytes * 1024;
}

TEST(SharedArray, IsNotThereTwiceWhileItGrows) {
    if (!kPagesMove) GTEST_SKIP() << "the allocator's memory is copied";
    constexpr std::uint64_t kMiB = std::uint64_t{1} << 20;
    SharedArray<std::uint8_t> array;
    array.assign(64 * kMiB, 1);
    (void)most_resident_bytes();
    const std::uint64_t before = most_resident_bytes();
    if (before == 0 || before > 1000 * kMiB) GTEST_SKIP() << "the system does not say what is resident";
    array.reserve(512 * kMiB);
    array.push_back(2);
    EXPECT_LT(most_resident_bytes(), before + 16 * kMiB);
    EXPECT_EQ(array[64 * kMiB - 1], 1);
    EXPECT_EQ(array.back(), 2);
}

#endif

}  // namespace
}  // namespace wellmesh::testing
