#include <raywise/geometry/polygon3.hpp>

#include <raywise/core/error.hpp>
#include <raywise/geometry/convex_polygon.hpp>
#include <raywise/geometry/fixed_polygon.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

namespace raywise {

namespace {

using Polygon = FixedPolygon<Vec3d>;

/// Twice the area vector. Coordinates relative to the first vertex, which keeps the digits of a
/// small polygon far from the origin.
Vec3d newell_normal(const Polygon& polygon) {
    Vec3d sum;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
        sum = sum + cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
    return sum;
}

double diameter_of(const Polygon& polygon) {
    double longest = 0;
    for (const Vec3d& p : polygon)
        for (const Vec3d& q : polygon)
            longest = std::max(longest, length(p - q));
    return longest;
}

Vec3d mean_of(const Polygon& polygon) {
    Vec3d sum;
    for (const Vec3d& p : polygon)
        sum = sum + (p - polygon[0]);
    return polygon[0] + sum / static_cast<double>(polygon.size());
}

/// Whether every vertex is on the inner side of every edge, up to `tolerance`. Turning one way only
/// would not do: a pentagram does that too.
bool is_convex(const Polygon& polygon, Vec3d unit_normal, double tolerance) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3d edge = polygon.after(i) - polygon[i];
        const Vec3d inward = cross(unit_normal, edge);
        for (const Vec3d& p : polygon)
            if (dot(inward, p - polygon[i]) < -tolerance * length(edge)) return false;
    }
    return true;
}

} // namespace

PlanarPolygon::PlanarPolygon(std::span<const Vec3> vertices) {
    if (vertices.size() < 3 || vertices.size() > Polygon::capacity)
        throw Error("a polygon has 3 to 16 vertices");
    for (const Vec3& vertex : vertices) {
        if (!is_finite(vertex)) throw Error("a vertex of a polygon is not finite");
        vertices_.push_back(to_double(vertex));
    }
    normal_ = newell_normal(vertices_);
    mean_ = mean_of(vertices_);
    if (!(length(normal_) > 0)) throw Error("a polygon has no area");
    constexpr double relative_tolerance = 1e-4;
    const double tolerance = relative_tolerance * diameter_of(vertices_);
    const Vec3d unit_normal = normalized(normal_);
    for (const Vec3d& vertex : vertices_)
        if (std::abs(dot(unit_normal, vertex - mean_)) > tolerance)
            throw Error("the vertices of a polygon are not in one plane");
    if (!is_convex(vertices_, unit_normal, tolerance)) throw Error("a polygon is not convex");
}

bool PlanarPolygon::holds(Vec3d point_in_plane) const {
    const int dropped = dominant_axis(normal_);
    const auto project = [&](Vec3d p) { return Vec2d{p[(dropped + 1) % 3], p[(dropped + 2) % 3]}; };
    ConvexPolygon shadow;
    for (const Vec3d& vertex : vertices_)
        shadow.push_back(project(vertex));
    return contains(shadow, project(point_in_plane));
}

// The plane is that of `intersect_plane`, but its normal stays in double: rounded to float it would
// tilt the polygon.
std::optional<float> intersect(const Ray& ray, const PlanarPolygon& polygon) {
    if (!is_valid(ray)) return std::nullopt;
    const Vec3d origin = to_double(ray.origin);
    const Vec3d direction = to_double(ray.direction);
    const double rise = dot(polygon.normal(), direction);
    if (rise == 0) return std::nullopt;
    const double exact_t = dot(polygon.normal(), polygon.mean_ - origin) / rise;
    const auto t = static_cast<float>(exact_t);
    if (!std::isfinite(t) || !(t >= ray.t_min && t <= ray.t_max)) return std::nullopt;
    if (!polygon.holds(origin + direction * exact_t)) return std::nullopt;
    return t;
}

} // namespace raywise
