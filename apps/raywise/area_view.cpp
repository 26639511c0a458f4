#include "area_view.hpp"

#include <raywise/distribution/influence_area.hpp>
#include <raywise/distribution/parallel.hpp>
#include <raywise/distribution/radial.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <variant>

namespace raywise::app {

namespace {

/// A view of the given proportions whose pixel at (x, y) in [-1, 1]^2 (frame right, up) gets the
/// ray `ray_at(x, y)`.
template <class RayAt>
AreaView make_view(double width_over_height, int pixels, const RayAt& ray_at) {
    constexpr double slimmest =
        8; // a sliver of a window is stretched rather than drawn one pixel high
    const double ratio = std::clamp(width_over_height, 1 / slimmest, slimmest);
    AreaView view;
    view.width = std::max(1, static_cast<int>(std::lround(std::sqrt(pixels * ratio))));
    view.height = std::max(1, static_cast<int>(std::lround(view.width / ratio)));
    view.rays.reserve(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
    // right x up = forward: for an eye that looks forward, a frame's right is at the left.
    for (int row = 0; row < view.height; ++row)
        for (int column = 0; column < view.width; ++column)
            view.rays.push_back(
                ray_at(1 - (2 * column + 1.0) / view.width, 1 - (2 * row + 1.0) / view.height)
            );
    return view;
}

AreaView view_of(const ParallelParams& params, int pixels) {
    const Frame& frame = params.frame;
    return make_view(params.half_width / params.half_height, pixels, [&](double x, double y) {
        const Vec3d origin =
            params.point +
            from_frame(frame, {x * params.half_width, y * params.half_height, params.start_depth});
        Ray ray;
        ray.origin = to_float(origin);
        ray.direction = to_float(frame.forward);
        return ray;
    });
}

AreaView view_of(const RadialParams& params, const RadialWindow& window, int pixels) {
    return make_view(window.tan_x / window.tan_y, pixels, [&](double x, double y) {
        const Vec3d direction = from_frame(params.frame, {x * window.tan_x, y * window.tan_y, 1});
        Ray ray;
        ray.origin = to_float(params.eye + direction * params.start_depth);
        ray.direction = to_float(direction);
        return ray;
    });
}

AreaView panorama_of(const RadialParams& params, int pixels) {
    return make_view(2, pixels, [&](double x, double y) {
        const double azimuth = x * std::numbers::pi, elevation = y * std::numbers::pi / 2;
        const Vec3d direction = from_frame(
            params.frame,
            {std::cos(elevation) * std::sin(azimuth),
             std::sin(elevation),
             std::cos(elevation) * std::cos(azimuth)}
        );
        Ray ray;
        ray.origin = to_float(params.eye);
        ray.direction = to_float(direction);
        return ray;
    });
}

} // namespace

std::optional<AreaView> view_of(const InfluenceArea& area, int pixels) {
    if (const auto* parallel = std::get_if<ParallelDistribution>(&area.distribution))
        return view_of(parallel->params(), pixels);
    if (const auto* radial = std::get_if<RadialDistribution>(&area.distribution)) {
        const RadialParams& params = radial->params();
        return params.window ? view_of(params, *params.window, pixels)
                             : panorama_of(params, pixels);
    }
    return std::nullopt;
}

} // namespace raywise::app
