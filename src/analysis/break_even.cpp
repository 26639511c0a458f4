#include <raywise/analysis/break_even.hpp>

#include <optional>

namespace raywise {

std::optional<double> break_even_hit_fraction(const TwoLevelCosts& costs) {
    if (!(costs.continuation > 0)) return std::nullopt;
    return (costs.local + costs.continuation - costs.global) / costs.continuation;
}

std::optional<double> break_even_hit_fraction_of_restart(const TwoLevelCosts& costs) {
    if (!(costs.global > 0)) return std::nullopt;
    return costs.local / costs.global;
}

double two_level_cost(const TwoLevelCosts& costs, double hit_fraction) {
    return costs.local + (1 - hit_fraction) * costs.continuation;
}

std::optional<double>
break_even_rays(double extra_build_ns, double baseline_ns, double candidate_ns) {
    const double saving = baseline_ns - candidate_ns;
    if (extra_build_ns <= 0 && saving >= 0) return 0;
    if (!(saving > 0)) return std::nullopt;
    return extra_build_ns / saving;
}

} // namespace raywise
