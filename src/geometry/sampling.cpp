#include <raywise/geometry/sampling.hpp>

#include <raywise/core/rng.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/convex_polygon.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/solid_angle.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace raywise {

namespace {

constexpr double pi = std::numbers::pi;

/// 1 - cos(angle), without cancellation.
double versine(double angle_rad) {
    const double s = std::sin(angle_rad / 2);
    return 2 * s * s;
}

/// Where a direction meets the plane at distance 1 along forward; outside the window: nothing.
struct PlanePoint {
    bool in_window = false;
    double x = 0;
    double y = 0;
};

PlanePoint on_window(const Frame& frame, double tan_x, double tan_y, Vec3d direction) {
    const Vec3d d = to_frame(frame, direction);
    if (!(d.z > 0)) return {};
    const PlanePoint at{true, d.x / d.z, d.y / d.z};
    constexpr double slack = 1 + 1e-12; // a sample on the border stays in the support
    if (std::abs(at.x) > tan_x * slack || std::abs(at.y) > tan_y * slack) return {};
    return at;
}

} // namespace

Vec3d sample_sphere(Rng& rng) {
    const double z = rng.uniform(-1, 1);
    const double across = std::sqrt(std::max(0.0, 1 - z * z));
    const double angle = 2 * pi * rng.uniform_double();
    return {across * std::cos(angle), across * std::sin(angle), z};
}

Vec3d sample_cap(const Frame& axis, double half_angle_rad, Rng& rng) {
    const double one_minus_cosine = rng.uniform_double() * versine(half_angle_rad);
    const double sine = std::sqrt(std::max(0.0, one_minus_cosine * (2 - one_minus_cosine)));
    const double angle = 2 * pi * rng.uniform_double();
    return from_frame(axis, {sine * std::cos(angle), sine * std::sin(angle), 1 - one_minus_cosine});
}

double cap_density_per_sr(const Frame& axis, double half_angle_rad, Vec3d direction) {
    const Vec3d d = to_frame(axis, direction);
    const double angle = std::atan2(std::hypot(d.x, d.y), d.z);
    constexpr double slack_rad = 1e-12; // a sample on the border stays in the support
    if (!(angle <= half_angle_rad + slack_rad)) return 0;
    return half_angle_rad == 0 ? std::numeric_limits<double>::infinity()
                               : 1 / cap_solid_angle_sr(half_angle_rad);
}

double cap_solid_angle_sr(double half_angle_rad) {
    return 2 * pi * versine(half_angle_rad);
}

Vec3d sample_square_cap(const Frame& frame, double half_yaw_rad, double half_pitch_rad, Rng& rng) {
    const double yaw = rng.uniform(-half_yaw_rad, half_yaw_rad);
    const double pitch = rng.uniform(-half_pitch_rad, half_pitch_rad);
    const double level = std::cos(pitch);
    return from_frame(frame, {std::sin(yaw) * level, std::sin(pitch), std::cos(yaw) * level});
}

double square_cap_density_per_sr(
    const Frame& frame,
    double half_yaw_rad,
    double half_pitch_rad,
    Vec3d direction
) {
    const Vec3d d = to_frame(frame, direction);
    const double level = std::hypot(d.x, d.z);
    const double yaw = std::atan2(d.x, d.z);
    const double pitch = std::atan2(d.y, level);
    constexpr double slack_rad = 1e-12;
    if (!(std::abs(yaw) <= half_yaw_rad + slack_rad) ||
        !(std::abs(pitch) <= half_pitch_rad + slack_rad))
        return 0;
    return 1 / (4 * half_yaw_rad * half_pitch_rad * std::cos(pitch));
}

Vec3d sample_pinhole(const Frame& frame, double tan_x, double tan_y, Rng& rng) {
    const double x = rng.uniform(-tan_x, tan_x);
    const double y = rng.uniform(-tan_y, tan_y);
    return from_frame(frame, {x, y, 1});
}

double pinhole_density_per_sr(const Frame& frame, double tan_x, double tan_y, Vec3d direction) {
    const PlanePoint at = on_window(frame, tan_x, tan_y, direction);
    if (!at.in_window) return 0;
    const double squared = 1 + at.x * at.x + at.y * at.y;
    return squared * std::sqrt(squared) / (4 * tan_x * tan_y);
}

// The solid angle of |x| <= X in the window is 4 atan(X tan_y / sqrt(1 + X^2 + tan_y^2)), which is
// inverted for x; given x, y / sqrt(1 + x^2 + y^2) is uniform. [Urena13], for a centered rectangle.
Vec3d sample_isotropic(const Frame& frame, double tan_x, double tan_y, Rng& rng) {
    const double quarter = window_solid_angle_sr(tan_x, tan_y) / 4;
    const double t = std::tan(rng.uniform(-quarter, quarter));
    const double y_square = tan_y * tan_y;
    const double ahead = std::max(y_square - t * t, 0.0);
    const double x = std::clamp(t * std::sqrt((1 + y_square) / ahead), -tan_x, tan_x);
    const double distance = std::hypot(1.0, x);
    const double h_limit = tan_y / std::hypot(distance, tan_y);
    const double h = rng.uniform(-h_limit, h_limit);
    const double y = std::clamp(h * distance / std::sqrt(1 - h * h), -tan_y, tan_y);
    return normalized(from_frame(frame, {x, y, 1}));
}

double isotropic_density_per_sr(const Frame& frame, double tan_x, double tan_y, Vec3d direction) {
    if (!on_window(frame, tan_x, tan_y, direction).in_window) return 0;
    return 1 / window_solid_angle_sr(tan_x, tan_y);
}

Vec2d sample_disk(double radius, Rng& rng) {
    const double distance = radius * std::sqrt(rng.uniform_double());
    const double angle = 2 * pi * rng.uniform_double();
    return {distance * std::cos(angle), distance * std::sin(angle)};
}

Vec2d sample_rectangle(const Rectangle& rectangle, Rng& rng) {
    const double x = rng.uniform(rectangle.lo.x, rectangle.hi.x);
    const double y = rng.uniform(rectangle.lo.y, rectangle.hi.y);
    return {x, y};
}

Vec3 sample_box(const Aabb& box, Rng& rng) {
    const Vec3d lo = to_double(box.lo);
    const Vec3d hi = to_double(box.hi);
    Vec3d point;
    for (int axis = 0; axis < 3; ++axis)
        point[axis] = rng.uniform(lo[axis], hi[axis]);
    return max(min(to_float(point), box.hi), box.lo);
}

} // namespace raywise
