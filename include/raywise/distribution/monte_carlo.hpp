// The meaning of every hit measure: the share of drawn rays that meet a box, by counting.
#pragma once

#include <raywise/core/function_ref.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/ray.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>

namespace raywise {

/// A share and the standard deviation of its error.
struct ShareEstimate {
    double share = 0;
    double standard_error = 0; ///< by the rule of Agresti and Coull, so never 0 [Agresti98]
};

struct MonteCarloParams {
    std::size_t samples = 10'000; ///< > 0
    std::uint64_t seed = 1;
};

/// Share of the rays of `draw` that meet the box. Sample i uses Rng(seed, i). Throws Error when no
/// sample is asked for.
[[nodiscard]] ShareEstimate
count_share(FunctionRef<Ray(Rng&)> draw, const Aabb& box, const MonteCarloParams& params = {});

/// The same for anything with `sample(Rng&)`.
template <class Distribution>
    requires requires(const Distribution& distribution, Rng& rng) {
        { distribution.sample(rng) } -> std::same_as<Ray>;
    }
[[nodiscard]] ShareEstimate count_share(
    const Distribution& distribution,
    const Aabb& box,
    const MonteCarloParams& params = {}
) {
    const auto draw = [&distribution](Rng& rng) { return distribution.sample(rng); };
    return count_share(FunctionRef<Ray(Rng&)>(draw), box, params);
}

} // namespace raywise
