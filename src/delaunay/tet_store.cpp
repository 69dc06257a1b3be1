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
    if (tet_.size() >= kMaxTets) throw MeshError(ErrorCode::mesh_too_large, Stage::delaunay, "more than 2^30 tetrahedra: ask for a coarser mesh");
    tet_.emplace_back();
    return TetId{tet_.size() - 1};
}

void TetStore::release(TetId t) {
    tet_[t.index()].corner = Corners{};
    free_.push_back(t);
}

void TetStore::reserve(std::size_t tets) {
    tet_.reserve(tets);
}

void TetStore::clear() {
    tet_.clear();
    free_.clear();
}

}  // namespace wellmesh
