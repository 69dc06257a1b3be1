// SPDX-License-Identifier: Apache-2.0
// Threads that share out numbered pieces of work. Which thread takes which piece is chance, so what a piece does may depend on its number only:
// then the result is the same for any number of threads.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <type_traits>
#include <vector>

namespace wellmesh {

/// A team of threads; the caller's is one of them. Without others, or from within a piece of work, everything runs on the calling thread, in order.
/// Not thread-safe: one caller at a time.
class Workers {
public:
    /// @param threads  0: as many as the machine has cores.
    explicit Workers(unsigned threads = 1);
    ~Workers();
    Workers(const Workers&) = delete;
    Workers& operator=(const Workers&) = delete;

    [[nodiscard]] unsigned threads() const { return static_cast<unsigned>(team_.size()) + 1; }

    /// Calls work(i) once for each i below `pieces`, in any order and at once; returns when all are done. What pieces wrote is visible then.
    /// @throws what the failed piece of the lowest number threw; the others have run to their end, or were not begun.
    template <class Work>
    void for_each(std::size_t pieces, Work&& work) {
        using Callable = std::remove_reference_t<Work>;
        run(pieces, [](void* context, std::size_t i) { (*static_cast<Callable*>(context))(i); }, const_cast<std::remove_const_t<Callable>*>(&work));
    }

    /// Calls work(begin, end, piece) for the pieces of [0, n), each of `grain` elements but the last: their limits don't depend on the number of threads.
    template <class Work>
    void for_ranges(std::size_t n, std::size_t grain, Work&& work) {
        for_each((n + grain - 1) / grain, [&](std::size_t piece) { work(piece * grain, std::min(n, (piece + 1) * grain), piece); });
    }

private:
    using Call = void (*)(void*, std::size_t);
    void run(std::size_t pieces, Call call, void* context);
    void take_part();
    void stand_by();

    std::vector<std::thread> team_;
    std::mutex mutex_;
    std::condition_variable begin_, end_;
    // of the work at hand, under the mutex
    Call call_ = nullptr;
    void* context_ = nullptr;
    std::size_t pieces_ = 0, next_ = 0;
    std::size_t busy_ = 0;  // pieces begun and not ended
    std::size_t failed_piece_ = 0;
    std::exception_ptr failure_;
    bool closing_ = false;
};

}  // namespace wellmesh
