// Times queries side by side: A B A B over the same rays, so that a slow moment hits all alike.
#pragma once

#include <raywise/analysis/statistics.hpp>
#include <raywise/analysis/stopwatch.hpp>
#include <raywise/core/function_ref.hpp>
#include <raywise/geometry/ray.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace raywise::detail {

/// Something that traces all of the rays and returns the sum of the ids it hit, so that no
/// compiler may leave the work out.
using TimedPass = FunctionRef<std::uint64_t(std::span<const Ray>)>;

template <class Query>
std::uint64_t trace_all(std::span<const Ray> rays, const Query& query) {
    std::uint64_t sum = 0;
    for (const Ray& ray : rays) {
        const std::optional<Hit> hit = query(ray);
        if (hit) sum += to_index(hit->prim) + 1;
    }
    return sum;
}

/// Median nanoseconds per ray of each pass over `repeats` rounds, after a warm-up round. `sums`
/// receives what the passes returned. Not empty rays.
inline std::vector<double> time_interleaved(
    std::span<const TimedPass> passes,
    std::span<const Ray> rays,
    int repeats,
    std::vector<std::uint64_t>& sums
) {
    sums.clear();
    for (const TimedPass& pass : passes)
        sums.push_back(pass(rays)); // warms caches and clocks
    std::vector<std::vector<double>> times(passes.size());
    for (int round = 0; round < repeats; ++round) {
        for (std::size_t i = 0; i < passes.size(); ++i) {
            const Stopwatch watch;
            const std::uint64_t sum = passes[i](rays);
            times[i].push_back(watch.nanoseconds() / static_cast<double>(rays.size()));
            if (sum != sums[i]) sums[i] = 0; // never equal to a right sum; the caller notices
        }
    }
    std::vector<double> medians;
    medians.reserve(times.size());
    for (const std::vector<double>& of_pass : times)
        medians.push_back(median(of_pass));
    return medians;
}

} // namespace raywise::detail
