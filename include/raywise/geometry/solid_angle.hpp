// How much of the directions around a point a box fills: solid angles, and the yaw-pitch square of
// the thesis. After [VanOosterom83]; the yaw-pitch integral is ours.
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/convex_polygon.hpp>
#include <raywise/geometry/perspective_area.hpp>
#include <raywise/geometry/vec.hpp>

namespace raywise {

/// Solid angle of the box seen from `eye`, in steradian, in [0, 4 pi]; 4 pi when the eye is in the
/// closed box, 0 for an empty box. Absolute error below 1e-12.
[[nodiscard]] double solid_angle_sr(const Aabb& box, Vec3d eye);

/// Solid angle of the window |x| <= tan_x, |y| <= tan_y at distance 1, in steradian, in (0, 2 pi).
[[nodiscard]] double window_solid_angle_sr(double tan_x, double tan_y);

/// Solid angle of a convex polygon given in the plane at distance 1, in steradian, >= 0.
/// [VanOosterom83]
[[nodiscard]] double polygon_solid_angle_sr(const ConvexPolygon& polygon);

/// Area in (yaw, pitch), in rad^2, of the part of a convex polygon with |pitch| <= pitch_limit_rad
/// (in (0, pi/2]); the polygon is given in the plane at distance 1, where x = tan yaw and
/// y = tan pitch / cos yaw. By Gauss-Legendre quadrature along the edges, split until the nearest
/// singularity of the integrand is far: absolute error below 1e-9 per edge.
[[nodiscard]] double polygon_yaw_pitch_rad2(const ConvexPolygon& polygon, double pitch_limit_rad);

/// The share of an isotropic point light's rays in a window that meet a box: solid angle over solid
/// angle; otherwise as PerspectiveProjection. In [0, 1].
class SolidAngleProjection {
public:
    /// Throws Error when a value is out of its range.
    explicit SolidAngleProjection(const PerspectiveWindow& window);

    [[nodiscard]] double operator()(const Aabb& box) const;

    [[nodiscard]] const PerspectiveWindow& window() const { return view_.window(); }

private:
    PerspectiveView view_;
    double window_sr_;
};

/// The share of the rays of a square cap (yaw and pitch uniform within +- half the fields of view,
/// `sample_square_cap`) that meet a box; all emitted rays count, those that leave the frustum's
/// window at its corners too. In [0, 1]; otherwise as PerspectiveProjection.
class YawPitchProjection {
public:
    /// Throws Error when a value is out of its range.
    explicit YawPitchProjection(const PerspectiveWindow& window);

    [[nodiscard]] double operator()(const Aabb& box) const;

    /// The window whose square cap emits.
    [[nodiscard]] const PerspectiveWindow& window() const { return window_; }

private:
    PerspectiveWindow window_;
    PerspectiveView view_; ///< wide enough for every emitted ray
    double yaw_limit_rad_;
    double pitch_limit_rad_;
};

} // namespace raywise
