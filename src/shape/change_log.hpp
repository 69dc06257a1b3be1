// SPDX-License-Identifier: Apache-2.0
// A chain of changes that is kept or undone as a whole, exactly: a step that makes something worse may lead to a better mesh.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "conforming/conforming_mesh.hpp"

namespace wellmesh {

class ChangeLog {
public:
    struct Step {
        VertexId vertex{};
        Placement where{};
        Vec3 home{};                            // where it was
        bool removed = false;                   // or moved
        ConformingMesh::Snapshot star, cavity;  // before it was taken out; before it was put elsewhere
    };

    void begin() {
        steps_.clear();
        open_ = true;
    }
    [[nodiscard]] bool is_open() const { return open_; }
    void note(Step step) { steps_.push_back(std::move(step)); }
    void keep() { open_ = false; }
    /// Undoes the steps since begin(). @pre nothing else has changed the mesh since
    void undo(ConformingMesh& mesh) {
        undo_after(mesh, 0);
        open_ = false;
    }
    [[nodiscard]] std::size_t size() const { return steps_.size(); }
    /// Undoes all but the first `kept` steps, and stays open.
    void undo_after(ConformingMesh& mesh, std::size_t kept) {
        for (; steps_.size() > kept; steps_.pop_back()) {
            const Step& step = steps_.back();
            if (!step.removed) mesh.undo_insertion(step.vertex, step.where, step.cavity);
            mesh.triangulation().set_point(step.vertex, step.home);
            mesh.undo_removal(step.vertex, step.where, step.star);
        }
    }

private:
    std::vector<Step> steps_;
    bool open_ = false;
};

}  // namespace wellmesh
