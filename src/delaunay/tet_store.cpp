// SPDX-License-Identifier: Apache-2.0
#include "delaunay/tet_store.hpp"

#include "wellmesh/error.hpp"

namespace wellmesh {

TetId TetStore::allocate() {
    if (!free_.empty()) {
        const TetId t = free_.back();
        free_.pop_back();
        return t;
    }
    constexpr std::size_t kMaxTets = (std::size_t{1} << 30) - 1;  // TetFace packs 4 t + f into 32 bits, all ones is "none"
    if (corner_.size() >= kMaxTets) throw MeshError(ErrorCode::mesh_too_large, Stage::delaunay, "more than 2^30 tetrahedra: ask for a coarser mesh");
    corner_.emplace_back();
    opposite_.emplace_back();
    return TetId{corner_.size() - 1};
}

void TetStore::release(TetId t) {
    corner_[t.index()] = Corners{};
    free_.push_back(t);
}

void TetStore::reserve(std::size_t tets) {
    corner_.reserve(tets);
    opposite_.reserve(tets);
}

void TetStore::clear() {
    corner_.clear();
    opposite_.clear();
    free_.clear();
}

}  // namespace wellmesh
