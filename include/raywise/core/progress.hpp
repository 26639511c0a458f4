// How long work tells where it is and learns that it should stop.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <stop_token>
#include <string_view>

namespace raywise {

/// Thrown out of long work after its stop token was triggered. Results are dropped, nothing is
/// half-written.
class Cancelled : public std::exception {
public:
    [[nodiscard]] const char* what() const noexcept override { return "cancelled"; }
};

/// An argument of long work. The default reports to nobody and never stops.
struct Progress {
    /// Called from the working thread after each step; `total` 0 means unknown. Must not throw.
    std::function<void(std::string_view stage, std::uint64_t done, std::uint64_t total)> on_step;
    std::stop_token stop;

    /// Reports a step. Throws Cancelled when a stop was requested.
    void step(std::string_view stage, std::uint64_t done, std::uint64_t total) const {
        if (stop.stop_requested()) throw Cancelled();
        if (on_step) on_step(stage, done, total);
    }
};

} // namespace raywise
