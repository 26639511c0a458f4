// Two ways to the same answers: which one is faster is found by taking both.
#pragma once

#include <raywise/core/executor.hpp>

#include <array>
#include <chrono>
#include <cstddef>

namespace raywise::detail {

/// Answers the questions [0, count), each by a call of `first` or `second` with (begin, end,
/// executor), whose answers must be the same. Both answer the same few of them, from all over the
/// batch and in series; the one that took less time answers all others. Only `first` when there are
/// too few to find out.
template <class First, class Second>
void take_faster_way(
    std::size_t count,
    const Executor& executor,
    const First& first,
    const Second& second
) {
    constexpr std::size_t parts = 8;
    constexpr std::size_t part = 128;
    constexpr std::size_t worthwhile = 16 * parts * part;
    if (count < worthwhile) return first(std::size_t{0}, count, executor);

    using Clock = std::chrono::steady_clock;
    std::array<Clock::duration, 2> taken{};
    const auto begin_of = [&](std::size_t i) { return count / parts * i; };
    for (std::size_t i = 0; i < 2 * parts; ++i) {
        const std::size_t begin = begin_of(i / 2);
        // The one that comes second may find something in the cache.
        const bool is_first = (i % 4 == 0) || (i % 4 == 3);
        const Clock::time_point start = Clock::now();
        if (is_first)
            first(begin, begin + part, serial_executor());
        else
            second(begin, begin + part, serial_executor());
        taken[is_first ? 0 : 1] += Clock::now() - start;
    }
    for (std::size_t i = 0; i < parts; ++i) {
        const std::size_t begin = begin_of(i) + part;
        const std::size_t end = i + 1 < parts ? begin_of(i + 1) : count;
        if (taken[0] <= taken[1])
            first(begin, end, executor);
        else
            second(begin, end, executor);
    }
}

} // namespace raywise::detail
