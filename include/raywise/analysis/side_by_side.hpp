// Two ways to do the same work, timed side by side: A B A B, so that a slow moment of the machine
// hits both alike; what counts is the ratio within a pair.
#pragma once

#include <raywise/core/function_ref.hpp>

#include <cstdint>
#include <span>

namespace raywise {

/// Whose time counts.
enum class TimedBy : std::uint8_t {
    wall,  ///< everybody's: passes that use several threads
    thread ///< the calling thread's own: what other programs take from it does not count
};

struct SideBySideParams {
    int min_rounds = 3;     ///< timed pairs, at least; >= 1
    int max_rounds = 21;    ///< at most; >= min_rounds
    double budget_ms = 500; ///< no further round is started after this much wall time; >= 0
    TimedBy timed_by = TimedBy::wall;
};

/// What the rounds gave.
struct SideBySide {
    int rounds = 0;
    double first_ns = 0;  ///< median of one pass
    double second_ns = 0; ///< median of one pass
    double ratio = 0;     ///< median over the rounds of second_ns / first_ns: above 1 the first won
    double spread = 0;    ///< half the interquartile range of those ratios, over their median
};

/// Runs both once to warm up, then in turn; every other round begins with the second, so that
/// neither always finds the other's leavings in the caches. Throws Error for parameters out of
/// range.
[[nodiscard]] SideBySide time_side_by_side(
    FunctionRef<void()> first,
    FunctionRef<void()> second,
    const SideBySideParams& params = {}
);

/// The summary of rounds that were timed: nanoseconds of each pass, all > 0, pairwise. Throws Error
/// when the sizes differ or nothing was timed.
[[nodiscard]] SideBySide
summarize_rounds(std::span<const double> first_ns, std::span<const double> second_ns);

} // namespace raywise
