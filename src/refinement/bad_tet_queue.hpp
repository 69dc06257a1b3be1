// SPDX-License-Identifier: Apache-2.0
// Tetrahedra waiting to be refined, worst first by powers of the square root of two; last in, first out among equals, which keeps
// consecutive insertions close together: locality of the queue is worth more than an exact order.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/ids.hpp"
#include "core/rng.hpp"
#include "delaunay/tet_store.hpp"

namespace wellmesh {

class BadTetQueue {
public:
    struct Entry {
        TetId tet{};
        std::uint32_t fingerprint = 0;
    };

    /// Tells a tetrahedron from a later one that got its id.
    static std::uint32_t fingerprint(const TetStore::Corners& c) {
        return (c[0].value() * 0x9e3779b1U) ^ (c[1].value() * 0x85ebca77U) ^ (c[2].value() * 0xc2b2ae3dU) ^ (c[3].value() * 0x27d4eb2fU);
    }

    /// @param squared_badness  larger is worse; only its power of two counts.
    void push(TetId t, const TetStore::Corners& c, double squared_badness) {
        const int level = squared_badness < 1e300 ? std::clamp(std::ilogb(squared_badness) + kBias, 0, kLevels - 1) : kLevels - 1;
        push({t, fingerprint(c)}, level);
    }
    void push(const Entry& e, int level) {
        buckets_[static_cast<std::size_t>(level)].push_back(e);
        top_ = std::max(top_, level);
        ++size_;
    }
    /// Calls take(entry, level) for all that wait; those for which it says yes are gone. What stays keeps its order.
    template <class Take>
    void deal(Take&& take) {
        size_ = 0;
        for (int level = 0; level <= top_; ++level) {
            auto& bucket = buckets_[static_cast<std::size_t>(level)];
            std::erase_if(bucket, [&](const Entry& e) { return take(e, level); });
            size_ += bucket.size();
        }
    }
    [[nodiscard]] bool empty() const { return size_ == 0; }
    [[nodiscard]] std::size_t size() const { return size_; }
    /// Of the entry that comes next. @pre !empty()
    [[nodiscard]] int level() {
        while (buckets_[static_cast<std::size_t>(top_)].empty()) --top_;
        return top_;
    }
    Entry pop() {
        (void)level();
        auto& bucket = buckets_[static_cast<std::size_t>(top_)];
        const Entry e = bucket.back();
        bucket.pop_back();
        --size_;
        return e;
    }
    void clear() {
        for (auto& b : buckets_) b.clear();
        size_ = 0;
        top_ = 0;
    }

private:
    static constexpr int kBias = 1000, kLevels = 2001;  // nearly all exponents of doubles: models come in metres and in micrometres
    std::vector<std::vector<Entry>> buckets_ = std::vector<std::vector<Entry>>(kLevels);
    int top_ = 0;
    std::size_t size_ = 0;
};

}  // namespace wellmesh
