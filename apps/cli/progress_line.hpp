// SPDX-License-Identifier: Apache-2.0
// One line on the terminal that says how far a run is, rewritten in place and erased at the end.
#pragma once

#include "wellmesh/run_control.hpp"

namespace wellmesh::cli {

class ProgressLine {
public:
    /// @param wanted  false keeps it silent; so does a standard error that is not a terminal able to move its cursor.
    explicit ProgressLine(bool wanted);
    ~ProgressLine() { erase(); }
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    [[nodiscard]] bool enabled() const { return enabled_; }
    void show(const Progress& progress);
    void erase();

private:
    bool enabled_ = false;
    bool visible_ = false;
};

}  // namespace wellmesh::cli
