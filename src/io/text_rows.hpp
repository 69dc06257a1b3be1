// SPDX-License-Identifier: Apache-2.0
// Rows of a text, read on several threads. Each begins where the lines say that a row should; that it does is known once the rows before it have ended there.
// So any layout is read right, with any number of threads, and the usual one, as many lines for each row, is read fast.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <new>
#include <utility>
#include <vector>

#include "core/workers.hpp"
#include "io/text_scanner.hpp"
#include "wellmesh/error.hpp"

namespace wellmesh::io {

/// Tally of rows that add up to nothing.
struct NoTally {
    void join(const NoTally&) {}
};

/// Tally of rows that somebody takes one after the other.
template <class Row, class Taker>
struct RowsInOrder {
    Taker* taker = nullptr;  ///< whose take(row) is called at once; null: rows are kept until they are joined to a tally that has a taker
    std::vector<Row> kept{};
    void add(Row&& row) {
        if (taker != nullptr) taker->take(std::move(row));
        else kept.push_back(std::move(row));
    }
    void join(RowsInOrder&& later) {
        for (Row& row : later.kept) add(std::move(row));
    }
};

/// The rows that should begin in the next stretches of a text.
class RowStretches {
public:
    /// @param in  before a row. @param lines_a_row  with tokens, counted on the last row
    RowStretches(const TextScanner& in, std::size_t lines_a_row, Workers& workers)
        : workers_(workers), lines_a_row_(lines_a_row), stretches_(in.stretches(kStretchBytes, std::size_t{kStretches} * workers.threads())) {
        std::vector<TextScanner::Lines> lines(stretches_.size());
        workers.for_each(stretches_.size(), [&](std::size_t s) { lines[s] = stretches_[s].count_lines(); });
        std::uint64_t line = in.line();
        for (std::size_t s = 0; s < stretches_.size(); ++s) {
            // Its last row may go on in the next one. No further: what is taken for a row may go on for ever.
            stretches_[s].widen_to(s + 1 < stretches_.size() ? stretches_[s + 1] : in, line);
            line += lines[s].ends;
            lines_before_.push_back(lines_before_.back() + lines[s].with_tokens);
        }
    }

    /// Reads those rows, `most` at most, each stretch with a tally of its own, and joins the tallies in order; `in` and `tally` end as if it had been
    /// one row after the other.
    /// @param read  read(in, row, tally): whether there is a further row, which has been read then. Else `in` is where it was.
    /// @return how many are read. Fewer than there should be: what comes next is an error, or no row, or doesn't begin where it should.
    template <class Tally, class Read>
    std::size_t read(TextScanner& in, std::size_t most, Tally& tally, const Read& read) {
        std::vector<Outcome<Tally>> outcomes(stretches_.size());
        workers_.for_each(stretches_.size(), [&](std::size_t s) {
            try {
                outcomes[s] = read_stretch<Tally>(s, most, read);
            } catch (const MeshError&) {
                // The outcome stays empty. Whoever reads from the row before on finds the first error of all, as without threads.
            } catch (const std::bad_alloc&) {  // for what may have been no row: likewise
            }
        });
        std::size_t done = 0;
        for (std::size_t s = 0; s < stretches_.size(); ++s) {
            if (first_row(s, most) == first_row(s + 1, most)) continue;
            (void)in.at_end();  // moves to where the next row begins
            if (outcomes[s].begin == nullptr || outcomes[s].begin != in.place().byte) break;
            if (outcomes[s].rows > 0) tally.join(std::move(outcomes[s].tally));
            in.move_to(stretches_[s].place());
            done += outcomes[s].rows;
            if (done != first_row(s + 1, most)) break;
        }
        return done;
    }

    /// That should begin in all stretches, where `most` are wanted.
    [[nodiscard]] std::size_t rows(std::size_t most) const { return first_row(stretches_.size(), most); }

private:
    template <class Tally>
    struct Outcome {
        const char* begin = nullptr;  // of the first row
        std::size_t rows = 0;
        Tally tally{};
    };

    /// The first row that should begin in stretch `s` or later.
    [[nodiscard]] std::size_t first_row(std::size_t s, std::size_t most) const { return std::min(most, (lines_before_[s] + lines_a_row_ - 1) / lines_a_row_); }

    template <class Tally, class Read>
    Outcome<Tally> read_stretch(std::size_t s, std::size_t most, const Read& read) {
        Outcome<Tally> outcome;
        TextScanner in = stretches_[s];  // a copy: neighbours in memory are other threads'
        const std::size_t first = first_row(s, most), last = first_row(s + 1, most);
        for (std::size_t line = lines_before_[s]; line < first * lines_a_row_ && first < last; ++line) {
            (void)in.at_end();
            in.skip_line();
        }
        (void)in.at_end();
        outcome.begin = in.place().byte;
        while (first + outcome.rows < last && read(in, first + outcome.rows, outcome.tally)) ++outcome.rows;
        stretches_[s].move_to(in.place());
        if (in.is_used_up() && s + 1 < stretches_.size()) return {};  // a row may have ended there that does go on
        return outcome;
    }

    static constexpr std::size_t kStretchBytes = std::size_t{1} << 16;  // a thousand rows or two: they stay in the cache from being counted to being read
    static constexpr std::size_t kStretches = 16;                       // a thread at a time, so that none waits long for the last one

    Workers& workers_;
    std::size_t lines_a_row_;
    std::vector<TextScanner> stretches_;
    std::vector<std::size_t> lines_before_{0};  // with tokens, before each stretch, and all of them
};

/// Reads rows for as long as there are any, `most` at most. Several calls of read() run at once where the file has workers, on scanners and tallies of
/// their own; some are repeated, and of some, behind the last row, the outcome is dropped. Data, tally and errors are those of one call after the other.
/// @param in  before the first row. @param tally  what rows add up to: join() of others, in order, makes it what it alone would be
/// @param make_room  make_room(m): rows below m are about to be read
/// @param read  as in RowStretches::read(). What it stores in the row's place, if not in the tally, may be stored again
/// @return the number of rows
template <class Tally, class MakeRoom, class Read>
std::size_t read_rows_while(TextScanner& in, std::size_t most, Tally& tally, const MakeRoom& make_room, const Read& read) {
    constexpr std::size_t kFewRows = 1024;  // that take less time than it takes to share them out
    Workers* const workers = in.source().workers.get();
    std::size_t done = 0;
    for (std::size_t spell = kFewRows;; spell *= 2) {  // the more often rows weren't as they should be, the longer they are read one by one
        TextScanner::Place last = in.place();
        for (std::size_t i = 0; i < spell; ++i, ++done) {
            if (done == most) return done;
            if (i % kFewRows == 0) make_room(std::min(most, done + kFewRows));
            if (i + 1 == spell) last = in.place();
            if (!read(in, done, tally)) return done;
        }
        if (workers == nullptr) continue;
        const std::size_t lines_a_row = std::max<std::size_t>(in.count_lines_since(last), 1);
        while (done < most && !in.at_end()) {
            RowStretches stretches(in, lines_a_row, *workers);
            const std::size_t rows = stretches.rows(most - done), first = done;
            make_room(first + rows);
            done += stretches.read(in, rows, tally, [&](TextScanner& part, std::size_t row, Tally& part_tally) { return read(part, first + row, part_tally); });
            if (done < first + rows) break;
        }
    }
}

/// Reads `n` rows, likewise. @param read  read(in, i, tally): reads row i and stores it in its place. @throws what it throws
template <class Tally, class MakeRoom, class Read>
void read_rows(TextScanner& in, std::size_t n, Tally& tally, const MakeRoom& make_room, const Read& read) {
    read_rows_while(in, n, tally, make_room, [&](TextScanner& part, std::size_t i, Tally& part_tally) {
        read(part, i, part_tally);
        return true;
    });
}

}  // namespace wellmesh::io
