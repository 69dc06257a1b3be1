// SPDX-License-Identifier: Apache-2.0
// Small numbers for the vertices of one operation's few tetrahedra: 1, 2, 3, ... in order of first mention, without branches, since whether a vertex is new can't
// be foreseen. Each vertex has a word of scratch for them, which holds anything at the beginning.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/ids.hpp"
#include "delaunay/tet_store.hpp"

namespace wellmesh {

/// A word that isn't a stamped number.
inline constexpr std::uint32_t kUnstamped = 0x80000000U;

/// The word is the operation's stamp and the number: nothing else is looked up, so that one number doesn't wait for the next. Below 64.
class StampedNumbers {
public:
    static constexpr std::uint32_t kMost = 64;
    static constexpr std::uint32_t kLastStamp = kUnstamped / kMost - 1;

    explicit StampedNumbers(std::uint32_t stamp) : stamp_(stamp * kMost) {}
    std::uint32_t operator()(VertexId, std::uint32_t& word) {
        const std::uint32_t known = word ^ stamp_;
        const std::uint32_t number = std::min(known, count_);  // a new vertex's word is kMost or more
        count_ += known >= kMost ? 1 : 0;
        word = stamp_ | number;
        return number;
    }

private:
    std::uint32_t stamp_, count_ = 1;
};

/// The word is a number, which holds if the list of numbered vertices says so. For when stamps don't do. Below kLimit.
template <std::uint32_t kLimit>
class ListedNumbers {
public:
    static constexpr std::uint32_t kMost = kLimit;

    ListedNumbers() {
        met_.fill(VertexId{});
        met_[0] = kInfiniteVertex;
    }
    std::uint32_t operator()(VertexId v, std::uint32_t& word) {
        const std::uint32_t known = word % kMost, is_new = met_[known] != v ? 1 : 0;
        const std::uint32_t number = known ^ ((known ^ count_) & (0 - is_new));
        count_ += is_new;
        met_[number] = v;
        word = kUnstamped | number;
        return number;
    }

private:
    std::array<VertexId, kMost> met_;
    std::uint32_t count_ = 1;
};

}  // namespace wellmesh
