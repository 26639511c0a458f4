// SIGINT and SIGTERM as a stop token: the work ends at its next step, with nothing half-written.
#pragma once

#include "console.hpp"

#include <atomic>
#include <mutex>
#include <stop_token>
#include <thread>

namespace raywise::app {

/// While it lives, the first SIGINT or SIGTERM requests the stop; work that does not heed it within
/// two seconds is ended all the same, and a second signal ends the process at once. Make it before
/// any other thread: signals are blocked in the threads that are made later. Also turns off
/// SIGPIPE, so that a closed pipe is a write that fails.
class StopSignals {
public:
    /// Says on the console when it ends the process itself; the console must outlive it.
    explicit StopSignals(Console& console);
    ~StopSignals();
    StopSignals(const StopSignals&) = delete;
    StopSignals& operator=(const StopSignals&) = delete;
    StopSignals(StopSignals&&) = delete;
    StopSignals& operator=(StopSignals&&) = delete;

    [[nodiscard]] std::stop_token token() const { return source_.get_token(); }

    /// The signal that requested the stop; 0 when none did.
    [[nodiscard]] int received() const { return received_; }

    /// Hold it while files are written: the process is then not ended by the first signal. Throws
    /// Cancelled when a stop was requested already.
    [[nodiscard]] std::unique_lock<std::mutex> hold() const;

private:
    void wait_for_signals();
    [[noreturn]] void end_process(int number);

    Console& console_;
    std::stop_source source_;
    std::atomic<int> received_ = 0;
    std::atomic<bool> is_ending_ = false;
    mutable std::mutex writing_;
    std::thread waiter_;
};

/// What is said, whoever ends the work.
inline constexpr const char* stopped_message = "stopped by a signal; nothing was written";

} // namespace raywise::app
