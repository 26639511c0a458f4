#include "console.hpp"

#include <raywise/core/error.hpp>

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string>
#include <string_view>

namespace raywise::app {

namespace {

constexpr std::size_t line_limit = 300;

/// Nobody is left to be told when standard error itself fails.
void write(const std::string& text) {
    if (std::fputs(text.c_str(), stderr) >= 0) (void)std::fflush(stderr);
}

std::string count_text(double value) {
    if (value >= 1e9) return fmt::format("{:.1f} G", value / 1e9);
    if (value >= 1e6) return fmt::format("{:.1f} M", value / 1e6);
    if (value >= 1e3) return fmt::format("{:.1f} k", value / 1e3);
    return fmt::format("{:.0f} ", value);
}

std::string time_text(double seconds) {
    const auto whole = static_cast<std::uint64_t>(std::llround(seconds));
    if (whole >= 3600)
        return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
    return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

bool wants_color() {
    // NOLINTNEXTLINE(concurrency-mt-unsafe): read once, nothing here writes the environment.
    const char* no_color = std::getenv("NO_COLOR");
    return no_color == nullptr || *no_color == '\0';
}

} // namespace

Console::Console(bool quiet)
    : is_terminal_(::isatty(STDERR_FILENO) == 1)
    , has_color_(is_terminal_ && wants_color())
    , is_quiet_(quiet) {}

Console::~Console() {
    erase_progress();
}

void Console::set_quiet(bool quiet) {
    const std::scoped_lock lock(mutex_);
    is_quiet_ = quiet;
}

void Console::message(std::string_view text) {
    const std::scoped_lock lock(mutex_);
    if (is_quiet_) return;
    erase_progress();
    write(escaped(text, line_limit - 1) + "\n");
}

void Console::error(std::string_view text) {
    const std::scoped_lock lock(mutex_);
    erase_progress();
    const std::string name = has_color_ ? "\033[1;31mraywise:\033[0m " : "raywise: ";
    write(name + escaped(text, line_limit - 1 - std::string_view("raywise: ").size()) + "\n");
}

void Console::progress(std::string_view stage, std::uint64_t done, std::uint64_t total) {
    if (!is_terminal_) return;
    const std::scoped_lock lock(mutex_);
    if (is_quiet_) return;
    const auto now = Clock::now();
    if (stage != stage_) {
        stage_ = stage;
        stage_start_ = now;
        stage_first_ = done;
    } else if (now - last_shown_ < std::chrono::milliseconds(100)) {
        return;
    }
    last_shown_ = now;

    const double seconds = std::chrono::duration<double>(now - stage_start_).count();
    const double rate =
        seconds > 0 ? static_cast<double>(done - std::min(done, stage_first_)) / seconds : 0;
    std::string line = escaped(stage, 60);
    if (total > 0) line += fmt::format("  {} %", 100 * std::min(done, total) / total);
    if (rate > 0) line += fmt::format("  {}/s", count_text(rate));
    if (rate > 0 && total > done)
        line += "  ETA " + time_text(static_cast<double>(total - done) / rate);
    write("\r\033[K" + line);
    is_progress_shown_ = true;
}

void Console::erase_progress() {
    if (is_progress_shown_) write("\r\033[K");
    is_progress_shown_ = false;
}

} // namespace raywise::app
