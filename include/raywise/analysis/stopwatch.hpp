// The one place where the library reads a clock: comparisons time what they have verified.
#pragma once

#include <chrono>

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

} // namespace raywise
