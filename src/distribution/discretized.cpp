#include <raywise/distribution/discretized.hpp>

#include "distribution/angles.hpp"

#include <raywise/core/error.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/distribution/parallel.hpp>
#include <raywise/distribution/radial.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/vec.hpp>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

namespace raywise {
namespace {

/// Where of [0, 1) the point i of an evenly spread sequence stands: multiples of an irrational
/// number, modulo 1.
double spread(std::size_t i, double irrational) {
    const double x = (static_cast<double>(i) + 0.5) * irrational;
    return x - std::floor(x);
}

/// The fraction of points before the middle of point i.
double share(std::size_t i, std::size_t count) {
    return (static_cast<double>(i) + 0.5) / static_cast<double>(count);
}

/// Point i of `count` on the cap of unit vectors around `axis`: rings of equal solid angle, turned
/// by the golden angle from one to the next.
Vec3d cap_point(const Frame& axis, double half_angle_rad, std::size_t i, std::size_t count) {
    // 1 - cos, without cancellation for small angles.
    const double half_sine = std::sin(half_angle_rad / 2);
    const double below = share(i, count) * 2 * half_sine * half_sine;
    const double radius = std::sqrt(below * (2 - below));
    const double turn = 2 * std::numbers::pi * spread(i, std::numbers::phi);
    return axis.right * (radius * std::cos(turn)) + axis.up * (radius * std::sin(turn)) +
           axis.forward * (1 - below);
}

/// Point i of `count` in the unit ball: golden spiral over directions, radii by volume.
Vec3d ball_point(std::size_t i, std::size_t count) {
    const Vec3d direction = cap_point(Frame{}, std::numbers::pi, i, count);
    return direction * std::cbrt(spread(i, std::numbers::sqrt2));
}

Distribution at_point(const Distribution& emitter, std::size_t i, std::size_t count) {
    if (const auto* parallel = std::get_if<ParallelDistribution>(&emitter)) {
        ParallelParams params = parallel->params();
        const double half_angle_rad = to_radians(params.cone_half_angle_deg);
        params.cone_half_angle_deg = 0;
        params.frame = frame_along(cap_point(params.frame, half_angle_rad, i, count));
        return ParallelDistribution(params);
    }
    RadialParams params = std::get<RadialDistribution>(emitter).params();
    params.eye = params.eye + ball_point(i, count) * params.radius;
    params.radius = 0;
    return RadialDistribution(params);
}

} // namespace

std::vector<InfluenceArea> discretized(const InfluenceArea& area, std::size_t count) {
    if (count < 1) throw Error("discretized: at least one point is needed");
    if (!std::holds_alternative<ParallelDistribution>(area.distribution) &&
        !std::holds_alternative<RadialDistribution>(area.distribution)) {
        throw Error("discretized: area '" + area.name + "' has no emitter to take points of");
    }
    std::vector<InfluenceArea> points(count, area);
    for (std::size_t i = 0; i < count; ++i) {
        points[i].name.append(1, '/').append(std::to_string(i));
        points[i].distribution = at_point(area.distribution, i, count);
        points[i].density /= static_cast<double>(count);
    }
    return points;
}

} // namespace raywise
