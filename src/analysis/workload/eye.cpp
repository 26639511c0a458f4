#include "analysis/workload/eye.hpp"
#include "analysis/workload/place.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/frustum.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace raywise::workload_detail {

namespace {

constexpr double half_field_of_view = std::numbers::inv_sqrt3; // tangent of 30 degrees

} // namespace

Eye make_eye(const Place& place, std::uint64_t seed, std::size_t number) {
    Eye eye;
    eye.position = standpoint(place, seed_of(seed, Stream::eye), number);
    if (is_outside(number)) {
        eye.frame = frame_along(place.middle - eye.position);
        eye.focus = length(place.middle - eye.position);
    } else {
        Rng rng(seed_of(seed, Stream::eye, 1), number);
        const double azimuth = rng.uniform(0, 2 * std::numbers::pi);
        eye.frame = frame_along(toward_sky(place, azimuth, rng.uniform(-15 * degree, 15 * degree)));
        eye.focus = place.diagonal / 4;
    }
    return eye;
}

Frustum view_of(const Place& place, const Eye& eye) {
    double far = 0;
    for (int i = 0; i < 8; ++i)
        far = std::max(far, dot(to_double(place.box.vertex(i)) - eye.position, eye.frame.forward));
    return {
        .eye = eye.position,
        .frame = eye.frame,
        .tan_x = half_field_of_view,
        .tan_y = half_field_of_view,
        .far = std::max(far, 1e-3 * place.diagonal)
    };
}

Vec3d look_along(const Eye& eye, std::uint64_t tile, std::size_t pixel, Rng& rng) {
    constexpr double side = image_tiles * tile_pixels;
    const auto column = (tile % image_tiles) * tile_pixels + pixel % tile_pixels;
    const auto line = (tile / image_tiles) * tile_pixels + pixel / tile_pixels;
    const double x = (static_cast<double>(column) + rng.uniform_double()) / side * 2 - 1;
    const double y = (static_cast<double>(line) + rng.uniform_double()) / side * 2 - 1;
    return eye.frame.forward + eye.frame.right * (x * half_field_of_view) -
           eye.frame.up * (y * half_field_of_view);
}

} // namespace raywise::workload_detail
