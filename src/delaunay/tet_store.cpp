// SPDX-License-Identifier: Apache-2.0
#include "delaunay/tet_store.hpp"

#include <algorithm>
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

TetStore::Slots TetStore::take_slots(std::size_t count) {
    Slots out;
    const std::size_t recycled = std::min(count, free_.size());
    out.recycled.assign(free_.rbegin(), free_.rbegin() + static_cast<std::ptrdiff_t>(recycled));
    free_.resize(free_.size() - recycled);
    out.first = tet_.size();
    out.count = count - recycled;
    if (out.first + out.count > kMaxTets) refuse_size();
    tet_.resize_as_is(out.first + out.count);
    return out;
}

std::vector<TetId> TetStore::Slots::list() && {
    recycled.reserve(recycled.size() + count);
    for (std::size_t i = count; i-- > 0;) recycled.emplace_back(first + i);  // the last one is taken first
    return std::move(recycled);
}

TetStore TetStore::view(std::vector<TetId> slots) {
    TetStore out;
    out.tet_ = tet_.view();
    out.free_ = std::move(slots);
    return out;
}

/// Each goes to its place by a swap with what is there. Unlike along the cycles of the permutation, what is needed next is known long before.
void TetStore::reorder_in_place(std::span<const TetId> t, std::span<TetId> place) {
    constexpr std::size_t kAhead = 12;
    std::vector<TetId> holds(place.begin(), place.end());  // of each slot, which one is there now
    for (std::size_t i = 0; i < t.size(); ++i) {
        if (i + 2 * kAhead < t.size()) {
            __builtin_prefetch(place.data() + t[i + 2 * kAhead].index());
            const std::size_t next = place[t[i + kAhead].index()].index();
            __builtin_prefetch(tet_.data() + next);
            __builtin_prefetch(holds.data() + next);
        }
        const TetId from = place[t[i].index()], other = holds[i];
        std::swap(tet_[i], tet_[from.index()]);
        holds[from.index()] = other;
        place[other.index()] = from;
    }
}

void TetStore::reorder(std::span<const TetId> t, std::span<TetId> scratch, Workers& workers) {
    constexpr std::size_t kGrain = std::size_t{1} << 15;
    workers.for_ranges(scratch.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) scratch[i] = TetId{i};
    });
    // Copies to new memory, by several threads, took one and a half to six times as long: the system clears it first.
    reorder_in_place(t, scratch);
    tet_.resize_as_is(t.size());
    free_.clear();
}

void TetStore::clear() {
    tet_.clear();
    free_.clear();
}

}  // namespace wellmesh
