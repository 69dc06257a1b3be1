// SPDX-License-Identifier: Apache-2.0
#include "core/workers.hpp"

#include <system_error>
#include <utility>

namespace wellmesh {
namespace {

/// Is this thread at work on a piece? Then it must not wait for others, who may wait for it.
thread_local bool at_work = false;

}  // namespace

Workers::Workers(unsigned threads) {
    if (threads == 0) threads = std::max(1U, std::thread::hardware_concurrency());
    team_.reserve(threads - 1);  // now, while there is no thread that a failure would leave behind
    try {
        for (unsigned i = 1; i < threads; ++i) team_.emplace_back([this] { stand_by(); });
    } catch (const std::system_error&) {
        // Fewer threads than asked for give the same result, later.
    }
}

Workers::~Workers() {
    {
        const std::lock_guard lock(mutex_);
        closing_ = true;
    }
    begin_.notify_all();
    for (std::thread& t : team_) t.join();
}

void Workers::run(std::size_t pieces, Call call, void* context) {
    if (team_.empty() || at_work || pieces <= 1) {
        for (std::size_t i = 0; i < pieces; ++i) call(context, i);
        return;
    }
    std::unique_lock lock(mutex_);
    call_ = call;
    context_ = context;
    pieces_ = pieces;
    next_ = 0;
    failure_ = nullptr;
    lock.unlock();
    begin_.notify_all();
    take_part();
    lock.lock();
    end_.wait(lock, [this] { return busy_ == 0 && next_ >= pieces_; });
    pieces_ = next_ = 0;
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

/// Takes pieces until there are none. Pieces are coarse: a lock for each is no matter.
void Workers::take_part() {
    std::unique_lock lock(mutex_);
    at_work = true;
    while (next_ < pieces_) {
        const std::size_t piece = next_++;
        ++busy_;
        lock.unlock();
        std::exception_ptr thrown;
        try {
            call_(context_, piece);
        } catch (...) {
            thrown = std::current_exception();
        }
        lock.lock();
        --busy_;
        if (thrown && (!failure_ || piece < failed_piece_)) {
            failure_ = thrown;
            failed_piece_ = piece;
            next_ = pieces_;  // pieces are begun in order, so the first failure of all is among those begun
        }
    }
    at_work = false;
    if (busy_ == 0) end_.notify_all();
}

void Workers::stand_by() {
    std::unique_lock lock(mutex_);
    for (;;) {
        begin_.wait(lock, [this] { return closing_ || next_ < pieces_; });
        if (closing_) return;
        lock.unlock();
        take_part();
        lock.lock();
    }
}

}  // namespace wellmesh
