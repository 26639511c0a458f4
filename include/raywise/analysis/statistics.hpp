// Summaries of repeated measurements: means, percentiles, ratios and how far to trust them.
// After [Student08] for the intervals, [Fleming86] for geometric means of ratios.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace raywise {

/// Five numbers that describe a sample. All 0 for an empty one.
struct Summary {
    std::size_t count = 0;
    double mean = 0;
    double median = 0;
    double percentile_95 = 0;
    double min = 0;
    double max = 0;
};

/// A mean and the half width of its 95 % confidence interval over independent repetitions. The half
/// width is +inf for fewer than two repetitions: one number says nothing about its spread.
struct ConfidenceInterval {
    double mean = 0;
    double half_width = 0;

    [[nodiscard]] double low() const { return mean - half_width; }

    [[nodiscard]] double high() const { return mean + half_width; }
};

/// Arithmetic mean; 0 for no values. Compensated summation, so that the order hardly matters.
[[nodiscard]] double mean(std::span<const double> values);

/// Middle value, or the mean of the two middle ones; 0 for no values. O(n).
[[nodiscard]] double median(std::span<const double> values);

/// The value below which `percent` % of the sample lies, linearly interpolated between neighbors
/// (0: the smallest, 100: the largest). `percent` in [0, 100]; throws Error otherwise. 0 for no
/// values.
[[nodiscard]] double percentile(std::span<const double> values, double percent);

/// All five numbers in O(n log n).
[[nodiscard]] Summary summarize(std::span<const double> values);

/// The n-th root of the product: the only mean of ratios that does not depend on which side is the
/// base. Values must be > 0 and finite; throws Error otherwise. 1 for no values. [Fleming86]
[[nodiscard]] double geometric_mean(std::span<const double> values);

/// Mean and 95 % interval of the mean, by Student's t over the values. [Student08]
[[nodiscard]] ConfidenceInterval confidence_95(std::span<const double> values);

/// The same on a logarithmic scale, for ratios: `mean` is the geometric mean and `half_width` the
/// larger distance from it to an end of the interval. Values as for `geometric_mean`.
[[nodiscard]] ConfidenceInterval confidence_95_of_ratios(std::span<const double> ratios);

/// candidate[i] / baseline[i]: ratios of measurements taken on the same rays. Throws Error when the
/// lengths differ or a baseline value is not > 0.
[[nodiscard]] std::vector<double>
paired_ratios(std::span<const double> candidate, std::span<const double> baseline);

/// The number that a Student t variable of `degrees` >= 1 degrees of freedom stays below with
/// probability 0.975. Relative error below 1e-4.
[[nodiscard]] double student_t_975(std::size_t degrees);

} // namespace raywise
