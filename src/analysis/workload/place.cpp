#include "analysis/workload/place.hpp"

#include <raywise/analysis/ray_workload.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/scene.hpp>
#include <raywise/toplevel/open_place.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace raywise::workload_detail {

namespace {

int likely_up(Vec3 size) {
    constexpr float clearly = 0.875F;
    const float least = std::min({size.x, size.y, size.z});
    if (least >= clearly * size.y) return 1;
    if (least >= clearly * size.z) return 2;
    return least == size.x ? 0 : least == size.y ? 1 : 2;
}

/// Rays start at floats: an emitter between them would not lie on its own rays.
Vec3d as_origin(Vec3d point) {
    return to_double(to_float(point));
}

} // namespace

Place place_of(const Scene& scene, const WorkloadParams& params) {
    const Aabb box = bounds(scene);
    Place place;
    place.scene = &scene;
    place.diagonal = length(to_double(box.hi) - to_double(box.lo));
    if (!(place.diagonal > 0)) throw Error("ray workload: the scene has no extent");
    // Wider than what rounding does to a hit point on its border.
    const auto pad = static_cast<float>(1e-3 * place.diagonal);
    place.box = {box.lo - Vec3{pad, pad, pad}, box.hi + Vec3{pad, pad, pad}};
    place.middle = to_double(box.center());
    Vec3d up;
    up[params.up_axis.value_or(likely_up(box.size()))] = 1;
    place.sky = frame_along(up);
    return place;
}

Vec3d toward_sky(const Place& place, double azimuth, double elevation) {
    return from_frame(
        place.sky,
        {std::cos(elevation) * std::cos(azimuth),
         std::cos(elevation) * std::sin(azimuth),
         std::sin(elevation)}
    );
}

Vec3d standpoint(const Place& place, std::uint64_t seed, std::size_t number) {
    Rng rng(seed, number);
    if (!is_outside(number))
        return as_origin(find_open_place(place.scene->view(), place.box, rng.bits()));
    const double azimuth = rng.uniform(0, 2 * std::numbers::pi);
    const double height = rng.uniform(0.1, 0.9); // sine of the elevation: uniform on the sphere
    return as_origin(
        place.middle + toward_sky(place, azimuth, std::asin(height)) * (0.75 * place.diagonal)
    );
}

} // namespace raywise::workload_detail
