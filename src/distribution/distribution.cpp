#include <raywise/distribution/distribution.hpp>

#include <raywise/core/rng.hpp>
#include <raywise/distribution/any_measure.hpp>
#include <raywise/distribution/measured.hpp>
#include <raywise/distribution/parallel.hpp>
#include <raywise/distribution/radial.hpp>
#include <raywise/distribution/ray_distribution.hpp>
#include <raywise/distribution/uniform.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <string_view>
#include <type_traits>
#include <variant>

namespace raywise {

static_assert(RayDistribution<UniformDistribution> && RayDistribution<ParallelDistribution>);
static_assert(RayDistribution<RadialDistribution> && RayDistribution<MeasuredDistribution>);
static_assert(NarrowableMeasure<ParallelMeasure> && NarrowableMeasure<RadialMeasure>);
static_assert(NarrowableMeasure<MeasuredMeasure>);

AnyMeasure measure_of(const Distribution& distribution, MeasureMode mode) {
    return std::visit(
        [mode](const auto& d) -> AnyMeasure {
            using D = std::remove_cvref_t<decltype(d)>;
            if constexpr (std::is_same_v<D, UniformDistribution>)
                return SurfaceMeasure{};
            else if constexpr (std::is_same_v<D, RadialDistribution>)
                return d.measure(mode);
            else
                return d.measure();
        },
        distribution
    );
}

double hit_probability(const Distribution& distribution, const Aabb& box) {
    return std::visit(
        [&box](const auto& d) { return static_cast<double>(d.measure()(box)); }, distribution
    );
}

Vec3d direction_at(const Distribution& distribution, const Aabb& box) {
    return std::visit([&box](const auto& d) { return d.direction_at(box); }, distribution);
}

Ray sample(const Distribution& distribution, Rng& rng) {
    return std::visit([&rng](const auto& d) { return d.sample(rng); }, distribution);
}

double density(const Distribution& distribution, const Ray& ray) {
    return std::visit([&ray](const auto& d) { return d.density(ray); }, distribution);
}

std::string_view kind_name(const Distribution& distribution) {
    switch (distribution.index()) {
    case 0:
        return "uniform";
    case 1:
        return "parallel";
    case 2:
        return "radial";
    default:
        return "measured";
    }
}

} // namespace raywise
