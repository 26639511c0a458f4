#include <raywise/analysis/estimated_cost.hpp>

#include <cmath>
#include <limits>

namespace raywise {

double estimate_error(double real, double estimated) {
    if (estimated == 0) return real == 0 ? 0 : std::numeric_limits<double>::infinity();
    return std::abs(real - estimated) / std::abs(estimated);
}

} // namespace raywise
