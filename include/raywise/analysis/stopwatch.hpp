// The one place where the library reads a clock: comparisons time what they have verified.
#pragma once

#include <chrono>
#include <ctime>

namespace raywise {

/// Runs from its construction on. Steady: never goes back when the system's time is set.
class Stopwatch {
public:
    [[nodiscard]] double nanoseconds() const {
        return std::chrono::duration<double, std::nano>(Clock::now() - start_).count();
    }

    [[nodiscard]] double milliseconds() const { return nanoseconds() * 1e-6; }

private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
};

/// The same for the time that the calling thread itself has run: what other programs take from it
/// does not count. The time of a Stopwatch where the system does not tell. To be read by the thread
/// that made it.
class ThreadStopwatch {
public:
    [[nodiscard]] double nanoseconds() const { return now() - start_; }

private:
    [[nodiscard]] double now() const {
#if defined(CLOCK_THREAD_CPUTIME_ID)
        timespec time{};
        if (clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time) == 0)
            return static_cast<double>(time.tv_sec) * 1e9 + static_cast<double>(time.tv_nsec);
#endif
        return wall_.nanoseconds();
    }

    Stopwatch wall_;
    double start_ = now();
};

} // namespace raywise
