// SPDX-License-Identifier: Apache-2.0
// One place where a run learns that it must end: cancelled, out of time, of vertices or of memory; and where progress is told.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>

#include "core/checkpoint.hpp"
#include "wellmesh/error.hpp"
#include "wellmesh/options.hpp"
#include "wellmesh/run_control.hpp"

namespace wellmesh {

/// The most that a run holds, certificate included, over what refinement holds: 1.31 measured; arrays that grow are there twice for a moment (decision 20).
inline constexpr double kPeakOverRefinement = 1.5;

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
    /// From any thread.
    [[nodiscard]] bool is_cancelled() const { return control_->stop.stop_requested(); }
    /// The same for work without which there is no conforming mesh. Once there has been one (set_conforming), what is begun is finished: only the
    /// algorithm's own ceiling ends it then, and whoever polls next learns of the user's limits.
    /// @param where  () -> ElementRef, what is being worked on.
    /// @throws MeshError{cancelled | budget_exhausted} naming stage and place.
    template <class Where>
    void require(std::uint64_t vertices, std::uint64_t tets, std::uint64_t unmet, Where&& where) {
        const Verdict verdict = poll(vertices, tets, unmet);
        const bool endless = ceiling_ && vertices >= *ceiling_;
        if (verdict == Verdict::go_on || (conforming_ && !endless)) return;
        throw gave_up(endless && conforming_ ? Verdict::out_of_vertices : verdict, vertices, where());
    }
    /// For the stages before there is a triangulation: looks at the clock each time and throws as require() does.
    [[nodiscard]] Checkpoint checkpoint();

    void enter(Stage stage) { stage_ = stage; }
    /// The mesh conforms to its input: from now on a run ends with a mesh.
    void set_conforming() { conforming_ = true; }
    [[nodiscard]] Stage stage() const { return stage_; }
    /// A bound of the algorithm's own, beside the user's.
    void set_ceiling(std::optional<std::uint64_t> vertices) { ceiling_ = vertices; }
    /// Whether a limit that the user set, not the algorithm's own bound, has ended the run.
    [[nodiscard]] bool user_limit_spent() const { return spent_ != Verdict::go_on; }
    /// Has the user set a limit on vertices? Then who comes first matters.
    [[nodiscard]] bool limits_vertices() const { return limits_.max_vertices.has_value(); }
    /// More vertices than the user allows: what a cascade must finish may add some after the last of them.
    [[nodiscard]] bool has_too_many(std::uint64_t vertices) const { return limits_.max_vertices && vertices > *limits_.max_vertices; }
    /// How many more vertices the user allows; empty: no limit.
    [[nodiscard]] std::optional<std::uint64_t> vertices_left(std::uint64_t vertices) const {
        if (!limits_.max_vertices) return std::nullopt;
        return *limits_.max_vertices - std::min(vertices, *limits_.max_vertices);
    }
    /// Whether there is memory for another copy of all that the process holds: savepoints, which may come to keep as much as the mesh holds, are left
    /// out otherwise.
    [[nodiscard]] bool can_double() const;
    /// Whether so much more may be taken at once, as poll() would judge afterwards.
    [[nodiscard]] bool has_room_for(std::uint64_t bytes) const;

private:
    using Clock = std::chrono::steady_clock;
    Verdict look(std::uint64_t vertices, std::uint64_t tets, std::uint64_t unmet);
    [[nodiscard]] Clock::time_point now() const { return control_->clock ? control_->clock() : Clock::now(); }
    [[nodiscard]] std::uint64_t memory() const;
    [[nodiscard]] MeshError gave_up(Verdict verdict, std::uint64_t vertices, const std::optional<ElementRef>& where) const;

    Limits limits_;
    const RunControl* control_;
    Clock::time_point start_, last_progress_{}, last_look_;
    unsigned polls_ = 0, stride_ = 1;  // look at the clock every so many polls
    std::optional<std::uint64_t> ceiling_{};
    Verdict spent_ = Verdict::go_on;  // of the user's limits
    Stage stage_ = Stage::read;
    bool conforming_ = false;
};

}  // namespace wellmesh
