// The closed set of ray distributions behind one set of questions. [Falcone24]
#pragma once

#include <raywise/core/rng.hpp>
#include <raywise/distribution/any_measure.hpp>
#include <raywise/distribution/measured.hpp>
#include <raywise/distribution/parallel.hpp>
#include <raywise/distribution/radial.hpp>
#include <raywise/distribution/ray_distribution.hpp>
#include <raywise/distribution/uniform.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <string_view>
#include <variant>

namespace raywise {

using Distribution = std::
    variant<UniformDistribution, ParallelDistribution, RadialDistribution, MeasuredDistribution>;

/// The measure that a builder minimizes. Absolute probabilities, but for uniform lines the plain
/// surface area, of which only ratios matter (UniformDistribution::measure is the absolute one).
[[nodiscard]] AnyMeasure
measure_of(const Distribution& distribution, MeasureMode mode = MeasureMode::exact);

/// Probability, in [0, 1], that a drawn ray meets the box: absolute for every distribution.
[[nodiscard]] double hit_probability(const Distribution& distribution, const Aabb& box);

/// Direction of the rays at a box, see RayDistribution.
[[nodiscard]] Vec3d direction_at(const Distribution& distribution, const Aabb& box);

[[nodiscard]] Ray sample(const Distribution& distribution, Rng& rng);

[[nodiscard]] double density(const Distribution& distribution, const Ray& ray);

/// "uniform", "parallel", "radial" or "measured".
[[nodiscard]] std::string_view kind_name(const Distribution& distribution);

} // namespace raywise
