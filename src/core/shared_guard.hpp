// SPDX-License-Identifier: Apache-2.0
// A RunGuard that several workers ask at once. Clock, memory and progress are looked at by the caller's thread alone, whether the run was cancelled by all.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <thread>

#include "core/run_guard.hpp"

namespace wellmesh {

class SharedGuard {
public:
    /// For work that begins with so many and changes their number by little.
    SharedGuard(RunGuard& guard, std::uint64_t vertices, std::uint64_t tets) : guard_(guard), vertices_(vertices), tets_(tets) {}

    /// Once it has said no to one thread it says so to all.
    [[nodiscard]] bool may_go_on(std::size_t unmet) {
        if (stopped_.load(std::memory_order_relaxed)) return false;
        if (std::this_thread::get_id() == caller_) {
            verdict_ = guard_.poll(vertices_, tets_, unmet);
            if (verdict_ == RunGuard::Verdict::go_on) return true;
        } else if (!guard_.is_cancelled()) {
            return true;
        }
        stopped_.store(true, std::memory_order_relaxed);
        return false;
    }
    /// Does a piece of the work; if it throws, the others need not go on.
    template <class Work>
    void watch(const Work& work) {
        try {
            work();
        } catch (...) {
            stopped_.store(true, std::memory_order_relaxed);
            throw;
        }
    }
    /// When all is done: what the caller's own poll would have said.
    [[nodiscard]] RunGuard::Verdict verdict() const {
        return stopped_.load(std::memory_order_relaxed) && verdict_ == RunGuard::Verdict::go_on ? RunGuard::Verdict::cancelled : verdict_;
    }

private:
    RunGuard& guard_;
    std::uint64_t vertices_, tets_;
    std::thread::id caller_ = std::this_thread::get_id();
    RunGuard::Verdict verdict_ = RunGuard::Verdict::go_on;  // the caller's thread's
    std::atomic<bool> stopped_{false};
};

}  // namespace wellmesh
