// SPDX-License-Identifier: Apache-2.0
// O(1) checks that stay on in every build. A failure is a bug in wellmesh, never in the input.
#pragma once

#include <string>

#include "wellmesh/error.hpp"

namespace wellmesh {

[[noreturn]] inline void fail_invariant(Stage stage, const char* what, const char* file, int line) {
    throw MeshError(ErrorCode::internal_invariant, stage,
                    std::string("internal invariant broken: ") + what + " (" + file + ":" + std::to_string(line) + "); please report this input");
}

}  // namespace wellmesh

#define WELLMESH_CHECK(stage, condition) \
    do {                                 \
        if (!(condition)) [[unlikely]]   \
            ::wellmesh::fail_invariant((stage), #condition, &__FILE__[WELLMESH_SOURCE_PATH_LENGTH], __LINE__); \
    } while (false)
