// What the rays of an exact area share: one direction, or one point. After [Haines86], [Hunt08].
#pragma once

#include <raywise/core/ids.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstdint>

namespace raywise {

/// All rays of one direction (a sun, an orthographic camera) or all rays through one point, the
/// apex (a lamp, a pinhole). The emitter is where they come from: infinitely far against the
/// direction, or the apex.
class Pencil {
public:
    enum class Kind : std::uint8_t { parallel, radial };

    /// Light that travels along `direction`: finite, not zero, any length. Throws Error otherwise.
    [[nodiscard]] static Pencil parallel(Vec3 direction);

    /// Light from `apex`, finite. Throws Error otherwise.
    [[nodiscard]] static Pencil radial(Vec3 apex);

    [[nodiscard]] Kind kind() const { return kind_; }

    /// The direction away from the emitter; parallel pencils only.
    [[nodiscard]] Vec3 direction() const { return value_; }

    /// Radial pencils only.
    [[nodiscard]] Vec3 apex() const { return value_; }

    /// The ray from a lit point to the emitter: origin `point`; parallel: direction -direction(),
    /// t_max = infinity; radial: direction apex - point, rounded, t_max = 1. Not valid for a point
    /// at the apex or not finite.
    [[nodiscard]] Ray shadow_ray(Vec3 point, float t_min = 0, PrimId excluded = no_prim) const {
        if (kind_ == Kind::parallel)
            return {.origin = point, .direction = -value_, .t_min = t_min, .excluded = excluded};
        return {
            .origin = point,
            .direction = value_ - point,
            .t_min = t_min,
            .t_max = 1,
            .excluded = excluded
        };
    }

    /// Whether the ray is exactly one of the pencil's: bit for bit a shadow ray's direction and at
    /// most its t_max; or away from the emitter: along direction(), or from the apex.
    [[nodiscard]] bool holds(const Ray& ray) const {
        if (kind_ == Kind::parallel) return ray.direction == -value_ || ray.direction == value_;
        return ray.origin == value_ || (ray.direction == value_ - ray.origin && ray.t_max <= 1);
    }

    friend bool operator==(const Pencil&, const Pencil&) = default;

private:
    Pencil(Kind kind, Vec3 value) : kind_(kind), value_(value) {}

    Kind kind_;
    Vec3 value_; ///< direction or apex
};

} // namespace raywise
