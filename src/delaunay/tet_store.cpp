// SPDX-License-Identifier: Apache-2.0
#include "delaunay/tet_store.hpp"

#include <utility>

#include "wellmesh/error.hpp"

namespace wellmesh {
namespace {

[[noreturn]] void refuse_size() { throw MeshError(ErrorCode::mesh_too_large, Stage::delaunay, "more than 2^30 tetrahedra: ask for a coarser mesh"); }

}  // namespace

TetId TetStore::allocate() {
    if (!free_.empty()) {
        const TetId t = free_.back();
        free_.pop_back();
        return t;
    }
    if (tet_.size() >= kMaxTets) refuse_size();
    tet_.push_back(Tet{});
    return TetId{tet_.size() - 1};
}

void TetStore::release(TetId t) {
    tet_[t.index()].corner = Corners{};
    free_.push_back(t);
}

std::vector<TetId> TetStore::take_slots(std::size_t count) {
    std::vector<TetId> out;
    out.reserve(count);
    while (out.size() < count && !free_.empty()) {
        out.push_back(free_.back());
        free_.pop_back();
    }
    const std::size_t more = count - out.size(), first = tet_.size();
    if (first + more > kMaxTets) refuse_size();
    tet_.resize_as_is(first + more);
    for (std::size_t i = more; i-- > 0;) out.push_back(TetId{first + i});  // the last one is taken first
    return out;
}

TetStore TetStore::view(std::vector<TetId> slots) {
    TetStore out;
    out.tet_ = tet_.view();
    out.free_ = std::move(slots);
    return out;
}

void TetStore::clear() {
    tet_.clear();
    free_.clear();
}

}  // namespace wellmesh
