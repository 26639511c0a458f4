#include <raywise/analysis/statistics.hpp>

#include <raywise/core/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace raywise {

namespace {

double interpolate(std::span<const double> sorted, double percent) {
    const double place = percent / 100 * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    if (below + 1 >= sorted.size()) return sorted.back();
    const double share = place - static_cast<double>(below);
    return sorted[below] + share * (sorted[below + 1] - sorted[below]);
}

std::vector<double> logarithms(std::span<const double> ratios) {
    std::vector<double> logs;
    logs.reserve(ratios.size());
    for (const double ratio : ratios) {
        if (!(ratio > 0) || !std::isfinite(ratio)) {
            throw Error("a geometric mean needs positive finite values");
        }
        logs.push_back(std::log(ratio));
    }
    return logs;
}

} // namespace

double mean(std::span<const double> values) {
    if (values.empty()) return 0;
    double sum = 0;
    double lost = 0;
    for (const double value : values) {
        const double next = sum + value;
        lost += std::abs(sum) >= std::abs(value) ? (sum - next) + value : (value - next) + sum;
        sum = next;
    }
    return (sum + lost) / static_cast<double>(values.size());
}

double median(std::span<const double> values) {
    if (values.empty()) return 0;
    std::vector<double> copy(values.begin(), values.end());
    const auto middle = copy.begin() + static_cast<std::ptrdiff_t>(copy.size() / 2);
    std::nth_element(copy.begin(), middle, copy.end());
    if (copy.size() % 2 == 1) return *middle;
    return (*middle + *std::max_element(copy.begin(), middle)) / 2;
}

double percentile(std::span<const double> values, double percent) {
    if (!(percent >= 0 && percent <= 100)) throw Error("a percentile must be in [0, 100]");
    if (values.empty()) return 0;
    std::vector<double> sorted(values.begin(), values.end());
    std::sort(sorted.begin(), sorted.end());
    return interpolate(sorted, percent);
}

Summary summarize(std::span<const double> values) {
    if (values.empty()) return {};
    std::vector<double> sorted(values.begin(), values.end());
    std::sort(sorted.begin(), sorted.end());
    return {
        .count = sorted.size(),
        .mean = mean(sorted),
        .median = interpolate(sorted, 50),
        .percentile_95 = interpolate(sorted, 95),
        .min = sorted.front(),
        .max = sorted.back()
    };
}

double geometric_mean(std::span<const double> values) {
    return std::exp(mean(logarithms(values)));
}

ConfidenceInterval confidence_95(std::span<const double> values) {
    const double center = mean(values);
    if (values.size() < 2) return {center, std::numeric_limits<double>::infinity()};
    double squares = 0;
    for (const double value : values)
        squares += (value - center) * (value - center);
    const auto count = static_cast<double>(values.size());
    const double error_of_mean = std::sqrt(squares / (count - 1) / count);
    return {center, student_t_975(values.size() - 1) * error_of_mean};
}

ConfidenceInterval confidence_95_of_ratios(std::span<const double> ratios) {
    const ConfidenceInterval logs = confidence_95(logarithms(ratios));
    const double center = std::exp(logs.mean);
    return {center, std::exp(logs.high()) - center};
}

std::vector<double>
paired_ratios(std::span<const double> candidate, std::span<const double> baseline) {
    if (candidate.size() != baseline.size()) throw Error("paired samples must have equal length");
    std::vector<double> ratios;
    ratios.reserve(candidate.size());
    for (std::size_t i = 0; i < candidate.size(); ++i) {
        if (!(baseline[i] > 0)) throw Error("a ratio needs a positive base");
        ratios.push_back(candidate[i] / baseline[i]);
    }
    return ratios;
}

double student_t_975(std::size_t degrees) {
    constexpr std::array table{
        12.706205,
        4.302653,
        3.182446,
        2.776445,
        2.570582,
        2.446912,
        2.364624,
        2.306004,
        2.262157,
        2.228139
    };
    if (degrees == 0) throw Error("Student's t needs at least one degree of freedom");
    if (degrees <= table.size()) return table[degrees - 1];
    // The expansion in 1 / degrees about the normal quantile [Abramowitz64, 26.7.5].
    const double z = 1.959963984540054;
    const double z2 = z * z;
    const auto n = static_cast<double>(degrees);
    const double g1 = z * (z2 + 1) / 4;
    const double g2 = z * ((5 * z2 + 16) * z2 + 3) / 96;
    const double g3 = z * (((3 * z2 + 19) * z2 + 17) * z2 - 15) / 384;
    const double g4 = z * ((((79 * z2 + 776) * z2 + 1482) * z2 - 1920) * z2 - 945) / 92160;
    return z + (g1 + (g2 + (g3 + g4 / n) / n) / n) / n;
}

} // namespace raywise
