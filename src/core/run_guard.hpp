// SPDX-License-Identifier: Apache-2.0
// One place where a run learns that it must end: cancelled, out of time, of vertices or of memory; and where progress is told.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>

#include "wellmesh/error.hpp"
#include "wellmesh/options.hpp"
#include "wellmesh/run_control.hpp"

namespace wellmesh {

/// Called between pieces of work that nothing could end otherwise; throws to end them. Empty: they never end early.
using Checkpoint = std::function<void()>;
inline void pass(const Checkpoint& checkpoint) {
    if (checkpoint) checkpoint();
}

class RunGuard {
public:
    enum class Verdict { go_on, cancelled, out_of_time, out_of_vertices, out_of_memory };

    /// Starts the clock. `control` must outlive this.
    RunGuard(const Limits& limits, const RunControl& control);

    /// Cheap enough for every insertion: clock and memory are looked at about once a millisecond. Once the user's limit is spent it stays so.
    [[nodiscard]] Verdict poll(std::uint64_t vertices, std::uint64_t tets, std::uint64_t unmet) {
        if (spent_ != Verdict::go_on) return spent_;
        if (control_->stop.stop_requested()) return Verdict::cancelled;
        if (limits_.max_vertices && vertices >= *limits_.max_vertices) return spent_ = Verdict::out_of_vertices;
        if (ceiling_ && vertices >= *ceiling_) return Verdict::out_of_vertices;
        if (++polls_ < stride_) return Verdict::go_on;
        polls_ = 0;
        return look(vertices, tets, unmet);
    }
    /// The same for work that the mesh can't do without, with the clock looked at each time.
    /// @param where  what is being worked on, if that is known.
    /// @throws MeshError{cancelled | budget_exhausted} naming the stage.
    void require(std::uint64_t vertices, std::uint64_t tets, std::uint64_t unmet, const std::optional<ElementRef>& where = {});
    /// Before there is a mesh: require() as a checkpoint.
    [[nodiscard]] Checkpoint checkpoint();

    void enter(Stage stage) { stage_ = stage; }
    [[nodiscard]] Stage stage() const { return stage_; }
    /// A bound of the algorithm's own, beside the user's.
    void set_ceiling(std::optional<std::uint64_t> vertices) { ceiling_ = vertices; }
    /// Whether a limit that the user set, not the algorithm's own bound, has ended the run.
    [[nodiscard]] bool user_limit_spent() const { return spent_ != Verdict::go_on; }
    /// Whether so many bytes more would go beyond the limit. What is only nice to have is then left out.
    [[nodiscard]] bool can_afford(std::uint64_t bytes) const;

private:
    using Clock = std::chrono::steady_clock;
    Verdict look(std::uint64_t vertices, std::uint64_t tets, std::uint64_t unmet);
    [[nodiscard]] Clock::time_point now() const { return control_->clock ? control_->clock() : Clock::now(); }
    [[nodiscard]] std::uint64_t memory() const;

    Limits limits_;
    const RunControl* control_;
    Clock::time_point start_, last_progress_{}, last_look_;
    unsigned polls_ = 0, stride_ = 1;  // look at the clock every so many polls
    std::optional<std::uint64_t> ceiling_{};
    Verdict spent_ = Verdict::go_on;  // of the user's limits
    Stage stage_ = Stage::read;
};

}  // namespace wellmesh
