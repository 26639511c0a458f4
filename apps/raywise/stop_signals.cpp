#include "console.hpp"
#include "stop_signals.hpp"

#include <raywise/core/progress.hpp>

#include <pthread.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <ctime>
#include <mutex>

namespace raywise::app {

namespace {

/// The signals that the waiting thread takes; SIGUSR1 is our own call to end it.
sigset_t awaited_signals() {
    sigset_t set;
    sigemptyset(&set);
    sigaddset(&set, SIGINT);
    sigaddset(&set, SIGTERM);
    sigaddset(&set, SIGUSR1);
    return set;
}

} // namespace

StopSignals::StopSignals(Console& console) : console_(console) {
    const sigset_t set = awaited_signals();
    ::pthread_sigmask(SIG_BLOCK, &set, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
    waiter_ = std::thread([this] { wait_for_signals(); });
}

StopSignals::~StopSignals() {
    is_ending_ = true;
    ::pthread_kill(waiter_.native_handle(), SIGUSR1);
    waiter_.join();
}

std::unique_lock<std::mutex> StopSignals::hold() const {
    std::unique_lock lock(writing_);
    if (received_ != 0) throw Cancelled();
    return lock;
}

void StopSignals::wait_for_signals() {
    // A thread that waits may do what a signal handler must not: lock, allocate, run stop
    // callbacks.
    const sigset_t set = awaited_signals();
    constexpr ::timespec grace{2, 0};
    for (;;) {
        const int number = ::sigtimedwait(&set, nullptr, received_ != 0 ? &grace : nullptr);
        if (number < 0 && errno == EINTR) continue;
        if (number == SIGUSR1) {
            if (is_ending_) return;
            continue;
        }
        if (number < 0) end_process(received_);
        if (received_ != 0) ::_exit(128 + number);
        received_ = number;
        source_.request_stop();
    }
}

void StopSignals::end_process(int number) {
    const std::scoped_lock lock(writing_);
    console_.error(stopped_message);
    ::_exit(128 + number);
}

} // namespace raywise::app
