// SPDX-License-Identifier: Apache-2.0
// One place where a run learns that it must end: cancelled, out of time or out of vertices; and where progress is told.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "wellmesh/options.hpp"
#include "wellmesh/run_control.hpp"

namespace wellmesh {

class RunGuard {
public:
    enum class Verdict { go_on, cancelled, out_of_time, out_of_vertices };

    RunGuard(const Limits& limits, const RunControl& control) : limits_(limits), control_(&control), start_(Clock::now()) {}

    /// Cheap enough for every insertion: the clock is read every 64th call.
    [[nodiscard]] Verdict poll(std::uint64_t vertices, std::uint64_t tets, std::uint64_t unmet) {
        if (control_->stop.stop_requested()) return Verdict::cancelled;
        if (limits_.max_vertices && vertices >= *limits_.max_vertices) return spent(Verdict::out_of_vertices);
        if (ceiling_ && vertices >= *ceiling_) return Verdict::out_of_vertices;
        if ((++polls_ & 63U) != 0) return Verdict::go_on;
        const Clock::time_point now = Clock::now();
        if (control_->on_progress && now - last_progress_ > std::chrono::milliseconds(100)) {
            last_progress_ = now;
            control_->on_progress({stage_, vertices, tets, unmet});
        }
        if (limits_.time && now - start_ > *limits_.time) return spent(Verdict::out_of_time);
        return Verdict::go_on;
    }
    void enter(Stage stage) { stage_ = stage; }
    [[nodiscard]] Stage stage() const { return stage_; }
    /// A bound of the algorithm's own, beside the user's.
    void set_ceiling(std::optional<std::uint64_t> vertices) { ceiling_ = vertices; }
    /// Whether a limit that the user set, not the algorithm's own bound, has ended the run.
    [[nodiscard]] bool user_limit_spent() const { return user_limit_spent_; }

private:
    using Clock = std::chrono::steady_clock;
    Verdict spent(Verdict verdict) {
        user_limit_spent_ = true;
        return verdict;
    }
    Limits limits_;
    const RunControl* control_;
    Clock::time_point start_, last_progress_{};
    std::uint64_t polls_ = 0;
    std::optional<std::uint64_t> ceiling_{};
    bool user_limit_spent_ = false;
    Stage stage_ = Stage::read;
};

}  // namespace wellmesh
