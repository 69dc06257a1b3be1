// SPDX-License-Identifier: Apache-2.0
// Against copies of the array.
#include "core/undo_log.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/rng.hpp"

namespace wellmesh::testing {
namespace {

TEST(UndoLog, PutsAnArrayBackThroughAnyNestingOfSavepoints) {
    std::vector<std::uint64_t> array(50);
    UndoLog<std::uint64_t> log;
    std::vector<std::vector<std::uint64_t>> copies;
    std::uint64_t draws = 0;
    const auto below = [&](std::size_t n) { return static_cast<std::size_t>(mix64(7, ++draws) % n); };
    std::size_t rolled_back = 0, closed = 0, deepest = 0;
    for (std::size_t step = 0; step < 20'000; ++step) {
        const std::size_t what = below(100);
        if (what < 4 && copies.size() < 6) {
            log.open(array.size());
            copies.push_back(array);
        } else if (what < 8 && !copies.empty()) {
            array.resize(copies.back().size());
            log.roll_back([&](std::size_t i, std::uint64_t was) { array[i] = was; });
            ASSERT_EQ(array, copies.back());
            ++rolled_back;
        } else if (what < 11 && !copies.empty()) {
            log.close();
            copies.pop_back();
            ++closed;
        } else if (what < 20) {
            array.push_back(step);
        } else {
            const std::size_t i = below(array.size());
            if (log.wants(i)) log.keep(i, array[i]);
            array[i] = step;
        }
        ASSERT_EQ(log.is_open(), !copies.empty());
        // Once an element and savepoint, at most.
        ASSERT_LE(log.kept(), copies.size() * array.size());
        deepest = std::max(deepest, copies.size());
    }
    EXPECT_EQ(deepest, 6U);
    EXPECT_GT(rolled_back, 200U);
    EXPECT_GT(closed, 200U);
}

TEST(UndoLog, KeepsAnElementOnceForTwoSavepointsThatAreOneAgain) {
    std::vector<int> array{1, 2, 3};
    UndoLog<int> log;
    const auto set = [&](std::size_t i, int value) {
        if (log.wants(i)) log.keep(i, array[i]);
        array[i] = value;
    };
    log.open(array.size());
    set(0, 10);
    for (int turn = 0; turn < 5; ++turn) {
        log.open(array.size());
        set(0, 20 + turn);
        set(1, 30 + turn);
        log.close();
    }
    EXPECT_EQ(log.kept(), 2U);
    log.roll_back([&](std::size_t i, int was) { array[i] = was; });
    EXPECT_EQ(array, (std::vector{1, 2, 3}));
    EXPECT_EQ(log.kept(), 0U);
}

TEST(UndoLog, ViewsKeepForTheWhole) {
    SharedArray<int> array;
    array.assign(100, 1);
    UndoLog<int> log;
    log.open(array.size());
    std::vector<UndoLog<int>> views;
    for (std::size_t z = 0; z < 4; ++z) views.push_back(log.view());
    for (std::size_t i = 0; i < array.size(); ++i) {
        UndoLog<int>& mine = views[i % 4];
        ASSERT_TRUE(mine.wants(i));
        mine.keep(i, array[i]);
        ASSERT_FALSE(mine.wants(i));
        array[i] = 2;
    }
    for (UndoLog<int>& v : views) log.join(v);
    EXPECT_FALSE(log.wants(3));
    log.roll_back([&](std::size_t i, int was) { array[i] = was; });
    EXPECT_TRUE(std::all_of(array.begin(), array.end(), [](int x) { return x == 1; }));
    EXPECT_TRUE(log.wants(3));
}

}  // namespace
}  // namespace wellmesh::testing
