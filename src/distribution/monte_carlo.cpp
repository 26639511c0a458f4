#include <raywise/distribution/monte_carlo.hpp>

#include <raywise/core/error.hpp>
#include <raywise/core/function_ref.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/ray_box.hpp>

#include <cmath>
#include <cstddef>

namespace raywise {

ShareEstimate
count_share(FunctionRef<Ray(Rng&)> draw, const Aabb& box, const MonteCarloParams& params) {
    if (params.samples == 0) throw Error("a Monte Carlo estimate needs at least one sample");
    std::size_t hits = 0;
    for (std::size_t i = 0; i < params.samples; ++i) {
        Rng rng(params.seed, i);
        if (intersect(draw(rng), box)) ++hits;
    }
    const auto n = static_cast<double>(params.samples);
    const auto k = static_cast<double>(hits);
    // Two more hits and two more misses: no error bar of zero for boxes that (nearly) all or no
    // rays meet.
    const double shifted = (k + 2) / (n + 4);
    return {.share = k / n, .standard_error = std::sqrt(shifted * (1 - shifted) / (n + 4))};
}

} // namespace raywise
