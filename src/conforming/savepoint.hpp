// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "conforming/conforming_mesh.hpp"
#include "core/check.hpp"

namespace wellmesh {

/// A state of a mesh to fall back to, without a copy of it: what changes is kept just before it does, once, so that a savepoint costs what changes after it, in
/// time and memory. They nest: the last one to begin ends first. The mesh must not be moved meanwhile.
class Savepoint {
public:
    explicit Savepoint(ConformingMesh& mesh) : mesh_(mesh), depth_(mesh.savepoints() + 1) { mesh_.open_savepoint(); }
    /// The mesh stays as it is.
    ~Savepoint() { mesh_.close_savepoint(); }
    Savepoint(const Savepoint&) = delete;
    Savepoint& operator=(const Savepoint&) = delete;

    /// The mesh is what it was when this began, ids included, as often as need be. What is known of it since is void. @pre no later savepoint is left
    void go_back() {
        WELLMESH_CHECK(Stage::shape, mesh_.savepoints() == depth_);
        mesh_.roll_back();
    }

private:
    ConformingMesh& mesh_;
    std::size_t depth_;
};

}  // namespace wellmesh
