// How far a ray that starts inside a convex set surely stays in it.
#pragma once

#include "geometry/round_outward.hpp"

#include <raywise/core/rounding.hpp>

#include <algorithm>
#include <limits>

namespace raywise {

/// The smallest parameter at which one of several affine functions of the ray's parameter, each
/// nonnegative inside, may turn negative. Values and rates come with error bounds, and the bound
/// is taken against the set: too early an exit costs time, too late a one costs correctness.
class ExitBound {
public:
    /// `value` at the origin, changing by `rate` per unit of the parameter.
    void add(double value, double value_error, double rate, double rate_error) {
        const double steepest = rate - rate_error;
        if (!(steepest < 0)) return;
        parameter_ = std::min(parameter_, std::max(0.0, value - value_error) / -steepest);
    }

    /// Rounded down, and by 2 gamma(4) more: a hit's t is itself a rounded float, and must not
    /// exceed this when the exact hit lies beyond the exit.
    [[nodiscard]] float parameter() const {
        return float_below(parameter_ * (1 - 2 * gamma_bound(4, float_epsilon)));
    }

private:
    double parameter_ = std::numeric_limits<double>::infinity();
};

} // namespace raywise
