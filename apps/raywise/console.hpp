// What the program says on standard error: messages, one line per error, and progress on a
// terminal.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

namespace raywise::app {

/// Safe to use from several threads.
class Console {
public:
    /// `quiet` leaves errors only.
    explicit Console(bool quiet = false);
    ~Console();
    Console(const Console&) = delete;
    Console& operator=(const Console&) = delete;
    Console(Console&&) = delete;
    Console& operator=(Console&&) = delete;

    void set_quiet(bool quiet);

    /// One line about what was done; escaped, at most 300 bytes.
    void message(std::string_view text);

    /// "raywise: " and the text as one line of at most 300 bytes, control characters escaped.
    void error(std::string_view text);

    /// Shows stage, share, rate and time left on one line that it overwrites, ten times a second at
    /// most; nothing unless standard error is a terminal. `total` 0: unknown.
    void progress(std::string_view stage, std::uint64_t done, std::uint64_t total);

private:
    using Clock = std::chrono::steady_clock;

    void erase_progress();

    std::mutex mutex_;
    bool is_terminal_;
    bool has_color_;
    bool is_quiet_;
    bool is_progress_shown_ = false;
    std::string stage_;
    Clock::time_point stage_start_;
    std::uint64_t stage_first_ = 0; ///< `done` at its start
    Clock::time_point last_shown_;
};

} // namespace raywise::app
