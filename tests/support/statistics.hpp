// Statistical assertions: a quantity that was sampled against the value it must have.
#pragma once

#include <raywise/distribution/monte_carlo.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

namespace raywise::testing {

/// How many standard errors a test with a fixed seed may be off. One in 150 000 correct estimates
/// would be farther off, so a failure is a bug and not bad luck.
inline constexpr double allowed_sigmas = 4.5;

/// Whether a sampled share agrees with the exact one, which may itself be off by `bias`.
inline ::testing::AssertionResult
agrees(const ShareEstimate& sampled, double exact, double bias = 0) {
    const double off = std::abs(sampled.share - exact);
    const double allowed = allowed_sigmas * sampled.standard_error + bias;
    if (off <= allowed) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure()
           << "sampled " << sampled.share << " +- " << sampled.standard_error << ", exact " << exact
           << ", off by " << off << " (allowed " << allowed << ")";
}

/// Mean and standard error of numbers as they come. [Welford62]
class RunningMean {
public:
    void add(double value) {
        ++count_;
        const double step = value - mean_;
        mean_ += step / static_cast<double>(count_);
        squares_ += step * (value - mean_);
    }

    [[nodiscard]] double mean() const { return mean_; }

    /// Of the mean; not a number below two values.
    [[nodiscard]] double standard_error() const {
        const auto n = static_cast<double>(count_);
        return std::sqrt(squares_ / (n - 1) / n);
    }

private:
    std::size_t count_ = 0;
    double mean_ = 0;
    double squares_ = 0;
};

/// Whether a sampled mean agrees with the exact one, up to a `bias`.
inline ::testing::AssertionResult
agrees(const RunningMean& sampled, double exact, double bias = 0) {
    return agrees(ShareEstimate{sampled.mean(), sampled.standard_error()}, exact, bias);
}

} // namespace raywise::testing
