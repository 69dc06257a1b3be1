// SPDX-License-Identifier: Apache-2.0
#include "core/workers.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

namespace wellmesh {
namespace {

TEST(Workers, EveryPieceOnceForAnyNumberOfThreads) {
    for (const unsigned threads : {1U, 2U, 3U, 8U}) {
        Workers workers(threads);
        EXPECT_EQ(workers.threads(), threads);
        for (int round = 0; round < 200; ++round) {
            std::vector<int> done(97, 0);
            workers.for_each(done.size(), [&](std::size_t i) { ++done[i]; });
            for (const int d : done) EXPECT_EQ(d, 1);
        }
    }
}

TEST(Workers, NoPiecesNoCalls) {
    Workers workers(3);
    workers.for_each(0, [](std::size_t) { FAIL(); });
    workers.for_ranges(0, 10, [](std::size_t, std::size_t, std::size_t) { FAIL(); });
}

TEST(Workers, RangesCoverAndDependOnTheGrainOnly) {
    std::vector<std::vector<std::size_t>> limits;
    for (const unsigned threads : {1U, 4U}) {
        Workers workers(threads);
        std::vector<std::size_t> ends(4);
        workers.for_ranges(31, 10, [&](std::size_t begin, std::size_t end, std::size_t piece) {
            EXPECT_EQ(begin, piece * 10);
            ends[piece] = end;
        });
        limits.push_back(ends);
    }
    EXPECT_EQ(limits[0], (std::vector<std::size_t>{10, 20, 30, 31}));
    EXPECT_EQ(limits[0], limits[1]);
}

TEST(Workers, TheFailureOfTheLowestPieceArrivesAndTheTeamLivesOn) {
    for (const unsigned threads : {1U, 2U, 8U}) {
        Workers workers(threads);
        for (int round = 0; round < 100; ++round) {
            std::string caught;
            try {
                workers.for_each(50, [](std::size_t i) {
                    if (i == 7 || i == 8 || i == 20) throw std::runtime_error(std::to_string(i));
                });
            } catch (const std::runtime_error& e) {
                caught = e.what();
            }
            EXPECT_EQ(caught, "7");
            std::atomic<int> done{0};
            workers.for_each(20, [&](std::size_t) { ++done; });
            EXPECT_EQ(done, 20);
        }
    }
}

TEST(Workers, WorkWithinWorkRunsWhereItIs) {
    Workers workers(2);
    std::vector<int> sums(8, 0);
    workers.for_each(sums.size(), [&](std::size_t i) { workers.for_each(5, [&](std::size_t k) { sums[i] += static_cast<int>(k); }); });
    EXPECT_EQ(std::accumulate(sums.begin(), sums.end(), 0), 80);
}

TEST(Workers, ZeroIsTheMachinesCores) { EXPECT_GE(Workers(0).threads(), 1U); }

}  // namespace
}  // namespace wellmesh
