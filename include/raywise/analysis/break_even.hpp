// When the two-level structure pays: the share of rays it must answer alone, and the rays it takes
// to earn back its build. The thesis prints the first with the wrong sign; this is the corrected
// form of [Falcone24].
#pragma once

#include <optional>

namespace raywise {

/// Mean costs per ray, in any one unit (box tests, nanoseconds).
struct TwoLevelCosts {
    double local = 0;        ///< of searching the local structure; over all rays
    double continuation = 0; ///< of the global structure, over the rays that still need it
    double global = 0;       ///< of the global structure alone; over all rays
};

/// The share of rays that must be answered by the local structure alone for the pair to cost as
/// much as the global structure alone: local + (1 - h) continuation = global. It pays for every
/// larger share. Above 1 it can never pay, below 0 it always does. nullopt when continuing costs
/// nothing: then the share is irrelevant.
[[nodiscard]] std::optional<double> break_even_hit_fraction(const TwoLevelCosts& costs);

/// The share when a continuation is assumed to cost as much as a whole global query (the thesis's
/// restart): local / global. nullopt when global is 0.
[[nodiscard]] std::optional<double> break_even_hit_fraction_of_restart(const TwoLevelCosts& costs);

/// Cost per ray of the pair when a share `hit_fraction` of the rays needs no continuation.
[[nodiscard]] double two_level_cost(const TwoLevelCosts& costs, double hit_fraction);

/// The number of rays after which a build that takes `extra_build_ns` longer has been earned back
/// by rays that take `candidate_ns` in place of `baseline_ns` each. 0 when it is ahead from the
/// start, nullopt when it never gets ahead.
[[nodiscard]] std::optional<double>
break_even_rays(double extra_build_ns, double baseline_ns, double candidate_ns);

} // namespace raywise
