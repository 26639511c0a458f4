#include <raywise/distribution/parallel.hpp>

#include "distribution/angles.hpp"
#include "distribution/checks.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/core/rounding.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/convex_polygon.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/sampling.hpp>
#include <raywise/geometry/silhouette.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

namespace raywise {

namespace {

constexpr double max_cone_half_angle_deg = 60;

void check(const ParallelParams& params) {
    require_finite(params.point, "the window's point");
    require_orthonormal(params.frame, "the window's frame");
    require_positive(params.half_width, "the window's half width");
    require_positive(params.half_height, "the window's half height");
    require(std::isfinite(params.start_depth), "the start depth", "finite");
    require(
        params.cone_half_angle_deg >= 0 && params.cone_half_angle_deg <= max_cone_half_angle_deg,
        "the cone's half angle",
        "in [0, 60] degrees"
    );
}

Vec3d window_center(const ParallelParams& params) {
    return params.point + params.frame.forward * params.start_depth;
}

/// The shear that makes rays of slope (slope_x, slope_y) parallel to the depth axis and leaves the
/// window where it is.
WindowProjection project_along(const ParallelParams& params, double slope_x, double slope_y) {
    const Frame& frame = params.frame;
    WindowProjection map;
    map.x_axis = (frame.right - frame.forward * slope_x) / params.half_width;
    map.y_axis = (frame.up - frame.forward * slope_y) / params.half_height;
    map.z_axis = frame.forward;
    const Vec3d center = window_center(params);
    map.offset = {-dot(map.x_axis, center), -dot(map.y_axis, center), -dot(map.z_axis, center)};
    return map;
}

/// Directions in the middle of cells of equal solid angle: an inner ring of 4 and an outer ring of
/// 12, each ring at the median of its share of the cone. Opposite directions come in pairs, so odd
/// variations cancel, and the mean of 1 - cos(angle) is that of the cone.
std::vector<WindowProjection> cone_projections(const ParallelParams& params) {
    struct Ring {
        int count;
        double middle; // of the ring's part of the cone's solid angle
    };

    constexpr std::array rings{Ring{4, 0.125}, Ring{12, 0.625}};
    const double span = 1 - std::cos(to_radians(params.cone_half_angle_deg));
    std::vector<WindowProjection> result;
    for (const Ring& ring : rings) {
        const double cosine = 1 - ring.middle * span;
        const double slope = std::sqrt(1 - cosine * cosine) / cosine;
        for (int i = 0; i < ring.count; ++i) {
            const double turn = 2 * std::numbers::pi * (i + 0.5) / ring.count;
            result.push_back(project_along(params, slope * std::cos(turn), slope * std::sin(turn)));
        }
    }
    return result;
}

double largest_slope(const ParallelParams& params) {
    return std::tan(to_radians(params.cone_half_angle_deg));
}

/// Area of the shadow of a box in units of the window's: a face counts with the magnitude of its
/// component of this vector.
Vec3d face_weights(const WindowProjection& map) {
    constexpr double window_area = 4;
    return abs(cross(map.x_axis, map.y_axis)) / window_area;
}

/// The shadow of the part of the box in front of the window plane, for a box that crosses it.
ConvexPolygon front_shadow(const Aabb& box, const WindowProjection& map) {
    std::array<Vec3d, 8> corners;
    for (int i = 0; i < 8; ++i)
        corners[static_cast<std::size_t>(i)] = map(to_double(box.vertex(i)));
    std::array<Vec2d, 8 + 12> points;
    std::size_t count = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d& from = corners[i];
        if (from.z >= 0) points[count++] = {from.x, from.y};
        for (const std::size_t axis : {1U, 2U, 4U}) {
            if ((i & axis) != 0) continue;
            const Vec3d& to = corners[i | axis];
            if ((from.z < 0) == (to.z < 0)) continue;
            const Vec3d cut = from + (to - from) * (from.z / (from.z - to.z));
            points[count++] = {cut.x, cut.y};
        }
    }
    return convex_hull(std::span(points).first(count));
}

/// The shadow of a box that is wholly in front.
ConvexPolygon whole_shadow(const Aabb& box, const WindowProjection& map) {
    const Vec3d direction = cross(map.x_axis, map.y_axis);
    ConvexPolygon shadow;
    const Silhouette& outline = silhouette(view_along(direction));
    for (std::size_t i = 0; i < outline.size; ++i) {
        const Vec3d at = map(to_double(box.vertex(outline.vertices[i])));
        shadow.push_back({at.x, at.y});
    }
    return shadow;
}

/// The shadow of a box on the window, cut by it; empty when no ray along the map meets the box.
ConvexPolygon shadow_on_window(const Aabb& box, const WindowProjection& map) {
    const Vec3d half = to_double(box.hi) * 0.5 - to_double(box.lo) * 0.5;
    const Vec3d at = map(to_double(box.hi) * 0.5 + to_double(box.lo) * 0.5);
    const double depth = dot(abs(map.z_axis), half);
    if (std::abs(at.x) - dot(abs(map.x_axis), half) > 1) return {};
    if (std::abs(at.y) - dot(abs(map.y_axis), half) > 1) return {};
    if (at.z + depth < 0) return {};
    const bool in_front = at.z - depth >= 0;
    return intersect(in_front ? whole_shadow(box, map) : front_shadow(box, map), Rectangle{});
}

} // namespace

ParallelMeasure::ParallelMeasure(const ParallelParams& params) {
    check(params);
    axis_ = project_along(params, 0, 0);
    abs_x_ = abs(axis_.x_axis);
    abs_y_ = abs(axis_.y_axis);
    abs_z_ = abs(axis_.z_axis);
    const bool has_cone = params.cone_half_angle_deg > 0;
    const double slope = largest_slope(params);
    spread_x_ = slope / params.half_width;
    spread_y_ = slope / params.half_height;
    auto projections = has_cone ? cone_projections(params) : std::vector<WindowProjection>{axis_};
    Vec3d weights;
    for (const WindowProjection& map : projections)
        weights = weights + face_weights(map) / static_cast<double>(projections.size());
    weights_ = to_float(weights);
    projections_ = std::make_shared<const std::vector<WindowProjection>>(std::move(projections));
}

float ParallelMeasure::clipped(const Aabb& box) const {
    constexpr double window_area = 4;
    double sum = 0;
    for (const WindowProjection& map : *projections_)
        sum += area(shadow_on_window(box, map));
    const double mean = sum / (window_area * static_cast<double>(projections_->size()));
    return static_cast<float>(std::min(mean, 1.0));
}

double ParallelMeasure::shared(const Aabb& a, const Aabb& b) const {
    if (a.is_empty() || b.is_empty()) return 0;
    constexpr double window_area = 4;
    double sum = 0;
    for (const WindowProjection& map : *projections_)
        sum += area(intersect(shadow_on_window(a, map), shadow_on_window(b, map)));
    return std::min(sum / (window_area * static_cast<double>(projections_->size())), 1.0);
}

double ParallelMeasure::unculled(const Aabb& box) const {
    if (box.is_empty()) return 0;
    const Vec3d size = to_double(box.hi) - to_double(box.lo);
    const Vec3d weights = to_double(weights_);
    return weights.x * size.y * size.z + weights.y * size.x * size.z + weights.z * size.x * size.y;
}

double ParallelMeasure::unculled_shared(const Aabb& a, const Aabb& b) const {
    if (a.is_empty() || b.is_empty()) return 0;
    constexpr double window_area = 4;
    double sum = 0;
    for (const WindowProjection& map : *projections_)
        sum += area(intersect(whole_shadow(a, map), whole_shadow(b, map)));
    return sum / (window_area * static_cast<double>(projections_->size()));
}

ParallelDistribution::ParallelDistribution(const ParallelParams& params) : params_(params) {
    check(params);
}

Ray ParallelDistribution::sample(Rng& rng) const {
    const double x = rng.uniform(-params_.half_width, params_.half_width);
    const double y = rng.uniform(-params_.half_height, params_.half_height);
    const Vec3d origin = window_center(params_) + params_.frame.right * x + params_.frame.up * y;
    const Vec3d direction =
        params_.cone_half_angle_deg > 0
            ? sample_cap(params_.frame, to_radians(params_.cone_half_angle_deg), rng)
            : params_.frame.forward;
    return {.origin = to_float(origin), .direction = to_float(direction)};
}

double ParallelDistribution::density(const Ray& ray) const {
    if (!is_valid(ray)) return 0;
    // What rounding to float can move a sample by, in units of its own magnitude.
    constexpr double slack = 8 * float_epsilon;
    const Vec3d offset = to_double(ray.origin) - window_center(params_);
    const Vec3d at = to_frame(params_.frame, offset);
    const double reach = slack * length(to_double(ray.origin));
    const bool on_window = std::abs(at.x) <= params_.half_width + reach &&
                           std::abs(at.y) <= params_.half_height + reach && std::abs(at.z) <= reach;
    const Vec3d direction = to_frame(params_.frame, to_double(ray.direction));
    const double angle = std::atan2(std::hypot(direction.x, direction.y), direction.z);
    const double cone = to_radians(params_.cone_half_angle_deg);
    if (!on_window || angle > cone + slack) return 0;
    const double per_area = 1 / (4 * params_.half_width * params_.half_height);
    if (cone == 0) return per_area;
    return per_area / (2 * std::numbers::pi * (1 - std::cos(cone)));
}

Vec3d ParallelDistribution::direction_at(const Aabb&) const {
    return params_.frame.forward;
}

} // namespace raywise
