#include "toplevel/sampled_rays.hpp"

#include <raywise/core/rng.hpp>

#include <algorithm>

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

} // namespace raywise::detail
