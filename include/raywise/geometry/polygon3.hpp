// Planar convex polygons in space and the rays that meet them. The normal is Newell's
// [Sutherland74b].
#pragma once

#include <raywise/geometry/fixed_polygon.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <optional>
#include <span>

namespace raywise {

/// A closed planar convex polygon in space, counter-clockwise seen from its front.
class PlanarPolygon {
public:
    /// 3 to 16 finite vertices in order. Throws Error when there are fewer or more, when one is not
    /// finite, when they have no area, lie farther from their mean plane than 1e-4 of the diameter,
    /// or turn both ways.
    explicit PlanarPolygon(std::span<const Vec3> vertices);

    [[nodiscard]] const FixedPolygon<Vec3d>& vertices() const { return vertices_; }

    /// Newell's normal, twice the area long: robust to collinear vertices.
    [[nodiscard]] Vec3d normal() const { return normal_; }

    /// In scene units squared, > 0.
    [[nodiscard]] double area() const { return length(normal_) / 2; }

    /// Whether a point of the polygon's plane is in the polygon.
    [[nodiscard]] bool holds(Vec3d point_in_plane) const;

private:
    FixedPolygon<Vec3d> vertices_;
    Vec3d normal_;
    Vec3d mean_; ///< of the vertices: a point of the mean plane
    friend std::optional<float> intersect(const Ray& ray, const PlanarPolygon& polygon);
};

/// Parameter at which the ray meets the polygon, in [t_min, t_max]; nullopt for a miss, a ray in
/// the polygon's plane and an invalid ray. Computed in double, rounded to float. Agrees with the
/// triangle test away from the edges; not watertight across edges.
[[nodiscard]] std::optional<float> intersect(const Ray& ray, const PlanarPolygon& polygon);

} // namespace raywise
