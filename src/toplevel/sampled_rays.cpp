#include "toplevel/sampled_rays.hpp"

#include <raywise/core/ids.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/distribution/parallel.hpp>
#include <raywise/distribution/radial.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/region.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

namespace raywise::detail {
namespace {

Ray sample_inside(const InfluenceArea& area, const Region& wide, Rng& rng) {
    Ray ray = sample(area.distribution, rng);
    const double way = rng.uniform_double();
    if (!contains(wide, to_double(ray.origin))) return ray;
    const auto exit = static_cast<double>(std::min(exit_parameter(wide, ray), ray.t_max));
    const Vec3d start = to_double(ray.origin) + to_double(ray.direction) * (way * exit);
    if (is_finite(start)) ray.origin = to_float(start);
    return ray;
}

Vec3 point_on(const Triangle& triangle, Rng& rng) {
    float v = rng.uniform();
    float w = rng.uniform();
    if (v + w > 1) {
        v = 1 - v;
        w = 1 - w;
    }
    return triangle.v0 + (triangle.v1 - triangle.v0) * v + (triangle.v2 - triangle.v0) * w;
}

} // namespace

std::vector<Ray> sampled_rays(const InfluenceArea& area, std::size_t count, std::uint64_t seed) {
    const Region wide = inflated(area.region, 1e-3 * diameter(area.region));
    std::vector<Ray> rays;
    rays.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        Rng rng(seed, i);
        rays.push_back(sample_inside(area, wide, rng));
    }
    return rays;
}

std::vector<Ray> sampled_shadow_rays(
    const InfluenceArea& area,
    const TriangleView& triangles,
    std::size_t count,
    std::uint64_t seed
) {
    const bool is_parallel = std::holds_alternative<ParallelDistribution>(area.distribution);
    const bool is_radial = std::holds_alternative<RadialDistribution>(area.distribution);
    if (!is_parallel && !is_radial) return sampled_rays(area, count, seed);
    std::vector<Ray> rays;
    rays.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        Rng rng(seed, i);
        const PrimId surface = to_prim(rng.below(triangles.size()));
        const Ray light = sample(area.distribution, rng);
        Ray ray{.origin = point_on(triangles[surface], rng), .excluded = surface};
        ray.direction = is_parallel ? -light.direction : light.origin - ray.origin;
        if (is_radial) ray.t_max = 1;
        rays.push_back(ray);
    }
    return rays;
}

} // namespace raywise::detail
