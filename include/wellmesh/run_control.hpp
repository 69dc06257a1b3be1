// SPDX-License-Identifier: Apache-2.0
// Progress and cancellation.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <stop_token>

#include "wellmesh/error.hpp"

namespace wellmesh {

struct Progress {
    Stage stage = Stage::read;
    std::uint64_t vertices = 0, tets = 0;
    std::uint64_t unmet_goals = 0;  ///< elements still waiting: encroached or bad
};

struct RunControl {
    /// Called on the caller's thread, at most about ten times a second. An exception thrown from it ends the run and propagates.
    std::function<void(const Progress&)> on_progress{};
    /// Polled at least once per vertex insertion.
    std::stop_token stop{};
    /// By which Limits::time is measured; empty: the steady clock. Another one makes a run with a time limit repeatable.
    std::function<std::chrono::steady_clock::time_point()> clock{};
    /// What Limits::memory_bytes is compared with; empty: the physical memory that the process holds.
    std::function<std::uint64_t()> resident_bytes{};
};

}  // namespace wellmesh
