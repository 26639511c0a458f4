// Random points and directions, each with its density. The spherical rectangle is that of
// [Urena13]; the rest is inversion.
#pragma once

#include <raywise/core/rng.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/convex_polygon.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/vec.hpp>

namespace raywise {

/// Uniform on the unit sphere; density 1 / (4 pi) per steradian.
[[nodiscard]] Vec3d sample_sphere(Rng& rng);

/// Uniform in the cap of unit directions within `half_angle_rad` of axis.forward; in [0, pi], 0
/// gives the axis.
[[nodiscard]] Vec3d sample_cap(const Frame& axis, double half_angle_rad, Rng& rng);

/// Density of `sample_cap` per steradian at a unit direction: 0 outside the cap, +inf for a cap of
/// angle 0.
[[nodiscard]] double cap_density_per_sr(const Frame& axis, double half_angle_rad, Vec3d direction);

/// Solid angle of a cap, in [0, 4 pi]: 2 pi (1 - cos), without cancellation for small angles.
[[nodiscard]] double cap_solid_angle_sr(double half_angle_rad);

/// The thesis's radial sampler: yaw uniform in +- half_yaw_rad, pitch in +- half_pitch_rad (both in
/// (0, pi/2)), forward pitched about right, then yawed about up. A unit vector. Uniform neither in
/// solid angle nor on the image plane.
[[nodiscard]] Vec3d
sample_square_cap(const Frame& frame, double half_yaw_rad, double half_pitch_rad, Rng& rng);

/// Density of `sample_square_cap` per steradian at a direction of any length.
[[nodiscard]] double square_cap_density_per_sr(
    const Frame& frame,
    double half_yaw_rad,
    double half_pitch_rad,
    Vec3d direction
);

/// Uniform on the image plane: forward + x right + y up with |x| <= tan_x, |y| <= tan_y. Not a unit
/// vector: its depth along forward is 1.
[[nodiscard]] Vec3d sample_pinhole(const Frame& frame, double tan_x, double tan_y, Rng& rng);

/// Density of `sample_pinhole` per steradian at a direction of any length; 0 outside the window.
[[nodiscard]] double
pinhole_density_per_sr(const Frame& frame, double tan_x, double tan_y, Vec3d direction);

/// Uniform in solid angle over the pyramid |x| <= z tan_x, |y| <= z tan_y. A unit vector. [Urena13]
[[nodiscard]] Vec3d sample_isotropic(const Frame& frame, double tan_x, double tan_y, Rng& rng);

/// Density of `sample_isotropic` per steradian at a direction of any length; 0 outside the window.
[[nodiscard]] double
isotropic_density_per_sr(const Frame& frame, double tan_x, double tan_y, Vec3d direction);

/// Uniform in the disk of `radius` (>= 0) around 0; density 1 / (pi radius^2).
[[nodiscard]] Vec2d sample_disk(double radius, Rng& rng);

/// Uniform in the rectangle; density 1 / its area.
[[nodiscard]] Vec2d sample_rectangle(const Rectangle& rectangle, Rng& rng);

/// Uniform in the box (not empty), rounded to float inside it; density 1 / its volume.
[[nodiscard]] Vec3 sample_box(const Aabb& box, Rng& rng);

} // namespace raywise
