// Doubles to floats with the rounding direction chosen, and sums that know their own error.
// After [Higham02], section 3.3.
#pragma once

#include <cmath>
#include <limits>

namespace raywise {

/// The largest float <= value; the largest finite one for huge values; NaN for NaN.
[[nodiscard]] inline float float_below(double value) {
    constexpr float largest = std::numeric_limits<float>::max();
    if (value >= static_cast<double>(largest)) return std::isinf(value) ? HUGE_VALF : largest;
    if (value < -static_cast<double>(largest)) return -HUGE_VALF;
    const auto nearest = static_cast<float>(value);
    return static_cast<double>(nearest) > value ? std::nextafter(nearest, -HUGE_VALF) : nearest;
}

/// The smallest float >= value.
[[nodiscard]] inline float float_above(double value) {
    return -float_below(-value);
}

/// A sum of products together with a bound of its rounding error. Exact operations add nothing to
/// the bound, so that aligned regions with round coordinates have tight float boxes.
class TrackedSum {
public:
    explicit TrackedSum(double start) : value_(start) {}

    void add(double a, double b) {
        const double product = a * b;
        const double sum = value_ + product;
        const double part = sum - value_; // the two-sum of Knuth: what rounding took away
        error_ += std::abs(std::fma(a, b, -product)) +
                  std::abs((value_ - (sum - part)) + (product - part));
        value_ = sum;
    }

    /// For an error made before: `amount` is known up to `error`.
    void widen(double error) { error_ += std::abs(error); }

    [[nodiscard]] float below() const { return float_below(error_ > 0 ? lower() : value_); }

    [[nodiscard]] float above() const { return float_above(error_ > 0 ? upper() : value_); }

private:
    // Twice the error and one step more: the error is itself rounded.
    [[nodiscard]] double lower() const { return std::nextafter(value_ - 2 * error_, -HUGE_VAL); }

    [[nodiscard]] double upper() const { return std::nextafter(value_ + 2 * error_, HUGE_VAL); }

    double value_;
    double error_ = 0;
};

} // namespace raywise
