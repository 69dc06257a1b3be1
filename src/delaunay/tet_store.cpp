// SPDX-License-Identifier: Apache-2.0
#include "delaunay/tet_store.hpp"

#include "wellmesh/error.hpp"

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace wellmesh {
namespace {

/// Walks and cavities touch the array at random: with 4 kB pages most visits miss the translation buffer. A hint, nothing depends on it.
void advise_huge_pages([[maybe_unused]] void* data, [[maybe_unused]] std::size_t bytes) {
#ifdef __linux__
    constexpr std::uintptr_t kHugePage = std::uintptr_t{1} << 21;
    const auto begin = (reinterpret_cast<std::uintptr_t>(data) + kHugePage - 1) & ~(kHugePage - 1);
    const auto end = (reinterpret_cast<std::uintptr_t>(data) + bytes) & ~(kHugePage - 1);
    if (begin < end) (void)madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
#endif
}

}  // namespace

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
    advise_huge_pages(tet_.data(), tet_.capacity() * sizeof(Tet));
}

void TetStore::clear() {
    tet_.clear();
    free_.clear();
}

}  // namespace wellmesh
