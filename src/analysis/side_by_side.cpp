#include <raywise/analysis/side_by_side.hpp>

#include <raywise/analysis/statistics.hpp>
#include <raywise/analysis/stopwatch.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/function_ref.hpp>

#include <span>
#include <vector>

namespace raywise {

namespace {

template <class Watch>
double nanoseconds_of(FunctionRef<void()> pass) {
    const Watch watch;
    pass();
    return watch.nanoseconds();
}

double nanoseconds_of(FunctionRef<void()> pass, TimedBy timed_by) {
    return timed_by == TimedBy::thread ? nanoseconds_of<ThreadStopwatch>(pass)
                                       : nanoseconds_of<Stopwatch>(pass);
}

} // namespace

SideBySide summarize_rounds(std::span<const double> first_ns, std::span<const double> second_ns) {
    if (first_ns.empty()) throw Error("side by side: nothing was timed");
    const std::vector<double> ratios = paired_ratios(second_ns, first_ns);
    const double middle = median(ratios);
    return {
        .rounds = static_cast<int>(first_ns.size()),
        .first_ns = median(first_ns),
        .second_ns = median(second_ns),
        .ratio = middle,
        .spread = (percentile(ratios, 75) - percentile(ratios, 25)) / 2 / middle,
    };
}

SideBySide time_side_by_side(
    FunctionRef<void()> first,
    FunctionRef<void()> second,
    const SideBySideParams& params
) {
    if (params.min_rounds < 1 || params.max_rounds < params.min_rounds)
        throw Error("side by side: rounds must be at least 1, min_rounds at most max_rounds");
    if (!(params.budget_ms >= 0)) throw Error("side by side: budget_ms must not be negative");
    first();
    second();
    std::vector<double> first_ns;
    std::vector<double> second_ns;
    const Stopwatch total;
    for (int round = 0; round < params.max_rounds; ++round) {
        if (round >= params.min_rounds && total.milliseconds() >= params.budget_ms) break;
        if (round % 2 == 0) {
            first_ns.push_back(nanoseconds_of(first, params.timed_by));
            second_ns.push_back(nanoseconds_of(second, params.timed_by));
        } else {
            second_ns.push_back(nanoseconds_of(second, params.timed_by));
            first_ns.push_back(nanoseconds_of(first, params.timed_by));
        }
    }
    return summarize_rounds(first_ns, second_ns);
}

} // namespace raywise
