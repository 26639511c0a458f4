#include <raywise/analysis/statistics.hpp>

#include <raywise/core/error.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace raywise {
namespace {

/// Integral of the t density from 0 to `end`, by Simpson's rule.
double probability_up_to(double end, double degrees) {
    const double constant = std::exp(std::lgamma((degrees + 1) / 2) - std::lgamma(degrees / 2)) /
                            std::sqrt(degrees * std::numbers::pi);
    const auto density = [&](double t) {
        return constant * std::pow(1 + t * t / degrees, -(degrees + 1) / 2);
    };
    const int steps = 20000;
    const double h = end / steps;
    double sum = density(0) + density(end);
    for (int i = 1; i < steps; ++i)
        sum += (i % 2 == 1 ? 4 : 2) * density(i * h);
    return sum * h / 3;
}

TEST(Statistics, OfNothingAreZero) {
    EXPECT_EQ(mean({}), 0);
    EXPECT_EQ(median({}), 0);
    EXPECT_EQ(percentile({}, 95), 0);
    EXPECT_EQ(summarize({}).count, 0U);
    EXPECT_EQ(geometric_mean({}), 1);
}

TEST(Mean, KeepsSmallValuesBesideLargeOnes) {
    const std::array values{1e16, 1.0, 1.0, -1e16};
    EXPECT_DOUBLE_EQ(mean(values), 0.5);
}

TEST(Median, TakesTheMiddleOfOddAndEvenSamplesInAnyOrder) {
    EXPECT_EQ(median(std::array{3.0, 1.0, 2.0}), 2);
    EXPECT_EQ(median(std::array{4.0, 1.0, 3.0, 2.0}), 2.5);
}

TEST(Percentile, InterpolatesBetweenNeighborsAndRefusesWhatIsNoPercentage) {
    const std::array values{0.0, 10.0, 20.0, 30.0};
    EXPECT_DOUBLE_EQ(percentile(values, 0), 0);
    EXPECT_DOUBLE_EQ(percentile(values, 100), 30);
    EXPECT_DOUBLE_EQ(percentile(values, 50), 15);
    EXPECT_DOUBLE_EQ(percentile(values, 95), 28.5);
    EXPECT_THROW((void)percentile(values, 101), Error);
    EXPECT_THROW((void)percentile(values, std::nan("")), Error);
}

TEST(Summarize, AgreesWithTheSingleFunctions) {
    const std::array values{5.0, 1.0, 4.0, 2.0, 9.0};
    const Summary all = summarize(values);
    EXPECT_EQ(all.count, 5U);
    EXPECT_DOUBLE_EQ(all.mean, mean(values));
    EXPECT_DOUBLE_EQ(all.median, median(values));
    EXPECT_DOUBLE_EQ(all.percentile_95, percentile(values, 95));
    EXPECT_EQ(all.min, 1);
    EXPECT_EQ(all.max, 9);
}

TEST(GeometricMean, DoesNotDependOnTheBase) {
    const std::array ratios{0.5, 4.0, 1.0};
    const std::array inverse{2.0, 0.25, 1.0};
    EXPECT_DOUBLE_EQ(geometric_mean(ratios), std::cbrt(2.0));
    EXPECT_NEAR(geometric_mean(ratios) * geometric_mean(inverse), 1, 1e-15);
    EXPECT_THROW((void)geometric_mean(std::array{1.0, 0.0}), Error);
}

TEST(StudentT, QuantileHoldsTheMiddle95PercentOfTheDensity) {
    for (const std::size_t degrees : {1U, 2U, 3U, 4U, 5U, 9U, 10U, 11U, 12U, 20U, 100U, 1000U}) {
        const double t = student_t_975(degrees);
        EXPECT_NEAR(probability_up_to(t, static_cast<double>(degrees)), 0.475, 2e-6) << degrees;
    }
}

TEST(Confidence, OfFiveValuesIsTheTextbookInterval) {
    const std::array values{1.0, 2.0, 3.0, 4.0, 5.0};
    const ConfidenceInterval interval = confidence_95(values);
    EXPECT_DOUBLE_EQ(interval.mean, 3);
    EXPECT_NEAR(interval.half_width, 2.776445 * std::sqrt(2.5 / 5), 1e-12);
}

TEST(Confidence, OfOneValueIsUnbounded) {
    EXPECT_TRUE(std::isinf(confidence_95(std::array{7.0}).half_width));
}

TEST(ConfidenceOfRatios, IsSymmetricUnderExchangeOfTheSides) {
    const ConfidenceInterval there = confidence_95_of_ratios(std::array{0.8, 0.9, 0.85});
    const ConfidenceInterval back = confidence_95_of_ratios(std::array{1 / 0.8, 1 / 0.9, 1 / 0.85});
    EXPECT_NEAR(there.mean * back.mean, 1, 1e-12);
}

TEST(PairedRatios, DivideElementByElementAndRefuseUnequalLengths) {
    const std::vector<double> ratios = paired_ratios(std::array{2.0, 9.0}, std::array{4.0, 3.0});
    EXPECT_EQ(ratios, (std::vector{0.5, 3.0}));
    EXPECT_THROW((void)paired_ratios(std::array{1.0}, std::array{1.0, 2.0}), Error);
    EXPECT_THROW((void)paired_ratios(std::array{1.0}, std::array{0.0}), Error);
}

} // namespace
} // namespace raywise
