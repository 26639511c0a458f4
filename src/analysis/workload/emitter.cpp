#include "analysis/workload/emitter.hpp"
#include "analysis/workload/path_tracer.hpp"
#include "analysis/workload/place.hpp"

#include <raywise/analysis/ray_class.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/distribution/radial.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/sampling.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/toplevel/pencil_of.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <variant>

namespace raywise::workload_detail {

namespace {

double disc_half_angle_deg(RayClass rays) {
    return rays == RayClass::sun_disc_027 ? 0.27 : rays == RayClass::sun_disc_2 ? 2.0 : 0.0;
}

Vec3d sun_direction(const Place& place, std::uint64_t seed, std::size_t number) {
    Rng rng(seed_of(seed, Stream::sun), number);
    const double azimuth = rng.uniform(0, 2 * std::numbers::pi);
    const double elevation = is_outside(number) ? rng.uniform(50 * degree, 80 * degree)
                                                : rng.uniform(8 * degree, 30 * degree);
    return -toward_sky(place, azimuth, elevation);
}

/// The area of a sun or a lamp.
InfluenceArea
emitter_area(const Place& place, RayClass rays, std::uint64_t seed, std::size_t number) {
    if (is_sun(rays)) {
        const Vec3d direction = sun_direction(place, seed, number);
        return InfluenceArea::parallel(
            area_name(rays, number),
            {.direction = direction,
             .region = obb_around(place.box, direction),
             .cone_half_angle_deg = disc_half_angle_deg(rays)}
        );
    }
    const bool is_point = kind_of(rays) == RayKind::exact;
    const double radius = is_point ? 0 : 0.01 * place.diagonal;
    RadialArea lamp{
        .apex = standpoint(place, seed_of(seed, Stream::lamp), number),
        .region = place.box,
        .radius = radius
    };
    if (!is_point) lamp.affinity.distance = 1.01 * radius;
    return InfluenceArea::radial(area_name(rays, number), lamp);
}

} // namespace

std::string area_name(RayClass rays, std::size_t number) {
    return std::string(name_of(rays)) + " " + std::to_string(number + 1);
}

Emitter::Emitter(const Place& place, RayClass rays, std::uint64_t seed, std::size_t number)
    : rays_(rays)
    , seed_(seed_of(seed, Stream::light, static_cast<std::size_t>(rays) * 64 + number))
    , area_(emitter_area(place, rays, seed, number))
    , pencil_(central_pencil_of(area_).value()) {
    if (const auto* radial = std::get_if<RadialDistribution>(&area_.distribution)) {
        radius_ = radial->params().radius;
    } else {
        sky_ = frame_along(-to_double(pencil_.direction()));
    }
}

Ray Emitter::shadow_ray(const SurfacePoint& from, float offset, std::uint64_t draw) const {
    Ray ray = unbounded_ray(from.point, draw);
    if (!(dot(from.normal, to_double(ray.direction)) > 0)) return {};
    ray.t_min = static_cast<float>(static_cast<double>(offset) / length(to_double(ray.direction)));
    return ray;
}

Ray Emitter::unbounded_ray(Vec3 point, std::uint64_t draw) const {
    Rng rng(seed_, draw);
    if (kind_of(rays_) == RayKind::exact) return pencil_.shadow_ray(point);
    if (is_sun(rays_))
        return {
            .origin = point,
            .direction = to_float(sample_cap(sky_, disc_half_angle_deg(rays_) * degree, rng))
        };
    const Vec3d on_sphere = sample_sphere(rng);
    const Vec3d lamp =
        to_double(pencil_.apex()) + on_sphere * (radius_ * std::cbrt(rng.uniform_double()));
    return Pencil::radial(to_float(lamp)).shadow_ray(point);
}

} // namespace raywise::workload_detail
