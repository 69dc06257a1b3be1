// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace wellmesh {

/// Called between pieces of work that nothing could end otherwise; throws to end them. Empty: they never end early.
using Checkpoint = std::function<void()>;

inline void pass(const Checkpoint& checkpoint) {
    if (checkpoint) checkpoint();
}

}  // namespace wellmesh
