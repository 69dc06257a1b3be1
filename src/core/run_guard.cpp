// SPDX-License-Identifier: Apache-2.0
#include "core/run_guard.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/resident_memory.hpp"

namespace wellmesh {
namespace {

// Insertions take microseconds, or milliseconds where the input is degenerate: the stride between looks follows.
constexpr std::chrono::microseconds kOftenEnough{250}, kTooSeldom{1000};
constexpr unsigned kLongestStride = 64;

std::string text_of(RunGuard::Verdict verdict, const Limits& limits, std::uint64_t vertices) {
    switch (verdict) {
        case RunGuard::Verdict::out_of_time:
            return fmt::format("the time limit of {:g} s passed", static_cast<double>(limits.time.value_or(std::chrono::milliseconds{0}).count()) / 1000);
        case RunGuard::Verdict::out_of_memory:
            return fmt::format("the memory limit of {:.4g} MiB was reached", static_cast<double>(limits.memory_bytes.value_or(0)) / (1 << 20));
        case RunGuard::Verdict::out_of_vertices: return fmt::format("{} vertices were not enough", vertices);
        default: return "interrupted";
    }
}

}  // namespace

RunGuard::RunGuard(const Limits& limits, const RunControl& control) : limits_(limits), control_(&control), start_(now()), last_look_(start_) {}

std::uint64_t RunGuard::memory() const { return control_->resident_bytes ? control_->resident_bytes() : resident_bytes(); }

bool RunGuard::can_double() const { return !limits_.memory_bytes || memory() <= *limits_.memory_bytes / 2; }

bool RunGuard::has_room_for(std::uint64_t bytes) const {
    return !limits_.memory_bytes || kPeakOverRefinement * static_cast<double>(memory() + bytes) <= static_cast<double>(*limits_.memory_bytes);
}

RunGuard::Verdict RunGuard::look(std::uint64_t vertices, std::uint64_t tets, std::uint64_t unmet) {
    const Clock::time_point time = now();
    const auto since = time - last_look_;
    last_look_ = time;
    if (since > kTooSeldom) stride_ = std::max(1U, stride_ / 4);
    else if (since < kOftenEnough) stride_ = std::min(kLongestStride, 2 * stride_);
    if (control_->on_progress && vertices > 0 && time - last_progress_ > std::chrono::milliseconds(100)) {
        last_progress_ = time;
        control_->on_progress({stage_, vertices, tets, unmet});
    }
    if (limits_.time && time - start_ > *limits_.time) return spent_ = Verdict::out_of_time;
    // What is held now may have to grow once more before the mesh is certified with it.
    if (limits_.memory_bytes && kPeakOverRefinement * static_cast<double>(memory()) > static_cast<double>(*limits_.memory_bytes)) return spent_ = Verdict::out_of_memory;
    return Verdict::go_on;
}

MeshError RunGuard::gave_up(Verdict verdict, std::uint64_t vertices, const std::optional<ElementRef>& where) const {
    std::vector<ElementRef> offenders;
    if (where) offenders.push_back(*where);
    return {verdict == Verdict::cancelled ? ErrorCode::cancelled : ErrorCode::budget_exhausted, stage_,
            fmt::format("{} in stage {}, before the mesh conformed to its input", text_of(verdict, limits_, vertices), to_string(stage_)), std::move(offenders)};
}

Checkpoint RunGuard::checkpoint() {
    return [this] {
        polls_ = stride_;
        if (const Verdict verdict = poll(0, 0, 0); verdict != Verdict::go_on) throw gave_up(verdict, 0, {});
    };
}

}  // namespace wellmesh
