// SPDX-License-Identifier: Apache-2.0
// What elements of an array were before they changed, so that the array can be put back into an earlier state: the undo log of databases, with nested
// savepoints. Each element is kept once, just before its first change since the last savepoint, so that the log holds no more than a copy of the array for each savepoint, and
// mostly is far smaller.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "core/check.hpp"
#include "core/shared_array.hpp"

namespace wellmesh {

template <class Value>
class UndoLog {
public:
    /// Is there a savepoint?
    [[nodiscard]] bool is_open() const { return level_ != 0; }
    /// Is element i to be kept before it changes?
    [[nodiscard]] bool wants(std::size_t i) const { return i < size_ && level_of_[i] != level_; }
    /// @pre wants(i)
    void keep(std::size_t i, const Value& before) {
        entries_.push_back({static_cast<std::uint32_t>(i), level_of_[i], before});
        level_of_[i] = level_;
    }

    /// A savepoint, when the array has so many elements: what is appended later goes without being kept.
    void open(std::size_t size) {
        WELLMESH_CHECK(Stage::shape, level_ < std::numeric_limits<std::uint8_t>::max());
        levels_.push_back({size, entries_.size()});
        if (level_of_.size() < size) level_of_.resize(size, 0);
        size_ = size;
        ++level_;
    }
    /// Calls put_back(i, value) for what has changed since the last savepoint, which stays.
    template <class PutBack>
    void roll_back(const PutBack& put_back) {
        for (; entries_.size() > levels_.back().first_entry; entries_.pop_back()) {
            const Entry& e = entries_.back();
            put_back(std::size_t{e.index}, e.value);
            level_of_[e.index] = e.level_before;
        }
    }
    /// The last savepoint goes; what has changed since it has changed since the one before.
    void close() {
        const std::size_t first = levels_.back().first_entry;
        levels_.pop_back();
        --level_;
        if (levels_.empty()) {
            entries_.clear();
            level_of_.release();
            size_ = 0;
            return;
        }
        size_ = levels_.back().size;
        auto kept = entries_.begin() + static_cast<std::ptrdiff_t>(first);
        for (auto e = kept; e != entries_.end(); ++e) {
            const bool is_new = e->index >= size_;  // since the savepoint before: no entry will tell of it any more
            level_of_[e->index] = is_new ? std::uint8_t{0} : level_;
            if (!is_new && e->level_before != level_) *kept++ = *e;
        }
        entries_.erase(kept, entries_.end());
    }

    /// For a view of the array (SharedArray), which keeps what it changes itself. Until join() this log is not touched.
    [[nodiscard]] UndoLog view() {
        UndoLog out;
        out.level_of_ = level_of_.view();
        out.size_ = size_;
        out.level_ = level_;
        return out;
    }
    /// Takes over what a view has kept. No two views have changed the same element.
    void join(UndoLog& view) { entries_.insert(entries_.end(), std::make_move_iterator(view.entries_.begin()), std::make_move_iterator(view.entries_.end())); }
    [[nodiscard]] std::size_t kept() const { return entries_.size(); }

private:
    struct Entry {
        std::uint32_t index = 0;
        std::uint8_t level_before = 0;  // of the element
        Value value{};
    };
    struct Level {
        std::size_t size = 0, first_entry = 0;
    };

    SharedArray<std::uint8_t> level_of_;  // by element: the savepoint, counted from 1, since which it has been kept last; 0: none
    std::deque<Entry> entries_;           // never there twice, as a vector that grows is
    std::vector<Level> levels_;
    std::size_t size_ = 0;    // of the last savepoint
    std::uint8_t level_ = 0;  // how many savepoints there are
};

}  // namespace wellmesh
