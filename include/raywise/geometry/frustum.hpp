// View frusta: pyramids cut between two depths.
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

namespace raywise {

/// The closed set of points e + x r + y u + z f with near <= z <= far, |x| <= z tan_x, |y| <= z
/// tan_y, where (r, u, f) is the frame. near = 0 is the pyramid with its apex.
struct Frustum {
    Vec3d eye = {};
    Frame frame = {};
    double tan_x = 1; ///< tangent of half the horizontal field of view, > 0, finite
    double tan_y = 1; ///< of half the vertical one
    double near = 0;  ///< >= 0
    double far = 1;   ///< > near, finite
};

/// Vertex i in 0..7: i = 4 [right] + 2 [up] + [far].
[[nodiscard]] constexpr Vec3d vertex(const Frustum& frustum, int i) {
    const double z = (i & 1) != 0 ? frustum.far : frustum.near;
    return frustum.eye +
           from_frame(
               frustum.frame,
               {((i & 4) != 0 ? z : -z) * frustum.tan_x, ((i & 2) != 0 ? z : -z) * frustum.tan_y, z}
           );
}

/// Whether the point is in the closed set; in case of doubt (rounding) it is. False for NaN.
[[nodiscard]] bool contains(const Frustum& frustum, Vec3d point);

/// Whether the eight vertices of the box are in the closed set, and so the whole box. False for an
/// empty box.
[[nodiscard]] bool contains(const Frustum& frustum, const Aabb& box);

/// Parameter at which a ray that starts inside leaves, rounded down; >= 0, +inf if never.
[[nodiscard]] float exit_parameter(const Frustum& frustum, const Ray& ray);

/// An enclosing float box, at most two units in the last place larger than the smallest.
[[nodiscard]] Aabb bounds(const Frustum& frustum);

} // namespace raywise
