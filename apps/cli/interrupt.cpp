// SPDX-License-Identifier: Apache-2.0
#include "interrupt.hpp"

#include <pthread.h>
#include <unistd.h>

#include "exit_status.hpp"

namespace wellmesh::cli {

Interrupt::Interrupt() {
    sigemptyset(&signals_);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction action {};
        sigaction(signal, nullptr, &action);
        if (action.sa_handler != SIG_IGN) sigaddset(&signals_, signal);
    }
    sigaddset(&signals_, SIGUSR2);  // our own, to end the listener
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    listener_ = std::thread([this] { listen(); });
}

Interrupt::~Interrupt() {
    closing_ = true;
    pthread_kill(listener_.native_handle(), SIGUSR2);
    listener_.join();
    pthread_sigmask(SIG_UNBLOCK, &signals_, nullptr);
}

void Interrupt::listen() {
    for (;;) {
        int signal = 0;
        if (sigwait(&signals_, &signal) != 0) continue;
        if (closing_) return;
        if (signal == SIGUSR2) continue;
        if (cooperative_ == 0) _exit(kInterrupted);
        if (source_.request_stop()) continue;
        _exit(kInterrupted);  // asked twice: whoever waits for a pipe to be read can't be asked to end
    }
}

}  // namespace wellmesh::cli
