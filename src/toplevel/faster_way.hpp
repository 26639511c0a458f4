// Two ways to the same answers: which one is faster is found by taking both.
#pragma once

#include <raywise/core/executor.hpp>

#include <array>
#include <chrono>
#include <cstddef>

namespace raywise::detail {

/// Answers the questions [0, count), each by a call of `first` or `second` with (begin, end,
/// executor), whose answers must be the same. Both answer the same few of them, from all over the
/// batch and in series, until one has clearly taken less time; that one answers all others. Only
/// `first` when there are too few to find out.
template <class First, class Second>
void take_faster_way(
    std::size_t count,
    const Executor& executor,
    const First& first,
    const Second& second
) {
    constexpr std::size_t parts = 8;
    constexpr std::size_t part = 128;
    constexpr std::size_t worthwhile = 32 * parts * part;
    if (count < worthwhile) return first(std::size_t{0}, count, executor);

    const auto begin_of = [&](std::size_t i) { return i < parts ? count / parts * i : count; };
    const auto time_of = [&](const auto& way, std::size_t begin) {
        const auto start = std::chrono::steady_clock::now();
        way(begin, begin + part, serial_executor());
        return std::chrono::steady_clock::now() - start;
    };
    std::chrono::steady_clock::duration by_first{};
    std::chrono::steady_clock::duration by_second{};
    std::array<bool, parts> is_tried{};
    for (std::size_t k = 0; k < parts; ++k) {
        // From the middle on: the first rays of a view may all see the sky.
        const std::size_t i = (parts / 2 + 3 * k) % parts;
        is_tried[i] = true;
        // The one that comes second may find something in the cache.
        if (k % 2 != 0) by_first += time_of(first, begin_of(i));
        by_second += time_of(second, begin_of(i));
        if (k % 2 == 0) by_first += time_of(first, begin_of(i));
        if (by_first > 2 * by_second || by_second > 2 * by_first) break;
    }
    for (std::size_t i = 0; i < parts; ++i) {
        const std::size_t begin = begin_of(i) + (is_tried[i] ? part : 0);
        if (by_first <= by_second)
            first(begin, begin_of(i + 1), executor);
        else
            second(begin, begin_of(i + 1), executor);
    }
}

} // namespace raywise::detail
