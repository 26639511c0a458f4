// Shadows of boxes along parallel rays, whole or cut by a window. After [Schmalstieg99].
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/convex_polygon.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/vec.hpp>

namespace raywise {

/// Area of the shadow of `box` along the unit vector `direction`, in scene units squared: exact up
/// to rounding, as cheap as the surface area, 0 for an empty box. Averaged over all directions it
/// is a quarter of the surface area.
[[nodiscard]] double projected_area(const Aabb& box, Vec3d direction);

/// A rectangle that emits parallel rays along frame.forward.
struct OrthographicWindow {
    Vec3d center = {};
    Frame frame = {};
    double half_width = 1;  ///< along frame.right, > 0, finite, scene units
    double half_height = 1; ///< along frame.up, > 0, finite
};

/// The share of a window's parallel rays that meet a box: shadow of the part in front of the window
/// plane, cut by the window, over the window's area; in [0, 1]. Monotone up to 1e-12, 0 for an
/// empty or flat-on box. A box in front and wholly inside the window costs one closed form; only a
/// box at the border is clipped. No allocation.
class OrthographicProjection {
public:
    /// Throws Error when a half size is not in (0, +inf) or a coordinate is not finite.
    explicit OrthographicProjection(const OrthographicWindow& window);

    [[nodiscard]] double operator()(const Aabb& box) const;

    [[nodiscard]] const OrthographicWindow& window() const { return window_; }

private:
    [[nodiscard]] ConvexPolygon outline(const Aabb& box) const;
    [[nodiscard]] ConvexPolygon outline_beyond(const Aabb& box, double least_depth) const;
    [[nodiscard]] Vec2d to_window(Vec3d point) const;

    OrthographicWindow window_;
    Vec3d right_;   ///< per half width: the shadow's window coordinates are in [-1, 1]
    Vec3d up_;      ///< per half height
    Vec3d weights_; ///< |forward| over the window's area
};

} // namespace raywise
