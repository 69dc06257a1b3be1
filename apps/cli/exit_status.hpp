// SPDX-License-Identifier: Apache-2.0
// What the program's exit status means. docs/conventions.md says the same in prose.
#pragma once

#include "wellmesh/error.hpp"

namespace wellmesh::cli {

inline constexpr int kGoalsMet = 0;
inline constexpr int kGoalsUnmet = 1;     ///< a valid mesh that misses goals, or a refuted claim of `check`
inline constexpr int kBadInput = 2;       ///< diagnosed; nothing written
inline constexpr int kUsage = 3;          ///< unknown option, value out of range
inline constexpr int kGaveUp = 4;         ///< vertices, time or memory spent before the mesh conformed; nothing written
inline constexpr int kFileProblem = 5;    ///< a file can't be read or written
inline constexpr int kInternalError = 70; ///< EX_SOFTWARE of sysexits.h: a bug in wellmesh
inline constexpr int kInterrupted = 130;  ///< 128 + SIGINT, what a shell reports for Ctrl-C; nothing half written

/// The exit status that include/wellmesh/error.hpp names for `code`.
[[nodiscard]] int exit_status(ErrorCode code) noexcept;

}  // namespace wellmesh::cli
