#include <raywise/analysis/memory_speed.hpp>

#include <raywise/analysis/stopwatch.hpp>
#include <raywise/core/large_buffer.hpp>
#include <raywise/core/rng.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

namespace raywise {

namespace {

constexpr int runs = 5;

struct alignas(64) Line {
    std::uint32_t next;
    std::uint32_t rest[15];
};

static_assert(sizeof(Line) == 64, "a cache line");

std::size_t lines_in(std::size_t bytes) {
    constexpr std::size_t least = 64;
    constexpr std::size_t most = std::numeric_limits<std::uint32_t>::max();
    return std::clamp(bytes / sizeof(Line), least, most);
}

/// One cycle through all lines in random order (Sattolo's shuffle).
void make_cycle(const LargeBuffer<Line>& lines, std::size_t count, std::uint64_t seed) {
    for (std::size_t i = 0; i < count; ++i)
        lines[i] = {static_cast<std::uint32_t>(i), {}};
    Rng rng(seed);
    for (std::size_t i = count - 1; i > 0; --i)
        std::swap(lines[i].next, lines[rng.below(i)].next);
}

} // namespace

double measure_load_ns(std::size_t bytes, std::uint64_t seed) {
    const std::size_t count = lines_in(bytes);
    const LargeBuffer<Line> lines(count);
    make_cycle(lines, count, seed);
    constexpr std::size_t loads = 1U << 16U;
    double least = std::numeric_limits<double>::infinity();
    std::uint32_t at = 0;
    for (int run = 0; run < runs; ++run) {
        const ThreadStopwatch watch;
        for (std::size_t i = 0; i < loads; ++i)
            at = lines[at].next;
        // Asking where the walk ended keeps it from being left out.
        const double time = watch.nanoseconds() + (at == count ? 1 : 0);
        least = std::min(least, time / static_cast<double>(loads));
    }
    return least;
}

double measure_stream_gb_per_s(std::size_t bytes) {
    const std::size_t count = lines_in(bytes) * (sizeof(Line) / sizeof(std::uint64_t));
    const LargeBuffer<std::uint64_t> words(count);
    std::fill_n(words.get(), count, std::uint64_t{1});
    constexpr std::size_t least_bytes = 1U << 24U;
    const std::size_t passes = 1 + least_bytes / (count * sizeof(std::uint64_t));
    double best = 0;
    for (int run = 0; run < runs; ++run) {
        std::uint64_t sum = 0;
        const ThreadStopwatch watch;
        for (std::size_t pass = 0; pass < passes; ++pass)
            sum += std::accumulate(words.get(), words.get() + count, std::uint64_t{pass});
        const double time = watch.nanoseconds() + (sum == 0 ? 1 : 0);
        best = std::max(best, static_cast<double>(passes * count * sizeof(std::uint64_t)) / time);
    }
    return best;
}

} // namespace raywise
