// SPDX-License-Identifier: Apache-2.0
#include "exit_status.hpp"

namespace wellmesh::cli {

int exit_status(ErrorCode code) noexcept {
    switch (code) {
        case ErrorCode::bad_input:
        case ErrorCode::coordinate_range: return kBadInput;
        case ErrorCode::bad_options: return kUsage;
        case ErrorCode::budget_exhausted:
        case ErrorCode::unsupported_acute:
        case ErrorCode::mesh_too_large: return kGaveUp;
        case ErrorCode::cannot_read:
        case ErrorCode::cannot_write: return kFileProblem;
        case ErrorCode::cancelled: return kInterrupted;
        case ErrorCode::internal_invariant: return kInternalError;
    }
    return kInternalError;
}

}  // namespace wellmesh::cli
