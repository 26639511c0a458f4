// Oriented boxes.
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

namespace raywise {

/// The closed box of points whose frame coordinates relative to `center` are within ± `half`.
struct Obb {
    Vec3d center = {};
    Frame frame = {};
    Vec3d half = {}; ///< half sizes along right, up, forward; finite, >= 0
};

/// Vertex i in 0..7, numbered as those of an Aabb with (right, up, forward) for (x, y, z).
[[nodiscard]] constexpr Vec3d vertex(const Obb& box, int i) {
    return box.center + from_frame(
                            box.frame,
                            {(i & 4) != 0 ? box.half.x : -box.half.x,
                             (i & 2) != 0 ? box.half.y : -box.half.y,
                             (i & 1) != 0 ? box.half.z : -box.half.z}
                        );
}

/// Whether the point is in the closed set; in case of doubt (rounding) it is. False for NaN.
[[nodiscard]] bool contains(const Obb& obb, Vec3d point);

/// Whether the eight vertices of the box are in the closed set, and so the whole box. False for an
/// empty box.
[[nodiscard]] bool contains(const Obb& obb, const Aabb& box);

/// Parameter at which a ray that starts inside leaves, rounded down; >= 0, +inf if never.
[[nodiscard]] float exit_parameter(const Obb& obb, const Ray& ray);

/// An enclosing float box, at most two units in the last place larger than the smallest.
[[nodiscard]] Aabb bounds(const Obb& obb);

} // namespace raywise
