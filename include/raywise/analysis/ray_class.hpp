// The classes of rays that a path tracer makes.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace raywise {

/// What rays are for.
enum class RayClass : std::uint8_t {
    primary,       ///< pinhole cameras: from one point
    sun,           ///< shadow rays toward one direction
    point_light,   ///< shadow rays to one point
    sun_disc_027,  ///< shadow rays toward a disc of half angle 0.27 degrees: the sun in the sky
    sun_disc_2,    ///< the same of 2 degrees: a hazy sun, a large distant lamp
    area_light,    ///< shadow rays to points in a ball: a lamp with a shade
    thin_lens,     ///< cameras with a depth of field: from a small disc
    diffuse_bounce ///< from a surface into any direction
};

/// How well a class agrees with an influence area.
enum class RayKind : std::uint8_t {
    exact,       ///< in one pencil
    near_affine, ///< close to one
    general,     ///< anything else
};

/// In the order of the enumeration.
[[nodiscard]] std::span<const RayClass> all_ray_classes();

/// "primary", "sun", "point_light", "sun_disc_0.27", "sun_disc_2", "area_light", "thin_lens",
/// "diffuse_bounce".
[[nodiscard]] std::string_view name_of(RayClass rays);
[[nodiscard]] std::string_view name_of(RayKind kind);
[[nodiscard]] RayKind kind_of(RayClass rays);

/// Whether the closest hit is wanted; for shadow rays only whether there is one.
[[nodiscard]] bool asks_closest(RayClass rays);

/// Shadow rays toward a direction or a disc in the sky.
[[nodiscard]] bool is_sun(RayClass rays);

/// Rays from a pinhole or a lens.
[[nodiscard]] bool is_camera(RayClass rays);

} // namespace raywise
