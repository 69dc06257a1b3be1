// SPDX-License-Identifier: Apache-2.0
// Ctrl-C, SIGTERM and SIGHUP end the program with status 130 and no half-written file.
#pragma once

#include <atomic>
#include <csignal>
#include <stop_token>
#include <thread>

namespace wellmesh::cli {

/// Waits for signals on a thread of its own, so that what it does need not be async-signal-safe. One a program, made before
/// any other thread. Signals that the parent process ignores (nohup, background jobs) stay ignored.
///
/// By default a signal ends the process at once: right while reading and computing without a stop token. While a
/// `Cooperative` lives, the first signal only requests a stop and the second one ends it.
class Interrupt {
public:
    Interrupt();
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;

    [[nodiscard]] std::stop_token token() const { return source_.get_token(); }
    [[nodiscard]] bool requested() const { return source_.stop_requested(); }

    class Cooperative {
    public:
        explicit Cooperative(Interrupt& interrupt) : interrupt_(interrupt) { ++interrupt_.cooperative_; }
        ~Cooperative() { --interrupt_.cooperative_; }
        Cooperative(const Cooperative&) = delete;
        Cooperative& operator=(const Cooperative&) = delete;

    private:
        Interrupt& interrupt_;
    };

private:
    void listen();

    sigset_t signals_{};
    std::stop_source source_;
    std::atomic<int> cooperative_ = 0;
    std::atomic<bool> closing_ = false;
    std::thread listener_;
};

}  // namespace wellmesh::cli
