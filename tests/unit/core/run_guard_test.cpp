// SPDX-License-Identifier: Apache-2.0
#include "core/run_guard.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/resident_memory.hpp"

namespace wellmesh {
namespace {

using Verdict = RunGuard::Verdict;
using std::chrono::milliseconds;

/// A clock that goes on by `step` whenever it is looked at.
struct Ticking {
    std::chrono::steady_clock::time_point time{};
    std::chrono::microseconds step{};
    std::uint64_t looks = 0;
    RunControl control() {
        RunControl c;
        c.clock = [this] {
            ++looks;
            return time += step;
        };
        return c;
    }
};

ElementRef somewhere() { return {EntityKind::facet, 7, Vec3{1, 2, 3}}; }

TEST(RunGuard, WithoutLimitsGoesOn) {
    const RunControl control;
    RunGuard guard({}, control);
    for (std::uint64_t v = 0; v < 1000; ++v) ASSERT_EQ(guard.poll(v, v, v), Verdict::go_on);
    EXPECT_FALSE(guard.user_limit_spent());
    EXPECT_TRUE(guard.can_double());
}

TEST(RunGuard, ATimeLimitIsNoticedAndStaysSpent) {
    Ticking clock{.step = milliseconds(3)};
    const RunControl control = clock.control();
    RunGuard guard({.time = milliseconds(100)}, control);
    unsigned polls = 0;
    while (guard.poll(1, 1, 1) == Verdict::go_on) ASSERT_LT(++polls, 100U);
    EXPECT_GE(polls, 30U);  // looks are 3 ms apart: each poll must look
    clock.time = {};
    EXPECT_EQ(guard.poll(1, 1, 1), Verdict::out_of_time);
    EXPECT_TRUE(guard.user_limit_spent());
}

TEST(RunGuard, FastPollsLookAtTheClockRarely) {
    Ticking clock{.step = std::chrono::microseconds(1)};
    const RunControl control = clock.control();
    RunGuard guard({.time = milliseconds(100)}, control);
    for (unsigned i = 0; i < 64'000; ++i) ASSERT_EQ(guard.poll(1, 1, 1), Verdict::go_on);
    EXPECT_LT(clock.looks, 1100U);
    EXPECT_GT(clock.looks, 900U);
}

TEST(RunGuard, AMemoryLimitLeavesRoomForTheCertificate) {
    std::uint64_t held = 0;
    RunControl control;
    control.resident_bytes = [&] { return held; };
    constexpr std::uint64_t kLimit = 1'000'000'000;
    RunGuard guard({.memory_bytes = kLimit}, control);
    const auto poll_often = [&] {
        Verdict verdict = Verdict::go_on;
        for (unsigned i = 0; i < 64 && verdict == Verdict::go_on; ++i) verdict = guard.poll(1, 1, 1);
        return verdict;
    };
    held = static_cast<std::uint64_t>(0.99 * kLimit / kPeakOverRefinement);
    EXPECT_EQ(poll_often(), Verdict::go_on);
    held = static_cast<std::uint64_t>(1.01 * kLimit / kPeakOverRefinement);
    EXPECT_EQ(poll_often(), Verdict::out_of_memory);
    held = kLimit / 2 + 1;
    EXPECT_FALSE(guard.can_double());
}

TEST(RunGuard, BeforeConformityAnErrorNamesStageAndPlace) {
    Ticking clock{.step = milliseconds(2)};
    const RunControl control = clock.control();
    RunGuard guard({.time = milliseconds(10)}, control);
    guard.enter(Stage::conform);
    try {
        for (unsigned i = 0; i < 100; ++i) guard.require(10, 20, 30, somewhere);
        FAIL() << "no error";
    } catch (const MeshError& e) {
        EXPECT_EQ(e.code(), ErrorCode::budget_exhausted);
        EXPECT_EQ(e.stage(), Stage::conform);
        ASSERT_EQ(e.offenders().size(), 1U);
        EXPECT_EQ(e.offenders()[0].number, 7U);
        EXPECT_NE(std::string(e.what()).find("0.01 s"), std::string::npos) << e.what();
        EXPECT_NE(std::string(e.what()).find("conform"), std::string::npos) << e.what();
    }
}

TEST(RunGuard, OnceTheMeshConformsWhatIsBegunIsFinished) {
    const RunControl control;
    RunGuard guard({.max_vertices = 5}, control);
    guard.set_conforming();
    EXPECT_NO_THROW(guard.require(6, 1, 1, somewhere));
    EXPECT_EQ(guard.poll(6, 1, 1), Verdict::out_of_vertices);
    EXPECT_TRUE(guard.has_too_many(6));
    EXPECT_FALSE(guard.has_too_many(5));
    guard.set_ceiling(8);
    EXPECT_THROW(guard.require(8, 1, 1, somewhere), MeshError);
}

TEST(RunGuard, ACheckpointLooksEachTime) {
    Ticking clock{.step = milliseconds(60)};
    const RunControl control = clock.control();
    RunGuard guard({.time = milliseconds(100)}, control);
    const Checkpoint checkpoint = guard.checkpoint();
    EXPECT_NO_THROW(pass(checkpoint));
    EXPECT_THROW(pass(checkpoint), MeshError);
    EXPECT_NO_THROW(pass({}));
}

TEST(RunGuard, AStopIsToldAsCancelled) {
    std::stop_source source;
    RunControl control;
    control.stop = source.get_token();
    RunGuard guard({}, control);
    source.request_stop();
    EXPECT_EQ(guard.poll(1, 1, 1), Verdict::cancelled);
    EXPECT_FALSE(guard.user_limit_spent());
    try {
        pass(guard.checkpoint());
        FAIL() << "no error";
    } catch (const MeshError& e) {
        EXPECT_EQ(e.code(), ErrorCode::cancelled);
    }
}

TEST(ResidentMemory, FollowsWhatTheProcessTouches) {
    const std::uint64_t before = resident_bytes();
    if (before == 0) GTEST_SKIP() << "unknown on this system";
    constexpr std::size_t kBytes = std::size_t{64} << 20;
    const std::vector<char> touched(kBytes, 1);
    EXPECT_GE(resident_bytes() + (kBytes >> 3), before + kBytes) << touched[kBytes / 2];
}

}  // namespace
}  // namespace wellmesh
