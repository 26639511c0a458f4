#include <raywise/geometry/projected_area.hpp>

#include "geometry/box_edges.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/rounding.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/convex_polygon.hpp>
#include <raywise/geometry/silhouette.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

namespace raywise {

namespace {

Vec3d center_of(const Aabb& box) {
    return (to_double(box.lo) + to_double(box.hi)) * 0.5;
}

Vec3d size_of(const Aabb& box) {
    return to_double(box.hi) - to_double(box.lo);
}

/// Areas of the three faces, by the axis they face.
Vec3d face_areas(Vec3d size) {
    return {size.y * size.z, size.x * size.z, size.x * size.y};
}

} // namespace

double projected_area(const Aabb& box, Vec3d direction) {
    if (box.is_empty()) return 0;
    return dot(abs(direction), face_areas(size_of(box)));
}

OrthographicProjection::OrthographicProjection(const OrthographicWindow& window)
    : window_(window)
    , right_(window.frame.right / window.half_width)
    , up_(window.frame.up / window.half_height)
    , weights_(abs(window.frame.forward) / (4 * window.half_width * window.half_height)) {
    if (!(window.half_width > 0) || !(window.half_height > 0) ||
        !std::isfinite(window.half_width) || !std::isfinite(window.half_height))
        throw Error("the half sizes of a window must be positive and finite");
    if (!is_finite(window.center)) throw Error("the center of a window must be finite");
}

double OrthographicProjection::operator()(const Aabb& box) const {
    if (box.is_empty()) return 0;
    const Vec3d center = center_of(box) - window_.center;
    const Vec3d half = size_of(box) * 0.5;
    const double x = std::abs(dot(right_, center));
    const double y = std::abs(dot(up_, center));
    const double x_radius = dot(abs(right_), half);
    const double y_radius = dot(abs(up_), half);
    if (x - x_radius > 1 || y - y_radius > 1) return 0;

    // A box that only touches the window plane is met where the rays start. The slack keeps such
    // boxes on one side of the decision, whatever their other dimensions.
    const double depth = dot(window_.frame.forward, center);
    const Vec3d forward_size = abs(window_.frame.forward);
    const double depth_radius = dot(forward_size, half);
    const double slack = gamma_bound(8, double_epsilon) *
                         dot(forward_size, abs(center) + half + abs(window_.center));
    if (depth + depth_radius < -slack) return 0;
    const bool in_front = depth - depth_radius >= -slack;
    if (in_front && x + x_radius <= 1 && y + y_radius <= 1)
        return std::min(dot(weights_, face_areas(half * 2)), 1.0);
    const double share = area(in_front ? outline(box) : outline_beyond(box, -slack)) / 4;
    return std::min(share, 1.0);
}

/// In window coordinates, cut by the window.
ConvexPolygon OrthographicProjection::outline(const Aabb& box) const {
    const Silhouette& cycle = silhouette(view_along(window_.frame.forward));
    ConvexPolygon polygon;
    for (std::size_t i = 0; i < cycle.size; ++i)
        polygon.push_back(to_window(to_double(box.vertex(cycle.vertices[i]))));
    return intersect(polygon, Rectangle{});
}

/// The outline of the part whose depth is at least `least_depth`.
ConvexPolygon OrthographicProjection::outline_beyond(const Aabb& box, double least_depth) const {
    std::array<double, 8> heights{};
    std::array<Vec2d, 8 + 12> points;
    std::size_t count = 0;
    for (int i = 0; i < 8; ++i) {
        const Vec3d vertex = to_double(box.vertex(i));
        const double height = dot(window_.frame.forward, vertex - window_.center) - least_depth;
        heights[static_cast<std::size_t>(i)] = height;
        if (height >= 0) points[count++] = to_window(vertex);
    }
    for (const auto& [from, to] : box_edges) {
        const double a = heights[from];
        const double b = heights[to];
        if ((a < 0) == (b < 0)) continue;
        const Vec2d p = to_window(to_double(box.vertex(static_cast<int>(from))));
        const Vec2d q = to_window(to_double(box.vertex(static_cast<int>(to))));
        points[count++] = p + (q - p) * (a / (a - b));
    }
    return intersect(convex_hull(std::span(points.data(), count)), Rectangle{});
}

Vec2d OrthographicProjection::to_window(Vec3d point) const {
    const Vec3d from_center = point - window_.center;
    return {dot(right_, from_center), dot(up_, from_center)};
}

} // namespace raywise
